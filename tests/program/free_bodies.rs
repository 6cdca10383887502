//! Bodies that bounds alone hold: one test of motions, whose answer does not depend on the scheme.

use serde_json::Value;

use super::run::{Scratch, read_json, rows, stderr};

const SCHEMES: &str = "p1,p2,cr,sipg,sipg-p2,wopsip,wopsip:facet-means,nipg,iipg,ldg,br2,bmmpr";

/// Contact on the lower side of a square.
const SQUARE: &str = "mesh = \"square_in_groups.msh\"\n[boundary.bottom]\nkind = \"contact\"\n\
    [boundary.right]\nkind = \"neumann\"\n[boundary.left]\nkind = \"neumann\"\n\
    [boundary.top]\nkind = \"neumann\"\n";

/// Contact on the left end of a string that a flux holds up.
fn string(flux: f64) -> String {
    format!(
        "box = [[0.0], [1.0]]\n[source]\ndefault = -1.0\n[boundary.left]\nkind = \"contact\"\n\
         [boundary.right]\nkind = \"neumann\"\nflux = {flux}\n"
    )
}

/// A square without supports.
const NEUMANN: &str = "box = [[0, 0], [1, 1]]\n[boundary.bottom]\nkind = \"neumann\"\n\
    [boundary.left]\nkind = \"neumann\"\n[boundary.right]\nkind = \"neumann\"\n\
    [boundary.top]\nkind = \"neumann\"\n";

const FAR_ABOVE: &str = "[obstacle]\nupper.default = 10.0\n";

fn source(text: &str) -> String {
    format!("[source]\ndefault = \"{text}\"\n")
}

/// The rows of a problem file for all schemes on some levels.
fn rows_of(name: &str, text: &str, options: &str) -> Vec<Value> {
    let scratch = Scratch::new(name);
    let mesh = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/problems");
    std::fs::copy(mesh.join("square_in_groups.msh"), scratch.0.join("square_in_groups.msh"))
        .unwrap();
    let path = scratch.file("problem.toml", text);
    let output = scratch.run(&format!("{path} --scheme {SCHEMES} --quiet {options}"));
    let report = scratch.0.join("out/report.json");
    assert!(report.exists(), "{name}: {}", stderr(&output));
    let found = rows(&read_json(&report)).to_vec();
    let levels = options.split_whitespace().nth(1).unwrap().split(',').count();
    assert_eq!(found.len(), SCHEMES.split(',').count() * levels, "{name}");
    found
}

fn all_are(name: &str, rows: &[Value], status: &str) {
    for row in rows {
        assert_eq!(
            row["status"], status,
            "{name}: {} at {}: {}",
            row["label"], row["level"], row["message"]
        );
    }
}

/// All rows are converged with this resultant, up to a share of it.
fn all_have_resultant(name: &str, rows: &[Value], (expected, share): (f64, f64)) {
    all_are(name, rows, "converged");
    for row in rows {
        let resultant = row["resultant"].as_f64().unwrap();
        let is_right = (resultant / expected - 1.0).abs() < share;
        assert!(is_right, "{name}: {} at {}: {resultant}", row["label"], row["level"]);
    }
}

#[test]
fn room_between_two_bounds_under_a_balanced_load_leaves_many_solutions() {
    let square = format!("{SQUARE}{}{FAR_ABOVE}", source("x-0.5"));
    let string = format!("{}{FAR_ABOVE}", string(1.0));
    for (name, text, levels) in [("square", square, "0,1,2"), ("string", string, "1,2,8,17")] {
        for precision in ["f64", "f32"] {
            let rows = rows_of(name, &text, &format!("--levels {levels} --precision {precision}"));
            all_are(name, &rows, "not-unique");
            for row in rows {
                // nothing bounds the distance from a solution that is one of many
                assert!(row["certificate"]["algebraic_bound"].is_null(), "{name}: {row}");
                let message = row["message"].as_str().unwrap();
                assert!(
                    message.contains("do not decide") && message.contains("resultant"),
                    "{message}"
                );
            }
        }
    }
}

/// The kernel vectors are those of the matrix before it was rounded.
#[test]
fn bounds_alone_hold_bodies_in_single_precision() {
    let membrane = format!("{NEUMANN}{}[obstacle]\nlower.default = 0\n", source("-1+x"));
    let cube = "box = [[0, 0, 0], [1, 1, 1]]\n[boundary.default]\nkind = \"neumann\"\n\
        [boundary.bottom]\nkind = \"contact\"\n[source]\ndefault = -1\n";
    for (name, text, expected) in
        [("single-plane", &membrane[..], 0.5), ("single-space", cube, 1.0)]
    {
        let rows = rows_of(name, text, "--levels 1,2,4 --precision f32");
        all_have_resultant(name, &rows, (expected, 1e-4));
    }
}

/// The forces are those without the upper obstacle, which is never touched.
#[test]
fn a_small_resultant_is_carried() {
    // the last one has four digits in a load of one, and forces are differences of such loads
    for (small, share) in [(1e-7, 0.01), (1e-9, 0.01), (1e-12, 0.1)] {
        let text = format!("{SQUARE}{}{FAR_ABOVE}", source(&format!("x - 0.5 - {small:e}")));
        let rows = rows_of("nearly-square", &text, "--levels 0,1,2");
        all_have_resultant(&format!("square {small:e}"), &rows, (small, share));
        let text = format!("{}{FAR_ABOVE}", string(1.0 - small));
        let rows = rows_of("nearly-string", &text, "--levels 1,2,8,17");
        all_have_resultant(&format!("string {small:e}"), &rows, (small, share));
    }
}

#[test]
fn an_obstacle_alone_holds_a_membrane() {
    let lower = "[obstacle]\nlower.default = 0\n";
    let text = format!("{NEUMANN}{}{lower}", source("-1+x"));
    all_have_resultant("pressed", &rows_of("pressed", &text, "--levels 1,2,8"), (0.5, 1e-9));
    let text = format!("{NEUMANN}{}{lower}", source("1-x"));
    all_are("pulled", &rows_of("pulled", &text, "--levels 1,2"), "no-solution");
    // between two obstacles the load presses against the upper one; here it also bends down to the lower one
    let both = "[obstacle]\nlower.default = 0\nupper.default = 0.01\n";
    let text = format!("{NEUMANN}{}{both}", source("4-6*x"));
    all_have_resultant("between", &rows_of("between", &text, "--levels 2,8"), (-1.0, 1e-9));
}

/// Loads that are balanced, but not by a quadrature rule: no scheme takes the error of its rule for a resultant.
#[test]
fn the_error_of_a_rule_does_not_decide() {
    let lower = "[obstacle]\nlower.default = 0\n";
    let both = "[obstacle]\nlower.default = 0\nupper.default = 10\n";
    for load in ["sin(2*pi*x)", "sqrt(x)-2/3", "if(x < 0.3, 7/3, -1)"] {
        for bounds in [lower, both] {
            let text = format!("{NEUMANN}{}{bounds}", source(load));
            all_are(load, &rows_of("balanced", &text, "--levels 1,2,3"), "not-unique");
            let interval = format!(
                "box = [[0], [1]]\n[boundary.left]\nkind = \"neumann\"\n\
                 [boundary.right]\nkind = \"neumann\"\n{}{bounds}",
                source(load)
            );
            all_are(load, &rows_of("balanced-1d", &interval, "--levels 1,2,8"), "not-unique");
        }
    }
}
