//! Problems of one's own, boundary groups by name, and references.

use super::run::{
    Scratch, command, data, default_request, number, read_json, refused, rows, stderr,
};
use super::square::Square;
use serde_json::Value;

fn example(name: &str) -> String {
    format!("{}/examples/problems/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn a_membrane_from_a_file_is_measured_against_a_reference() {
    let scratch = Scratch::new("membrane");
    let options = "--scheme p1,cr,wopsip:facet-means --levels 0,1,2 --reference 4";
    let report = scratch.report(&format!("{} {options}", example("membrane")));
    assert_eq!(rows(&report).len(), 9);
    for row in rows(&report) {
        assert_eq!(row["scene"], "membrane");
        assert_eq!(row["against"], "p2 at level 4");
        assert_eq!(row["status"], "converged");
        assert!(number(row, &["energy"]) < 0.0 && number(row, &["contact_measure"]) > 0.0);
        for key in ["multiplier_l1", "multiplier_l2", "contact_area_error"] {
            assert!(number(row, &[key]) > 0.0, "{key}");
        }
        if row["level"] != 0 {
            let order = number(row, &["order", "h1"]);
            assert!((0.85..1.15).contains(&order), "{order}");
            let area = number(row, &["contact_area_error"]) / number(row, &["contact_measure"]);
            assert!(area < 0.5, "{area}");
        }
    }
    // what errors leave out of the first table stands in a second one
    let text = scratch.read("out/report.md");
    assert!(text.contains("membrane: totals and stages"), "{text}");
    for name in ["energy", "contact", "resultant", "bound", "stages (outer)"] {
        assert!(text.contains(&format!("| {name}")), "{name}: {text}");
    }
    assert!(text.contains("direct-active-set (") && text.contains("extrapolated, p1: energy"));
    for file in ["membrane-p1.vtu", "report.html", "convergence.svg"] {
        assert!(scratch.0.join("out").join(file).exists(), "{file}");
    }
    let plot = scratch.read("out/convergence.svg");
    assert!(plot.contains("against p2 at level 4"));
}

#[test]
fn the_foot_of_the_bracket_carries_the_load() {
    let scratch = Scratch::new("bracket");
    let schemes = "p1,cr,sipg,nipg,iipg,ldg,br2,wopsip,wopsip:facet-means,p2,sipg-p2";
    let report = scratch.report(&format!("{} --scheme {schemes} --levels 0", example("bracket")));
    let load = 0.6 * 0.3 + 0.3 * 0.6 * 0.9 + 2.0 * 0.3 * 0.6;
    for row in rows(&report) {
        let resultant = number(row, &["resultant"]);
        assert!((resultant - load).abs() < 1e-8 * load, "{}: {resultant}", row["label"]);
        let measure = number(row, &["contact_measure"]);
        assert!((0.0..0.6).contains(&measure), "{}: {measure}", row["label"]);
        assert!(row["against"].is_null() && row["error"]["l2"].is_null());
    }
}

#[test]
fn the_work_of_a_problem_of_ones_own() {
    let scratch = Scratch::new("own-work");
    let out = scratch.path("out");
    let mut work = command("work-precision");
    work.args([&example("plate"), "--scheme", "p1,sipg", "--levels", "0,1", "--reference", "3"]);
    let output = work.args(["--rounds", "1", "--subject", "p1", "--out", &out]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("out/report.json"));
    assert_eq!(rows(&report).len(), 4);
    for row in rows(&report) {
        assert_eq!(row["against"], "p2 at level 3");
        assert!(number(row, &["error", "h1"]) > 0.0 && number(row, &["seconds", "total"]) > 0.0);
    }
    for file in ["report.md", "report.tex", "report.html"] {
        let text = std::fs::read_to_string(scratch.0.join("out").join(file)).unwrap();
        assert!(text.contains("errors against p2 at level 3"), "{file}");
    }
}

/// Without an error to reach, a bound is reached.
#[test]
fn the_work_of_a_problem_of_ones_own_by_its_bound() {
    let scratch = Scratch::new("own-work-bound");
    let out = scratch.path("out");
    let mut work = command("work-precision");
    work.args([&example("plate"), "--scheme", "p1,sipg", "--out", &out]);
    let output = work.args(["--adaptive", "steps=3", "--rounds", "1"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("only bounds are reached, for no error is known"));
    let report = read_json(&scratch.0.join("out/report.json"));
    assert_eq!(rows(&report).len(), 2 * 4);
    for row in rows(&report) {
        assert!(row["error"]["l2"].is_null() && number(row, &["bound", "total"]) > 0.0);
    }
    let adaptive = report["program"]["request"]["adaptive"].as_str().unwrap();
    assert!(adaptive.contains("theta 0.5, at most 3 steps"), "{adaptive}");
    let reach = report["reach"].as_array().unwrap();
    assert!(!reach.is_empty() && reach.iter().all(|r| r["norm"] == "bound"), "{reach:?}");
    assert!(report["verdicts"][0].as_str().unwrap().contains("at an error bound of"));
}

#[test]
fn a_box_of_ones_own() {
    let scratch = Scratch::new("own-box");
    let text = "box = [[0], [2]]\n[source]\ndefault = \"-(2 * x)^2\"\n\
        [obstacle]\nlower.default = -0.2\n[boundary.left]\nkind = \"dirichlet\"\n\
        [boundary.right]\nkind = \"neumann\"\nflux = \"0.1 * nx\"\n";
    let path = scratch.file("rod.toml", text);
    let output =
        scratch.run(&format!("{path} --scheme p1,sipg --levels 8,16 --reference 64 --details"));
    let report = read_json(&scratch.0.join("out/report.json"));
    // on a terminal the second table has the finest level of each series
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> =
        text.lines().skip_while(|line| !line.contains("stages (outer)")).collect();
    assert!(
        lines[0].split_whitespace().eq([
            "scheme",
            "n",
            "energy",
            "contact",
            "resultant",
            "bound",
            "stages",
            "(outer)"
        ]),
        "{text}"
    );
    assert!(lines[1].starts_with("p1") && lines[2].starts_with("sipg"), "{text}");
    assert!(lines[1].contains("  16  ") && lines[1].contains("direct-active-set ("), "{text}");
    assert_eq!(rows(&report)[0]["scene"], "rod");
    assert!(rows(&report).iter().all(|row| row["against"] == "p2 at level 64"));
}

#[test]
fn wrong_problems_and_references_are_refused() {
    let scratch = Scratch::new("wrong-problems");
    let wrong = scratch.file("wrong.toml", "box = [[0], [1]]\n[source]\ndefault = \"2 * y\"\n");
    refused(&scratch, &[&wrong], &["wrong.toml:3:16: there is no `y`; there are x, e, pi"]);
    refused(&scratch, &["nowhere.toml"], &["nowhere.toml"]);
    refused(&scratch, &["radial-2d"], &["no file radial-2d", "--scene"]);
    let plate = example("plate");
    refused(&scratch, &[&plate, "--scene", "radial-2d"], &["--scene"]);
    refused(&scratch, &[&plate, "--load", "7"], &["--load 7.0", "a parameter of scenes"]);
    let coarse = [&plate[..], "--levels", "0,1", "--reference", "2"];
    refused(&scratch, &coarse, &["level of the reference", "at least 3"]);
    refused(&scratch, &[&plate, "--reference", "p3@level=4"], &["p3"]);
    refused(&scratch, &[&plate, "--reference", "fine"], &["--reference", "SCHEME@level=N"]);
    let disc = ["--scene", "disc-2d", "--levels", "4", "--reference", "16"];
    refused(&scratch, &disc, &["not nested"]);
}

#[test]
fn groups_of_a_mesh_are_given_their_condition() {
    let scratch = Scratch::new("boundary");
    let text = Square::with(|s| s.names[0] = "1 1 \"wall\"");
    let mesh = scratch.file("wall.msh", &text);
    let options = format!("--scene radial-2d --scheme p1 --levels 1 --mesh {mesh}");
    let report = scratch.report(&format!("{options} --boundary wall=dirichlet"));
    assert_eq!(rows(&report).len(), 1);
    std::fs::remove_dir_all(scratch.0.join("out")).unwrap();
    let with = |boundary: &'static str| {
        ["--scene", "radial-2d", "--mesh", &mesh, "--boundary", boundary].map(str::to_owned)
    };
    for (boundary, words) in [
        ("gate=dirichlet", "has no group gate; it has wall"),
        ("wall=robin", "NAME=dirichlet, NAME=neumann or NAME=contact"),
    ] {
        let options = with(boundary);
        let options: Vec<&str> = options.iter().map(String::as_str).collect();
        refused(&scratch, &options, &[words]);
    }
}

#[test]
fn every_command_takes_a_mesh_and_the_conditions_on_its_boundary() {
    let scratch = Scratch::new("commands");
    let text = Square::with(|s| s.names[0] = "1 1 \"wall\"");
    let mesh = scratch.file("wall.msh", &text);
    let run = |name: &str, options: &str| {
        let output = command(name).args(options.split(' ')).output().unwrap();
        (output.status.code(), stderr(&output))
    };
    let out = scratch.path("pictures");
    let on = format!("--scene radial-2d --mesh {mesh} --out {out}");
    let bound = format!("{on} --boundary wall=dirichlet");
    for (name, options) in [
        ("pictures", "--scheme p1 --level 1"),
        ("work-precision", "--scheme p1 --levels 1 --rounds 1"),
    ] {
        assert_eq!(run(name, &format!("{bound} {options}")), (Some(0), String::new()), "{name}");
        let (code, message) = run(name, &on);
        assert_eq!(code, Some(2), "{name}: {message}");
        assert!(message.contains("nothing says what holds on boundary group wall"), "{message}");
        let (code, message) = run(name, &format!("{on} --boundary gate=contact"));
        assert_eq!(code, Some(2), "{name}: {message}");
        assert!(message.contains("has no group gate; it has wall"), "{message}");
    }
    assert!(scratch.0.join("pictures/radial-2d-p1-1.svg").exists());
    let tetrahedra = format!("{}/tests/data/unstructured_cube.msh", env!("CARGO_MANIFEST_DIR"));
    let (code, message) = run(
        "stability",
        &format!("--quick --case slivers --mesh {tetrahedra} --boundary gate=contact --out {out}"),
    );
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("has no group gate; it has"), "{message}");
    let (code, message) = run("pictures", &format!("{} --scheme p1 --out {out}", example("plate")));
    assert_eq!((code, &message[..]), (Some(0), ""));
    assert!(scratch.0.join("pictures/plate-p1-0.svg").exists());
}

