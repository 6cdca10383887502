//! What a report writes: keys, numbers, tables, plots and fields, read back by other means.

use serde_json::Value;
use std::path::{Path, PathBuf};
use unilateral::study::{
    Certificate, Errors, ExpectedOrders, Iterations, PenaltyParameters, Program, Report, Row,
    Seconds, fill_orders, observed_order, peak_memory_bytes,
};

/// A directory of its own for a test, gone when the test is over.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let name = format!("unilateral-report-{}-{name}", std::process::id());
        Scratch(std::env::temp_dir().join(name))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A row with errors of order 2 and 1.
fn row(scene: &str, scheme: &str, level: usize) -> Row {
    let h = 1.0 / level as f64;
    Row {
        scene: scene.into(),
        dimension: 2,
        scheme: scheme.into(),
        constraint: "vertices".into(),
        level,
        parameters: PenaltyParameters { sigma: Some(6.5), eta: None, rule: Some("proven".into()) },
        solver: "active-set".into(),
        linear: "direct".into(),
        cells: 2 * level * level,
        unknowns: 6 * level * level,
        nonzeros: 70 * level * level,
        mesh_size: h,
        status: "converged".into(),
        error: Errors {
            l2: Some(0.7 * h * h),
            h1: Some(2.0 * h),
            energy: None,
            max: Some(0.1 * h),
        },
        order: Errors::default(),
        expected_order: ExpectedOrders { l2: Some(2.0), h1: Some(1.0) },
        objective: Some(-0.1 - h / 3.0),
        active: level,
        iterations: Iterations { outer: 3, linear: 0, levels: 1 },
        certificate: Certificate {
            feasibility: 0.0,
            multiplier: 1e-16,
            complementarity: 0.0,
            residual: 2.5e-15,
            algebraic_bound: None,
        },
        seconds: Seconds { mesh: 1e-4, assemble: 2e-4, solve: 0.0125, total: 0.0128 },
        peak_memory_bytes: Some(12_345_678),
        warnings: Vec::new(),
    }
}

fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for scene in ["radial-2d", "signorini-2d"] {
        for scheme in ["p1", "sipg", "wopsip"] {
            rows.extend([8, 16, 32].map(|level| row(scene, scheme, level)));
        }
    }
    fill_orders(&mut rows);
    rows
}

fn report(rows: Vec<Row>) -> Report {
    Report { program: Program::new("compare", "f64", 2, 1), rows }
}

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
    let required = [
        "scene",
        "dimension",
        "scheme",
        "constraint",
        "level",
        "parameters",
        "cells",
        "unknowns",
        "nonzeros",
        "mesh_size",
        "status",
        "error",
        "order",
        "expected_order",
        "objective",
        "active",
        "iterations",
        "certificate",
        "seconds",
        "peak_memory_bytes",
    ];
    let added = ["solver", "linear", "warnings"];
    let mut present = keys(row);
    present.retain(|key| !added.contains(key));
    assert_eq!(present, required);
    assert_eq!(keys(row).len(), required.len() + added.len());
    assert_eq!(keys(&row["parameters"]), ["sigma", "eta", "rule"]);
    assert_eq!(keys(&row["error"]), ["l2", "h1", "energy", "max"]);
    assert_eq!(keys(&row["order"]), ["l2", "h1", "energy", "max"]);
    assert_eq!(keys(&row["expected_order"]), ["l2", "h1"]);
    assert_eq!(keys(&row["iterations"]), ["outer", "linear", "levels"]);
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
    bad.error = Errors { l2: Some(f64::NAN), h1: Some(f64::INFINITY), energy: None, max: None };
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
    let json: Value = serde_json::from_str(&report.to_json()).unwrap();
    assert_eq!(csv.len(), rows.len() + 1);
    let header = &csv[0];
    assert_eq!(header[..6].join(" "), "scene dimension scheme constraint level parameters.sigma");
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

#[test]
fn orders_are_of_the_ratio_of_mesh_sizes() {
    let order = observed_order(8.0, 1.0, 0.9, 0.3).unwrap();
    assert!((order - 8f64.ln() / 3f64.ln()).abs() < 1e-14);
    // Quotients that overflow or vanish have an order all the same.
    assert!((observed_order(1e300, 1e-300, 1.0, 0.1).unwrap() - 600.0).abs() < 1e-9);
    assert!(observed_order(1e-3, 2e-3, 0.2, 0.1).unwrap() < 0.0, "growing errors");
    for (coarse, fine, h, half) in [
        (0.0, 1.0, 0.2, 0.1),
        (1.0, 0.0, 0.2, 0.1),
        (1.0, f64::NAN, 0.2, 0.1),
        (f64::INFINITY, 1.0, 0.2, 0.1),
        (1.0, 0.5, 0.2, 0.2),
        (1.0, 0.5, 0.2, 0.0),
        (-1.0, 0.5, 0.2, 0.1),
    ] {
        assert_eq!(observed_order(coarse, fine, h, half), None);
    }
}

