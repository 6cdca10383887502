//! A constant in the data: kelvin for degrees Celsius, bodies at different levels, levels of 1e7.

use std::path::Path;

use serde_json::Value;
use unilateral::exchange::read_vector;

use super::run::{Scratch, command, data, number, read_json, rows, stderr, stdout};

fn report(scratch: &Scratch, problem: &str, options: &str) -> Value {
    scratch.report(&format!("{} --no-fields --quiet {options}", data(problem)))
}

/// The solution is a constant, which every scheme has.
#[test]
fn a_constant_is_a_solution_of_every_scheme() {
    let scratch = Scratch::new("constant");
    for (problem, levels) in [("constant_everywhere", "4,8"), ("two_bodies", "0,1")] {
        let report = report(&scratch, problem, &format!("--scheme all --levels {levels}"));
        assert_eq!(rows(&report).len(), 38);
        for row in rows(&report) {
            assert_eq!(row["status"], "converged", "{} {problem}", row["label"]);
            if problem == "constant_everywhere" {
                let [l2, h1] = ["l2", "h1"].map(|norm| number(row, &["error", norm]));
                let bound = number(row, &["bound", "total"]);
                assert!(l2 < 1e-12 && h1 < 1e-12 && bound < 1e-12, "{}", row["label"]);
            }
        }
    }
}

/// Statuses, steps, forces, bounds and warnings in kelvin are those in degrees Celsius.
#[test]
fn kelvin_and_celsius_agree() {
    let scratch = Scratch::new("kelvin");
    let options = "--scheme p1,cr,sipg,wopsip,sipg-p2 --levels 16";
    let [kelvin, celsius] = ["kelvin", "celsius"].map(|problem| report(&scratch, problem, options));
    for (one, other) in rows(&kelvin).iter().zip(rows(&celsius)) {
        let label = &one["label"];
        for key in ["status", "warnings", "active", "contact_measure", "iterations"] {
            assert_eq!(one[key], other[key], "{label} {key}");
        }
        for key in ["resultant", "penetration"] {
            let [a, b] = [one, other].map(|row| number(row, &[key]));
            assert!((a - b).abs() <= 1e-9 * a.abs() + 1e-12, "{label} {key}: {a} and {b}");
        }
        // signs of multipliers that are rounding decide on the flux of quadratics
        let share = if label == "sipg-p2" { 0.05 } else { 1e-6 };
        let [a, b] = [one, other].map(|row| number(row, &["bound", "total"]));
        assert!((a - b).abs() <= share * a, "{label}: {a} and {b}");
        // the load is -0.5 on a square of measure one
        let [a, b] = [one, other].map(|row| number(row, &["energy"]));
        assert!((a - 0.5 * 273.16 - b).abs() < 1e-9, "{label}: {a} and {b}");
    }
}

/// Only differences from the level count.
#[test]
fn errors_on_a_high_level_are_those_without_it() {
    let scratch = Scratch::new("far");
    let options = "--scheme p1,sipg,iipg,ldg,sipg-p2 --levels 16";
    let [far, near] = ["far_exact", "near_exact"].map(|problem| report(&scratch, problem, options));
    for (far, near) in rows(&far).iter().zip(rows(&near)) {
        assert_eq!(far["status"], "converged");
        for keys in [["error", "l2"], ["error", "h1"], ["error", "max"], ["bound", "total"]] {
            let [a, b] = [far, near].map(|row| number(row, &keys));
            assert!((a - b).abs() < 1e-4 * b, "{} {keys:?}: {a} and {b}", far["label"]);
        }
    }
}

/// The foundation and the source alone say where the body is.
#[test]
fn gaps_and_reactions_give_the_level() {
    let scratch = Scratch::new("levels");
    let of_gap = report(&scratch, "far_gap", "--scheme p1,p2,cr,sipg --levels 8");
    for row in rows(&of_gap) {
        assert_eq!(row["status"], "converged", "{}", row["label"]);
        let force = number(row, &["resultant"]);
        assert!((force - 0.75).abs() < 1e-7, "{}: {force}", row["label"]);
    }
    let options = "--scheme p1,p2,sipg --levels 16";
    let [far, near] =
        ["far_reaction", "near_reaction"].map(|problem| report(&scratch, problem, options));
    for (far, near) in rows(&far).iter().zip(rows(&near)) {
        assert_eq!(far["status"], "converged");
        for keys in [["error", "l2"], ["error", "h1"], ["bound", "total"]] {
            let [a, b] = [far, near].map(|row| number(row, &keys));
            assert!((a - b).abs() < 1e-3 * b, "{} {keys:?}: {a} and {b}", far["label"]);
        }
    }
}

/// The inequality on file is that of the solution less the constant, which lies beside it and is added to what comes
/// back.
#[test]
fn a_dump_has_the_constant_beside_it() {
    let scratch = Scratch::new("constant-dump");
    let dump = scratch.path("dump");
    let options = format!("--scheme p1 --levels 4,8 --dump {dump}");
    let report = report(&scratch, "kelvin", &options);
    for row in rows(&report) {
        let folder = Path::new(&dump).join(format!("kelvin-p1-{}", row["level"]));
        let read = |name: &str| read_vector(folder.join(name)).unwrap();
        let (constant, lower, upper) = (read("constant.npy"), read("lower.npy"), read("upper.npy"));
        assert!(constant.iter().all(|c| *c == 273.16));
        // the obstacle and the Dirichlet value less the constant
        let fixed = lower.iter().zip(&upper).filter(|(l, u)| l == u);
        assert!(fixed.map(|(l, _)| l).all(|value| *value == 0.0));
        // all but the boundary touches the obstacle, or nearly
        let text: Vec<String> = lower.iter().map(|value| format!("{value:e}")).collect();
        std::fs::write(folder.join("u.txt"), text.join("\n")).unwrap();
        let vector = folder.join("u.txt");
        let output = command("judge").arg(&folder).arg(&vector).arg("--json").output().unwrap();
        let judged: Value = serde_json::from_str(&stdout(&output))
            .unwrap_or_else(|_| panic!("{}", stderr(&output)));
        let judged = &rows(&judged)[0];
        assert_eq!(judged["certificate"]["feasibility"], 0.0);
        // of the obstacle, with a load of -0.5 on a square of measure one, but for a strip along the boundary
        let energy = number(judged, &["energy"]);
        assert!((energy - 0.5 * 273.16).abs() < 0.01, "{energy}");
    }
    // of an inequality without a constant none stays
    let of_celsius = data("celsius");
    let text = std::fs::read_to_string(&of_celsius).unwrap().replace("celsius", "kelvin");
    let same_name = scratch.file("kelvin.toml", &text);
    let again = format!("{same_name} --no-fields --quiet {options}");
    scratch.report(&again);
    assert!(!Path::new(&dump).join("kelvin-p1-4/constant.npy").exists());
    assert!(read_json(&scratch.0.join("out/report.json"))["rows"].is_array());
}