#[test]
fn a_report_outlives_a_wrong_directory_and_pictures_show_the_finest_level() {
    let scratch = Scratch::new("outlives");
    let options = "--scene radial-2d --scheme p1 --levels 8,4";
    assert_eq!(rows(&scratch.report(options)).len(), 2);
    let picture = scratch.read("out/radial-2d-p1.svg");
    assert!(picture.contains("radial-2d-p1, level 8"));
    let file = scratch.file("file", "");
    let output = scratch.run(&format!("{options} --dump {file}/inequalities"));
    assert_ne!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("cannot write"), "{}", stderr(&output));
    assert_eq!(rows(&read_json(&scratch.0.join("out/report.json"))).len(), 2);
}

#[test]
fn the_default_request_has_two_scenes_and_both_placements() {
    let (_, report) = default_request();
    let labels = ["p1", "sipg", "wopsip", "wopsip:facet-means"];
    let expected = ["hill-2d", "signorini-halves-2d"].map(|scene| {
        labels.map(|label| [8, 16, 32, 64, 128].map(|level| (scene, label, level))).concat()
    });
    let found: Vec<(&str, &str, u64)> = rows(report)
        .iter()
        .map(|r| {
            let text = |key: &str| r[key].as_str().unwrap();
            (text("scene"), text("label"), r["level"].as_u64().unwrap())
        })
        .collect();
    assert_eq!(found, expected.concat());
}

