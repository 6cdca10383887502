//! What is printed and written where.

use std::path::Path;

use serde_json::Value;
use unilateral::scenes;

use super::run::{Scratch, command, program, read_json, rows, stderr, stdout};

#[test]
fn the_list_names_everything() {
    let scratch = Scratch::new("list");
    let output = scratch.run("--list");
    assert_eq!(output.status.code(), Some(0));
    let list = stdout(&output);
    let fixed = ["p1", "cr", "sipg", "wopsip", "vertices", "facet-means", "active-set", "direct"];
    let catalogue = scenes::catalogue();
    let names = catalogue.iter().map(|s| &s.name[..]).chain(fixed);
    for name in names {
        let line = list.lines().find(|l| l.split_whitespace().next() == Some(name));
        let line = line.unwrap_or_else(|| panic!("no {name} in {list}"));
        assert!(line.split_whitespace().count() > 2, "{name} is not explained");
    }
    assert!(!scratch.0.join("out").exists());
}

/// Each of several solvers has rows and files of its own.
#[test]
fn solvers_stand_side_by_side() {
    let scratch = Scratch::new("solvers");
    let solvers = ["active-set", "monotone-multigrid"];
    let report = scratch.report(&format!(
        "--scene radial-2d --scheme p1 --levels 4,8 --quiet --solver {}",
        solvers.join(",")
    ));
    let found: Vec<&str> = rows(&report).iter().map(|r| r["solver"].as_str().unwrap()).collect();
    assert_eq!(found, [solvers[0], solvers[0], solvers[1], solvers[1]]);
    let page = scratch.read("out/report.html");
    for solver in solvers {
        for end in ["svg", "vtu"] {
            let file = format!("out/radial-2d-p1-{solver}.{end}");
            assert!(scratch.0.join(&file).exists(), "{file}");
        }
        assert!(page.contains(&format!("p1-{solver} on radial-2d")));
    }
}

#[test]
fn output_goes_where_it_is_asked_to() {
    let scratch = Scratch::new("output");
    let small = "--scene radial-1d --scheme p1 --levels 4";

    let output = scratch.run(&format!("{small} --json -"));
    let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(rows(&printed).len(), 1);
    assert!(stderr(&output).contains("radial-1d"), "tables go to standard error");

    let copy = scratch.path("copy.json");
    let output = scratch.run(&format!("{small} --quiet --json {copy}"));
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
    assert_eq!(read_json(Path::new(&copy)), read_json(&scratch.0.join("out/report.json")));

    let output = scratch.run(&format!("{small} --quiet --json -"));
    assert_eq!(stderr(&output), "");
    assert!(serde_json::from_str::<Value>(&stdout(&output)).is_ok());
}

#[test]
fn options_show_in_the_report() {
    let scratch = Scratch::new("parameters");
    let broken = "--scene radial-2d --scheme sipg,wopsip --levels 4 --quiet";

    let report =
        scratch.report(&format!("{broken} --sigma 20 --eta 3 --precision f32 --threads 1"));
    assert_eq!(report["program"]["precision"], "f32");
    assert_eq!(report["program"]["threads"], 1);
    assert_eq!(rows(&report)[0]["parameters"]["sigma"], 20.0);
    assert_eq!(rows(&report)[1]["parameters"]["eta"], 3.0);

    let report = scratch.report(&format!("{broken} --constraint facet-means --repeat 2"));
    assert_eq!(report["program"]["repeat"], 2);
    assert!(rows(&report).iter().all(|row| row["constraint"] == "facet-means"));

    // Names and levels that are repeated are run once.
    let report = scratch.report("--scene radial-1d,radial-1d --scheme p1,p1 --levels 4,4 --quiet");
    assert_eq!(rows(&report).len(), 1);
}

#[test]
fn fields_are_written_as_asked_for() {
    let small = "--scene radial-1d --scheme p1 --levels 4,8 --quiet";
    let files = |options: &str| -> Vec<String> {
        let scratch = Scratch::new("fields");
        let output = scratch.run(&format!("{small} {options}"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let found = std::fs::read_dir(scratch.0.join("out")).unwrap();
        let names = found.map(|f| f.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> =
            names.filter(|n| n.ends_with(".vtu") || n.ends_with(".pvd")).collect();
        names.sort();
        for name in names.iter().filter(|n| n.ends_with(".vtu")) {
            let bytes = std::fs::read(scratch.0.join("out").join(name)).unwrap();
            let tag = "type=\"Float64\" Name=\"u\"";
            assert!(String::from_utf8_lossy(&bytes).contains(tag), "{name}: no {tag}");
        }
        names
    };
    assert_eq!(files(""), ["radial-1d-p1.vtu"]);
    assert_eq!(files("--no-fields"), [""; 0]);
    let all = ["radial-1d-p1-4.vtu", "radial-1d-p1.pvd", "radial-1d-p1.vtu"];
    assert_eq!(files("--fields-of-all-levels"), all);
    let scratch = Scratch::new("no-fields");
    let output = scratch.run(&format!("{small} --no-fields --fields-of-all-levels"));
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

/// As in `compare --list | head -1`: nobody reads on.
#[test]
fn a_closed_pipe_is_no_error() {
    let scratch = Scratch::new("pipe");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output =
        program().args(["--list", "--out", &scratch.path("out")]).stdout(writer).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
}

/// The same scheme with two factors, in every command that takes schemes.
#[test]
fn all_commands_take_schemes_with_choices() {
    let scratch = Scratch::new("choices");
    let written = "sipg,sipg@factor=1.05,wopsip@factor=10,weight=anisotropic";
    let labels = ["sipg", "sipg@factor=1.05", "wopsip@factor=10,weight=anisotropic"];
    let report =
        scratch.report(&format!("--scene radial-2d --scheme {written} --levels 4 --quiet"));
    let found: Vec<&str> = rows(&report).iter().map(|r| r["label"].as_str().unwrap()).collect();
    assert_eq!(found, labels);
    assert!(scratch.0.join("out/radial-2d-wopsip-factor-10-weight-anisotropic.vtu").exists());

    let run = |name: &str, options: &str| {
        let output = command(name).args(options.split(' ')).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        stdout(&output)
    };
    let out = scratch.path("work");
    let options = format!("--scene radial-2d --scheme {written} --levels 4 --rounds 1 --out {out}");
    let text = run("work-precision", &options);
    // a label that is too long for its column is broken
    assert!(labels[..2].iter().all(|label| text.contains(label)), "{text}");
    assert!(
        text.contains("wopsip@factor=10,") && text.contains("\nweight=anisotropic\n"),
        "{text}"
    );

    let out = scratch.path("pictures");
    run("pictures", &format!("--level 4 --scheme {} --out {out}", labels[2]));
    let name = "radial-2d-wopsip-factor-10-weight-anisotropic-4.svg";
    assert!(Path::new(&out).join(name).exists());
}
