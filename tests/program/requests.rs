//! Wrong requests.

use super::run::{Scratch, command, refused, stderr, stdout};
use super::square::Square;

#[test]
fn wrong_options_are_refused() {
    let scratch = Scratch::new("options");
    let schemes = "there are: p1";
    let (penalty, at_least) = ("must be positive and finite", "must be at least 1");
    let (whole, number) = ("expected a whole number", "expected a number");
    let cases: &[(&str, &[&str])] = &[
        ("--scene nowhere", &["unknown scene \"nowhere\"", "radial-2d", "signorini-2d", "all"]),
        ("--scene radial-2d,", &["unknown scene \"\"", "radial-2d"]),
        ("--scheme p7", &["unknown scheme \"p7\"", schemes, "wopsip"]),
        ("--scheme all,p7", &["unknown scheme \"p7\"", schemes]),
        ("--scheme sipg@eta=3", &["sipg@eta=3", "does not take \"eta\"", "factor, sigma"]),
        ("--scheme p1@factor=3", &["p1 does not take \"factor\"", "no key"]),
        ("--scheme p1,factor=3", &["p1@factor=3"]),
        ("--scheme sipg@factor=0", &["factor = 0", "positive and finite"]),
        ("--scheme sipg@factor=2,sigma=3", &["factor and sigma", "same penalty"]),
        ("--scheme br2@lifts=half", &["lifts = half", "reduced, full"]),
        ("--scheme wopsip:edges", &["wopsip:edges", "no placement \"edges\"", "facet-means"]),
        ("--scheme p1:facet-means", &["p1:facet-means", "no such values", "vertices, nodes"]),
        ("--solver magic", &["unknown solver \"magic\"", "active-set"]),
        ("--linear magic", &["unknown linear solver \"magic\"", "direct"]),
        ("--constraint edges", &["edges", "vertices", "facet-means"]),
        ("--precision f16", &["f16", "f64", "f32"]),
        ("--levels 0", &["level = 0", "at least one subdivision", "refinements, from 0"]),
        ("--levels 4,0", &["level = 0", "at least one"]),
        ("--levels 1000000000", &["level = 1000000000", "cells", "at most"]),
        ("--levels 99999999999999999999", &["99999999999999999999", whole]),
        ("--levels -4", &["'-4'", "--levels", whole]),
        ("--levels four", &["'four'", "--levels", whole]),
        ("--levels 4.5", &["'4.5'", whole]),
        ("--levels 4,,8", &["''", "--levels", whole]),
        ("--levels=", &["''", "--levels", whole]),
        ("--levels", &["--levels", "value is required"]),
        ("--repeat 0", &["--repeat 0", at_least]),
        ("--repeat -1", &["'-1'", whole]),
        ("--tolerance 0", &["tolerance = 0", "positive and finite"]),
        ("--tolerance inf", &["tolerance = inf", "positive and finite"]),
        ("--tolerance much", &["'much'", "--tolerance", number]),
        ("--tolerance 0.1 --history", &["--tolerance", "--history"]),
        ("--threads 0", &["--threads 0", at_least]),
        ("--threads 100000", &["--threads 100000", "at most"]),
        ("--sigma 0", &["--sigma 0", penalty]),
        ("--sigma -1", &["--sigma -1", penalty]),
        ("--sigma NaN", &["--sigma NaN", penalty]),
        ("--sigma inf", &["--sigma inf", penalty]),
        ("--sigma much", &["'much'", "--sigma", number]),
        ("--sigma 4 --sigma 5", &["--sigma", "multiple times"]),
        ("--eta 0", &["--eta 0", penalty]),
        ("--eta -1", &["--eta -1", penalty]),
        ("--eta NaN", &["--eta NaN", penalty]),
        ("--eta inf", &["--eta inf", penalty]),
        ("--eta much", &["'much'", "--eta", number]),
        ("--sigma 4 --scheme p1,cr", &["--sigma 4", "none of the schemes chosen", "are: sipg"]),
        ("--sigma 4 --scheme wopsip", &["--sigma 4", "none of the schemes chosen", "are: sipg"]),
        ("--eta 4 --scheme p1,sipg", &["--eta 4", "none of the schemes chosen", "are: wopsip"]),
        ("--scene radial-2d --scale 0", &["scale = 0", "positive and finite"]),
        ("--scene radial-2d --scale NaN", &["scale = NaN", "positive and finite"]),
        ("--scene radial-2d --scale -1", &["scale = -1", "positive and finite"]),
        ("--scene radial-2d --scale 1e300", &["scale = 1e300", "1e100"]),
        ("--scale 2 --scene ball-2d", &["--scale 2", "none of the scenes chosen", "radial-2d"]),
        ("--contrast 3 --scene ball-2d", &["--contrast 3", "none of the scenes chosen"]),
        ("--load 3 --scene ball-2d", &["--load 3", "none of the scenes chosen"]),
        ("--levles 4", &["--levles", "--levels"]),
        ("--nonsense", &["--nonsense", "there are: --scene", "--list", "--quiet"]),
        ("radial-2d", &["there is no file radial-2d", "--scene"]),
    ];
    for (options, expected) in cases {
        let options: Vec<&str> = options.split(' ').collect();
        refused(&scratch, &options, expected);
    }
}