#[test]
fn a_report_against_another_reference_is_not_resumed() {
    let scratch = Scratch::new("resume-reference");
    let options = format!("{} --scheme p1 --levels 0 --reference", example("membrane"));
    scratch.report(&format!("{options} 2"));
    let output = scratch.run(&format!("{options} 3 --resume"));
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("reference p2 at level"), "{}", stderr(&output));
    scratch.report(&format!("{options} 2 --resume"));
}

/// One reference that fails ends neither the study nor the rows of other scenes.
#[test]
fn rows_stand_without_a_reference_that_fails() {
    let scratch = Scratch::new("no-reference");
    let options = "--scene radial-2d,signorini-2d --scheme p1 --levels 4 --quiet --no-fields";
    let report = scratch.report(&format!("{options} --reference sipg-p2@sigma=1e-2,level=16"));
    assert_eq!(rows(&report).len(), 2);
    for row in rows(&report) {
        assert_eq!(row["status"], "converged");
        assert!(row["against"].is_null() && row["error"]["h1"].is_null());
        let warning = row["warnings"][0].as_str().unwrap();
        assert!(warning.contains("sipg-p2@sigma=0.01 at level 16, was not found"), "{warning}");
    }
}

/// A gap above the Dirichlet data beside it leaves no function of finite energy.
#[test]
fn a_gap_above_the_dirichlet_data_beside_it_is_infeasible() {
    let scratch = Scratch::new("lifted");
    let sides = ["left", "right", "top"].map(|s| format!("[boundary.{s}]\nkind = \"dirichlet\"\n"));
    for (gap, status) in [("0.5", "infeasible"), ("\"4 * x * (1 - x)\"", "converged")] {
        let bottom = format!("[boundary.bottom]\nkind = \"contact\"\ngap = {gap}\n");
        let text = format!("box = [[0, 0], [1, 1]]\n{}{bottom}", sides.concat());
        let path = scratch.file("lifted.toml", &text);
        scratch.run(&format!("{path} --scheme p1,cr,sipg,wopsip --levels 4 --quiet"));
        let report = read_json(&scratch.0.join("out/report.json"));
        assert_eq!(rows(&report).len(), 4);
        for row in rows(&report) {
            assert_eq!(row["status"], status, "{row}");
            assert_eq!(row["energy"].is_null(), status == "infeasible", "{row}");
        }
    }
}

