//! What a report writes: keys, numbers, tables, plots and fields, read back by other means.

use crate::rows::{report, row, rows};
use crate::scratch::Scratch;
use crate::support::keys::ROW_KEYS;
use serde_json::Value;
use std::path::Path;
use unilateral::facet::PenaltyParameters;
use unilateral::inequality::Outcome;
use unilateral::measure::Errors;
use unilateral::study::peak_memory_bytes;

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn json_has_the_keys_that_scripts_rely_on() {
    let json: Value = serde_json::from_str(&report(rows()).to_json()).unwrap();
    assert_eq!(keys(&json), ["program", "rows"]);
    let program = ["name", "version", "threads", "precision", "repeat", "target_cpu"];
    assert_eq!(keys(&json["program"]), program);
    assert!(json["program"]["target_cpu"].as_str().unwrap().starts_with(std::env::consts::ARCH));
    let row = &json["rows"][0];
    let added = ["solver", "linear", "warnings"];
    let mut present = keys(row);
    present.retain(|key| !added.contains(key));
    assert_eq!(present, ROW_KEYS);
    assert_eq!(keys(row).len(), ROW_KEYS.len() + added.len());
    assert_eq!(keys(&row["parameters"]), ["sigma", "eta", "rule"]);
    assert_eq!(keys(&row["error"]), ["l2", "h1", "energy", "max"]);
    let orders = ["l2", "h1", "energy", "max", "multiplier_l1", "multiplier_l2"];
    assert_eq!(keys(&row["order"]), orders);
    assert_eq!(keys(&row["expected_order"]), ["l2", "h1"]);
    assert_eq!(keys(&row["iterations"]), ["outer", "linear", "levels", "start_cycles", "stages"]);
    let certificate =
        ["feasibility", "multiplier", "complementarity", "residual", "algebraic_bound"];
    assert_eq!(keys(&row["certificate"]), certificate);
    assert_eq!(keys(&row["seconds"]), ["mesh", "assemble", "solve", "total"]);
    assert_eq!(json["rows"].as_array().unwrap().len(), 18);
}

#[test]
fn what_does_not_apply_or_is_not_finite_is_null() {
    let mut bad = row("radial-2d", "p1", 8);
    bad.parameters = PenaltyParameters::default();
    bad.error = Errors::default();
    (bad.error.l2, bad.error.h1) = (Some(f64::NAN), Some(f64::INFINITY));
    bad.certificate.residual = f64::NAN;
    bad.certificate.feasibility = f64::NEG_INFINITY;
    bad.peak_memory_bytes = None;
    bad.mesh_size = f64::NAN;
    bad.seconds.total = f64::INFINITY;
    let report = report(vec![bad]);
    let text = report.to_json();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let json: Value = serde_json::from_str(&text).unwrap();
    let row = &json["rows"][0];
    for null in [
        &row["parameters"]["sigma"],
        &row["parameters"]["rule"],
        &row["error"]["l2"],
        &row["error"]["h1"],
        &row["certificate"]["residual"],
        &row["certificate"]["feasibility"],
        &row["peak_memory_bytes"],
        &row["mesh_size"],
        &row["seconds"]["total"],
    ] {
        assert!(null.is_null(), "{null}");
    }
    let csv = report.to_csv();
    assert!(!csv.contains("NaN") && !csv.contains("inf"), "{csv}");
    // Nor do plots and tables stumble over it.
    let scratch = Scratch::new("nan");
    report.write(&scratch.0).unwrap();
    assert!(report.to_string().contains("NaN"), "a table must not hide a NaN");
}

/// Cells of comma-separated values, by the rules and not by our writer.
fn read_csv(text: &str) -> Vec<Vec<String>> {
    let (mut lines, mut line, mut cell, mut quoted) = (vec![], vec![], String::new(), false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                cell.push('"');
                chars.next();
            }
            '"' => quoted = !quoted,
            ',' if !quoted => line.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                line.push(std::mem::take(&mut cell));
                lines.push(std::mem::take(&mut line));
            }
            c => cell.push(c),
        }
    }
    assert!(cell.is_empty() && line.is_empty(), "the last line ends");
    lines
}

