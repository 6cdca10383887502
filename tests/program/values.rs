//! Values by name in the reports of the program.

use super::run::{Scratch, number, read_json, rows, stderr, stdout};

fn balance() -> String {
    format!("{}/examples/problems/balance.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn values_stand_in_rows_tables_and_columns() {
    let scratch = Scratch::new("values");
    let output = scratch.run(&format!("{} --scheme p1,sipg-p2 --levels 4,8,16", balance()));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("out/report.json"));
    for row in rows(&report) {
        let forces = ["held", "pressed"].map(|name| number(row, &["values", name]));
        let loads = 8.0 / 3.0 - 0.5 - 2.0 * number(row, &["values", "mean"]);
        assert!((loads + forces[0] + forces[1]).abs() < 1e-8, "{}: {forces:?}", row["label"]);
        assert!(number(row, &["error", "values", "mean"]) < 1e-2);
        assert_eq!(row["values_at"]["lowest"], serde_json::json!([2.0, 1.0]));
    }
    let limit = &report["extrapolated"][0]["values"]["mean"];
    assert!((number(limit, &["value"]) - 1.0 / 3.0).abs() < 1e-4, "{limit}");
    let csv = scratch.read("out/report.csv");
    let header = csv.lines().next().unwrap();
    for column in ["values.mean", "error.values.mean", "values_at.lowest"] {
        assert!(header.split(',').any(|key| key == column), "{column}: {header}");
    }
    let text = stdout(&output);
    assert!(text.contains("balance: values, at the finest level of each scheme"), "{text}");
    let line = text.lines().find(|line| line.starts_with("held") && line.contains("p1")).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[..3], ["held", "p1", "16"]);
    assert!((words[3].parse::<f64>().unwrap() + 3.5).abs() < 1e-2, "{line}");
    for file in ["report.html", "report.md", "report.tex"] {
        let text = scratch.read(&format!("out/{file}"));
        assert!(text.contains("balance: values") && text.contains("pressed"), "{file}");
    }
}

/// A Robin side and a tensor: the solution is quadratic, and forces balance the loads.
#[test]
fn an_aquifer_has_its_closed_values() {
    let scratch = Scratch::new("aquifer");
    let file = format!("{}/examples/problems/aquifer.toml", env!("CARGO_MANIFEST_DIR"));
    let report = scratch.report(&format!("{file} --scheme p1,cr,sipg,wopsip,p2 --levels 4,8,16"));
    for row in rows(&report) {
        let [drained, held] = ["drained", "held"].map(|name| number(row, &["values", name]));
        assert!((held - 3.5).abs() < 1e-8, "{}: {held}", row["label"]);
        assert!(row["warnings"].as_array().is_none_or(Vec::is_empty), "{}", row["warnings"]);
        let error = (drained - 4.25).abs();
        assert!(error < if row["label"] == "p2" { 1e-8 } else { 0.2 }, "{}: {error}", row["label"]);
        assert!(row["bound"]["unproven"].as_array().unwrap().len() < 2, "{}", row["bound"]);
    }
    for limit in report["extrapolated"].as_array().unwrap() {
        let [value, expected] = [number(limit, &["values", "drained", "value"]), 4.25];
        assert!((value - expected).abs() < 1e-2, "{limit}");
    }
}

/// An exact solution is held against Robin data too.
#[test]
fn a_solution_that_breaks_a_robin_condition_is_named() {
    let scratch = Scratch::new("wrong-robin");
    let file = format!("{}/examples/problems/aquifer.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).unwrap().replace("304 + y / 4", "305 + y / 4");
    let file = scratch.file("wrong.toml", &text);
    let report = scratch.report(&format!("{file} --scheme p1 --levels 4"));
    let warnings = rows(&report)[0]["warnings"].to_string();
    assert!(warnings.contains("not fulfilled: the Robin condition"), "{warnings}");
}

/// Problems that ask for no values have none of their keys.
#[test]
fn rows_without_values_have_no_keys_of_them() {
    let scratch = Scratch::new("no-values");
    let report = scratch.report("--scene radial-1d --scheme p1 --levels 4,8,16 --no-fields");
    let row = rows(&report)[0].as_object().unwrap();
    for key in ["values", "values_at", "constants"] {
        assert!(!row.contains_key(key), "{key}");
    }
    assert!(row["error"].get("values").is_none());
    assert!(report["extrapolated"][0].get("values").is_none());
}