/// A report has the files of its own request only, and foreign files stay.
#[test]
fn files_of_an_earlier_request_go() {
    let scratch = Scratch::new("earlier");
    scratch.report("--scene radial-2d --scheme p1,sipg --levels 8");
    let out = scratch.0.join("out");
    std::fs::write(out.join("mine-p1.svg"), "foreign").unwrap();
    assert!(out.join("radial-2d-p1.svg").exists() && out.join("report.tex").exists());
    // more cells than are drawn
    scratch.report("--scene radial-2d --scheme p1 --levels 64 --no-fields");
    for name in ["radial-2d-p1.svg", "radial-2d-p1.vtu", "radial-2d-sipg.svg"] {
        assert!(!out.join(name).exists(), "{name}");
    }
    assert!(out.join("mine-p1.svg").exists());
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(!page.contains("radial-2d-p1.svg"));

    let mut work = command("work-precision");
    let options = "--scene radial-2d --scheme p1,sipg --levels 4 --rounds 1";
    let work = work.args(options.split(' ')).args(["--out", &scratch.path("out")]);
    assert_eq!(work.output().unwrap().status.code(), Some(0));
    assert!(out.join("radial-2d-time.svg").exists() && out.join("reach.csv").exists());
    scratch.report("--scene signorini-2d --scheme p1 --levels 4");
    for name in ["radial-2d-time.svg", "radial-2d-unknowns.svg", "reach.csv"] {
        assert!(!out.join(name).exists(), "{name}");
    }
}