#[test]
fn orders_are_taken_within_a_scheme_and_between_runs_that_converged() {
    let mut rows = vec![
        row("a", "p1", 8),
        row("a", "cr", 8),
        row("a", "p1", 16),
        row("b", "p1", 16),
        row("a", "cr", 16),
        row("a", "cr", 32),
        row("a", "cr", 64),
        row("a", "p1", 16),
    ];
    rows[4].status = "cycling".into();
    rows[5].order.l2 = Some(7.0);
    rows[7].constraint = "facet-means".into();
    fill_orders(&mut rows);
    let orders: Vec<_> = rows.iter().map(|r| r.order.l2).collect();
    let close = |x: Option<f64>, y: f64| (x.unwrap() - y).abs() < 1e-12;
    assert!(close(orders[2], 2.0) && close(rows[2].order.h1, 1.0) && close(orders[6], 2.0));
    assert_eq!(rows[2].order.energy, None, "no errors, no order");
    for none in [0, 1, 3, 4, 5, 7] {
        assert_eq!(orders[none], None, "row {none}");
    }
}

#[test]
fn levels_may_come_in_any_order() {
    let mut rows = vec![row("a", "p1", 32), row("a", "p1", 8), row("a", "p1", 16)];
    fill_orders(&mut rows);
    let has: Vec<bool> = rows.iter().map(|r| r.order.l2.is_some()).collect();
    assert_eq!(has, [true, false, true]);
}

#[test]
fn tables_are_aligned_and_say_what_failed() {
    let mut rows: Vec<Row> = ["p1", "wopsip"]
        .into_iter()
        .flat_map(|scheme| [8, 16].map(|level| row("radial-2d", scheme, level)))
        .collect();
    rows[3].status = "iteration-limit".into();
    rows[3].error = Errors::default();
    rows[3].warnings = vec!["eta below its bound".into()];
    rows[2].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
    rows[3].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
    fill_orders(&mut rows);
    let expected = "\
radial-2d: solver active-set/direct; expected order L2 2 H1 1 (p1), H1 0.5 (wopsip)
scheme   n        h  unknowns  outer       L2  order       H1  order  active  certif.  assem.   solve
";
    let expected_narrow = "\
radial-2d: solver active-set/direct; expected order L2 2 H1 1 (p1), H1 0.5 (wopsip)
scheme  n       h unknowns outer      L2 order      H1 order active  certif. assem.  solve
p1      8 1.25e-1      384     3 1.09e-2     - 2.50e-1     -      8 2.50e-15 2.0e-4 0.0125
p1     16 6.25e-2     1536     3 2.73e-3  2.00 1.25e-1  1.00     16 2.50e-15 2.0e-4 0.0125

wopsip  8 1.25e-1      384     3 1.09e-2     - 2.50e-1     -      8 2.50e-15 2.0e-4 0.0125
wopsip 16 6.25e-2     1536     3       -     -       -     -     16 2.50e-15 2.0e-4 0.0125
  ^ did not converge: iteration-limit
  warning, wopsip: eta below its bound
";
    let _ = expected;
    assert_eq!(report(rows).to_string(), expected_narrow);
}

#[test]
fn tables_leave_out_what_says_nothing_and_name_constraints_that_vary() {
    let mut rows = vec![row("n", "sipg", 8), row("n", "sipg", 8)];
    rows[1].constraint = "facet-means".into();
    for row in &mut rows {
        row.error = Errors::default();
        row.expected_order = ExpectedOrders::default();
    }
    let text = report(rows).to_string();
    assert!(!text.contains("L2") && !text.contains("order"), "{text}");
    assert!(text.contains("vertices") && text.contains("facets"), "{text}");
    let widest = report(self::rows()).to_string().lines().map(str::len).max().unwrap();
    assert!(widest <= 100, "{widest}");
    assert_eq!(report(Vec::new()).to_string(), "");
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
    rows[5].status = "stalled".into();
    rows[5].error = Errors::default();
    for row in &mut rows[9..] {
        row.error = Errors::default();
    }
    let written = report(rows).write(&scratch.0.join("deep")).unwrap();
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