#[test]
fn names_of_schemes_are_read_to_the_letter() {
    let scratch = Scratch::new("letters");
    for name in ["P1", "p1 "] {
        let unknown = format!("unknown scheme \"{name}\"");
        refused(&scratch, &["--scheme", name], &[&unknown, "there are: p1", "sipg"]);
    }
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let scratch = Scratch::new("places");
    let file = scratch.file("file", "");
    let below = scratch.path("file/report");
    refused(&scratch, &["--out", &file], &["cannot write", &file]);
    refused(&scratch, &["--out", &below], &["cannot write", &below]);
    refused(&scratch, &["--json", &below], &["cannot write", &below]);
    let directory = scratch.0.display().to_string();
    refused(&scratch, &["--json", &directory], &["cannot write", &directory]);
    assert!(std::fs::read(file).unwrap().is_empty());
}

#[test]
fn the_other_commands_refuse_before_the_work_too() {
    let scratch = Scratch::new("other-places");
    let file = scratch.file("file", "");
    let (below, out) = (scratch.path("file/report"), scratch.path("out"));
    for (name, options, words) in [
        ("work-precision", format!("--rounds 2 --out {below}"), "cannot write"),
        ("work-precision", format!("--scene radial-2d --reference 20 --out {out}"), "reference"),
        ("stability", format!("--quick --out {below}"), "cannot write"),
        ("stability", format!("--quick --scheme none --out {out}"), "scheme"),
        (
            "work-precision",
            format!("--scene radial-2d --scheme p1,cr --subject sipg --out {out}"),
            "--subject sipg: no scheme has this label; there are: p1, cr",
        ),
        ("work-precision", format!("--resume --out {out}"), "--resume"),
        ("compare", format!("--rounds 0 --out {out}"), "--rounds 0: must be at least 1"),
        ("pictures", format!("--levels 0 --out {out}"), "level"),
        ("pictures", format!("--out {below}"), "cannot write"),
    ] {
        let output = command(name).args(options.split(' ')).output().unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name} {options}: {message}");
        assert!(message.starts_with("error: ") && message.lines().count() == 1, "{message}");
        assert!(message.contains(words), "{name} {options}: {message}");
        assert!(!scratch.0.join("out").exists(), "{name} {options} left files");
    }
    assert!(std::fs::read(file).unwrap().is_empty());
}

/// A solve that fails is no wrong request.
#[test]
fn a_picture_of_nothing_is_no_wrong_request() {
    let scratch = Scratch::new("nothing-to-draw");
    let out = scratch.path("out");
    let problem = scratch.file(
        "pulled.toml",
        "box = [[0, 0], [1, 1]]\n[obstacle]\nlower.default = 1\nupper.default = \"1 - x * (1 - x)\"\n\
         [boundary.left]\nkind = \"dirichlet\"\nvalue = 1\n[boundary.right]\nkind = \"dirichlet\"\nvalue = 1\n\
         [boundary.top]\nkind = \"neumann\"\n[boundary.bottom]\nkind = \"neumann\"\n",
    );
    let output = command("pictures").args([&problem, "--out", &out]).output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("nothing to draw"), "{message}");
}

/// One name of the option does for the other, and help and tables say what its numbers count.
#[test]
fn levels_are_subdivisions_of_boxes_and_refinements_of_meshes() {
    let scratch = Scratch::new("levels");
    let mesh = scratch.file("square.msh", &Square::sound());
    for (command_name, options) in [
        ("compare", "--level 4,8 --no-fields --details"),
        ("work-precision", "--level 4 --rounds 1 --subject p1"),
        ("pictures", "--levels 4"),
    ] {
        let mut program = command(command_name);
        program.args(["--scene", "radial-2d", "--scheme", "p1", "--out", &scratch.path("out")]);
        let output = program.args(options.split_whitespace()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{command_name}: {}", stderr(&output));
        if command_name == "compare" {
            assert!(stdout(&output).contains("radial-2d: n subdivisions of the shortest side;"));
        }
        let help = stdout(&command(command_name).arg("--help").output().unwrap());
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in ["On a box: subdivisions of its shortest side", "refinements"] {
            assert!(words.contains(part), "{command_name}: no {part} in {words}");
        }
    }
    let on_mesh =
        format!("--scene radial-2d --mesh {mesh} --scheme p1 --levels 0,1 --no-fields --details");
    let tables = stdout(&scratch.run(&on_mesh));
    assert!(tables.contains("radial-2d: n refinements of the mesh;"), "{tables}");
}