fn warns(row: &Value, text: &str) -> bool {
    row["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains(text))
}

/// The solution on a disc is none on the polygon of its mesh: every row says so, and a bound that is guaranteed lies
/// below the distance from it.
#[test]
fn a_solution_on_the_disc_is_none_on_a_polygon() {
    let scratch = Scratch::new("disc");
    let schemes = "p1,p2,cr,sipg,wopsip,sipg-p2";
    let report = scratch.report(&format!("{} --scheme {schemes} --levels 0,1", data("disc0")));
    let mut below = 0;
    for row in rows(&report) {
        assert_eq!(row["bound"]["guaranteed"], true, "{}", row["label"]);
        let not_fulfilled = "the stated solution does not solve this problem: not fulfilled: \
            Dirichlet data equal to the solution";
        assert!(warns(row, not_fulfilled), "{row}");
        if number(row, &["bound", "effectivity"]) < 0.999 {
            let said = "the stated solution does not solve this problem: its distance";
            assert!(warns(row, said), "{row}");
            below += 1;
        }
    }
    assert!(below > 0);
    let text = scratch.read("out/report.md");
    assert!(text.contains("the stated solution does not solve this problem"), "{text}");
}

/// Where a file states the shape of its boundary the stated solution is that of the curved domain, the bound is for the
/// polygon, and no finer solution is a reference.
#[test]
fn a_solution_on_a_curved_domain_has_the_order_of_straight_cells() {
    let scratch = Scratch::new("torsion");
    let torsion = example("torsion");
    let reference = [&torsion[..], "--levels", "0,1", "--reference", "3"];
    refused(&scratch, &reference, &["level of the reference", "has a shape", "not nested"]);
    let report = scratch.report(&format!("{torsion} --scheme p1,sipg,wopsip,p2 --levels 1,2,3"));
    for row in rows(&report) {
        assert!(!warns(row, "the stated solution does not solve"), "{}", row["warnings"]);
        assert_eq!(row["bound"]["unproven"].as_array().unwrap().last().unwrap(), "shape");
        if row["level"] == 3 {
            assert!((number(row, &["values", "mean"]) - 9.0 / 26.0).abs() < 1e-3, "{row}");
            let held = number(row, &["values", "held"]) + 3.0 * std::f64::consts::PI;
            assert!(held.abs() < 3e-3, "{row}");
            let order = number(row, &["order", "energy"]);
            let least = if row["scheme"] == "p2" { 1.4 } else { 0.95 };
            assert!(order > least && order < 1.6, "{}: {order}", row["label"]);
        }
    }
    let report = scratch.report(&format!("{torsion} --scheme p1 --adaptive steps=5"));
    let steps = rows(&report);
    let errors = [0, steps.len() - 1].map(|k| number(&steps[k], &["error", "broken_energy"]));
    assert!(steps.len() == 6 && errors[1] < 0.4 * errors[0], "{errors:?}");
}

/// Dirichlet values of two groups that differ where they meet belong to no function of finite energy.
#[test]
fn dirichlet_values_that_jump_are_named() {
    let scratch = Scratch::new("jump");
    let report = scratch.report(&format!("{} --scheme p1,cr,sipg,p2 --levels 2,4", data("jump")));
    for row in rows(&report) {
        for (group, point) in [("left", "(0.000000, 1.000000)"), ("right", "(1.000000, 1.000000)")]
        {
            let said = format!("`{group}` and `top` differ where they meet, 0.05 and 1 at {point}");
            assert!(warns(row, &said), "{}", row["warnings"]);
        }
        let unproven = row["bound"]["unproven"].as_array().unwrap();
        assert!(unproven.contains(&"boundary".into()), "{}", row["bound"]);
    }
    let text = scratch.read("out/report.md");
    assert!(text.contains("bound with terms that are not proven: boundary"), "{text}");
}