#[test]
fn csv_reads_back_to_the_same_numbers_as_json() {
    let mut rows = rows();
    rows[1].parameters.rule = Some("6.5, \"proven\"\nwith margin".into());
    rows[2].warnings = vec!["one".into(), "two, or more".into()];
    rows[3].error.l2 = Some(0.1 + 0.2);
    rows[4].error.l2 = Some(5e-324);
    rows[5].error.l2 = Some(1.797_693_134_862_315_7e308);
    let report = report(rows.clone());
    let csv = read_csv(&report.to_csv());
    // Not read from the text: this reader of JSON rounds its numbers wrongly now and then.
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(csv.len(), rows.len() + 1);
    let header = &csv[0];
    assert_eq!(header[..6].join(" "), "scene dimension scheme constraint label level");
    let ends = ["error.l2", "order.h1", "iterations.outer", "certificate.residual"];
    for key in ends.into_iter().chain(["seconds.total", "peak_memory_bytes", "warnings"]) {
        assert!(header.iter().any(|h| h == key), "{key}");
    }
    for (r, line) in csv[1..].iter().enumerate() {
        assert_eq!(line.len(), header.len());
        for (key, cell) in header.iter().zip(line) {
            let value = key.split('.').fold(&json["rows"][r], |value, part| &value[part]);
            match value {
                Value::Null => assert_eq!(cell, ""),
                Value::String(s) => assert_eq!(cell, s),
                Value::Array(a) => assert_eq!(cell.is_empty(), a.is_empty()),
                number => {
                    let read: f64 = cell.parse().unwrap();
                    assert_eq!(read.to_bits(), number.as_f64().unwrap().to_bits(), "{key}");
                }
            }
        }
    }
    let l2 = header.iter().position(|h| h == "error.l2").unwrap();
    assert_eq!(csv[5][l2].parse::<f64>().unwrap(), 5e-324);
    assert_eq!(csv[3].last().unwrap(), "one; two, or more");
}

/// Width and height that a PNG file states.
fn png_size(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    assert!(bytes.len() > 5_000, "{} bytes are a blank picture", bytes.len());
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn all_files_are_written_and_plots_show_what_they_should() {
    let scratch = Scratch::new("files");
    let mut rows = rows();
    rows[5].status = Outcome::Stalled;
    rows[5].error = Errors::default();
    for row in &mut rows[9..] {
        row.error = Errors::default();
    }
    let written = report(rows).write(scratch.0.join("deep")).unwrap();
    let names: Vec<_> = written.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
    let expected = [
        "report.json",
        "report.csv",
        "convergence.svg",
        "convergence.png",
        "work_precision.svg",
        "work_precision.png",
    ];
    assert_eq!(names, expected);
    for (svg, x) in [(&written[2], "mesh size h"), (&written[4], "time in s")] {
        let text = std::fs::read_to_string(svg).unwrap();
        let labels = ["L2 error", "radial-2d", "signorini-2d", "p1", "sipg", "wopsip"];
        let notes = ["did not converge", "no exact solution: no errors"];
        for label in [x].into_iter().chain(labels).chain(notes) {
            assert!(text.lines().any(|l| l.trim() == label), "{label} is not in {}", svg.display());
        }
        // Shown at a fraction of the size at which it is drawn.
        assert!(text.starts_with("<svg width=\"780\""), "{}", &text[..80]);
    }
    let (width, height) = png_size(&written[3]);
    assert!(width == 1560 && height > 1200, "{width} x {height}");
    png_size(&written[5]);
}

#[test]
fn a_report_of_one_row_or_none_is_written_too() {
    for rows in [vec![row("radial-1d", "p1", 4)], Vec::new()] {
        let scratch = Scratch::new(&format!("few-{}", rows.len()));
        assert_eq!(report(rows).write(&scratch.0).unwrap().len(), 6);
    }
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let scratch = Scratch::new("blocked");
    std::fs::create_dir_all(scratch.0.join("report.csv")).unwrap();
    let error = report(rows()).write(&scratch.0).unwrap_err().to_string();
    assert!(error.starts_with("cannot write ") && error.contains("report.csv"), "{error}");
}

#[test]
fn peak_memory_is_known_on_linux() {
    let peak = peak_memory_bytes();
    assert_eq!(peak.is_some(), cfg!(target_os = "linux"));
    assert!(peak.is_none_or(|p| p > 100_000));
}
