//! Work against precision: times to reach an error, tables, baselines, reports that end early.

#[allow(dead_code)]
mod rows;

use std::cell::RefCell;
use std::path::PathBuf;
use std::process::Command;

use rows::row;
use serde_json::Value;
use unilateral::prelude::*;
use unilateral::study::{
    Case, ErrorNorm, Measured, Phases, Precision, Variant, WorkPoint, WorkPrecision, WorkProgress,
    WorkReport, changes, work_at,
};

/// A directory of its own for a test, gone when the test is over.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let name = format!("unilateral-work-{}-{name}", std::process::id());
        Scratch(std::env::temp_dir().join(name))
    }
    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A run of a scheme whose L2 error is `h^2` and whose time is `factor n^3`.
fn measured(scheme: &str, level: usize, factor: f64) -> Measured {
    let variant = Variant {
        scene: "radial-2d".into(),
        scheme: scheme.into(),
        constraint: "vertices".into(),
        linear_asked: "direct".into(),
        precision: "f64".into(),
    };
    let mut row = row("radial-2d", scheme, level);
    let n = level as f64;
    row.error.l2 = Some(n.powi(-2));
    row.peak_memory_bytes = Some(1_000_000 * (level * level) as u64);
    let total = factor * n.powi(3);
    let phases = Phases {
        mesh: 0.0,
        assemble: 0.25 * total,
        coarse: 0.25 * total,
        solve: 0.5 * total,
        total,
    };
    Measured::new(row, phases, &Case { variant, level })
}

/// P1 takes `n^3` microseconds, SIPG three times and WOPSIP four and a half times that; WOPSIP was
/// run on one level less.
fn synthetic() -> WorkReport {
    let mut report = WorkReport::new("test", 1);
    report.subject = "wopsip".into();
    for (scheme, factor, levels) in
        [("p1", 1e-6, &[8, 16, 32][..]), ("sipg", 3e-6, &[8, 16, 32]), ("wopsip", 4.5e-6, &[8, 16])]
    {
        report.rows.extend(levels.iter().map(|&level| measured(scheme, level, factor)));
    }
    report
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn interpolation_is_exact_for_power_laws_and_ends_with_the_data() {
    for (order, cost) in [(2.0, 3.0), (1.0, 2.0), (0.5, 1.1)] {
        let point =
            |n: f64| WorkPoint { error: Some(3.0 * n.powf(-order)), work: 7.0 * n.powf(cost) };
        let points = [4.0, 9.0, 32.0].map(point);
        for n in [4.0, 5.0, 9.0, 20.0, 32.0] {
            let found = work_at(&points, point(n).error.unwrap()).unwrap();
            assert!(close(found, point(n).work), "{order} {cost} {n}: {found}");
        }
        assert_eq!(work_at(&points, point(3.9).error.unwrap()), None);
        assert_eq!(work_at(&points, point(32.1).error.unwrap()), None);
    }
}

#[test]
fn a_level_that_failed_is_not_bridged_and_a_plateau_is_not_crossed_backwards() {
    let point = |error: Option<f64>, work: f64| WorkPoint { error, work };
    let gap = [point(Some(1e-1), 1.0), point(None, 2.0), point(Some(1e-3), 4.0)];
    assert_eq!(work_at(&gap, 1e-2), None);
    let up = [point(Some(1e-3), 1.0), point(Some(1e-1), 2.0)];
    assert_eq!(work_at(&up, 1e-2), None);
    assert_eq!(work_at(&[], 1e-2), None);
}

#[test]
fn times_to_reach_an_error_come_with_the_ratio_to_the_best() {
    let reach = synthetic().reach();
    let l2: Vec<_> = reach.iter().filter(|r| r.norm == ErrorNorm::L2).collect();
    // errors from 1/64 to 1/1024, and the same three variants at each
    let at = |error: f64| l2.iter().filter(|r| r.error == error).collect::<Vec<_>>();
    for error in [1e-2, 5e-3, 2e-3, 1e-3] {
        let here = at(error);
        assert_eq!(here.len(), 3, "{error}");
        // error n^-2 and time n^3: time error^-1.5
        assert!(close(here[0].seconds.unwrap(), 1e-6 * error.powf(-1.5)), "{error}");
        assert!(close(here[0].unknowns.unwrap(), 6.0 / error), "{error}");
        assert!(close(here[1].ratio.unwrap(), 3.0), "{error}");
        let is_reached = error >= 5e-3;
        assert_eq!(here[2].seconds.is_some(), is_reached, "{error}");
        assert_eq!(here[2].ratio.is_some_and(|r| close(r, 4.5)), is_reached, "{error}");
    }
    assert!(at(2e-2).is_empty() && at(5e-4).is_empty());
    assert!(reach.iter().all(|r| r.norm != ErrorNorm::Energy), "rows without that error");
}

#[test]
fn the_verdict_is_a_sentence_made_from_the_figures() {
    let expected = "radial-2d: at an L2 error of 5e-3 wopsip takes 1.27e-2 s, 4.5 times the time of p1; 1.5 times that of sipg.";
    assert_eq!(synthetic().verdicts(), [expected]);
    let mut fastest = synthetic();
    fastest.subject.clear();
    assert!(
        fastest.verdicts()[0].contains("p1 takes 2.83e-3 s, 0.33 times the time of sipg; 0.22")
    );
}

/// Cells of a line without quoted commas.
fn table(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().map(|line| line.split(',').collect()).collect()
}

#[test]
fn csv_reads_back_to_the_same_numbers() {
    let report = synthetic();
    let text = report.to_csv();
    let lines = table(&text);
    assert_eq!(lines.len(), 1 + 8);
    for (line, measured) in lines[1..].iter().zip(&report.rows) {
        // not read back from JSON: that reader may be wrong in the last digit
        let row = serde_json::to_value(measured).unwrap();
        let mut numbers = 0;
        for (key, cell) in lines[0].iter().zip(line) {
            let value = row.pointer(&format!("/{}", key.replace('.', "/"))).unwrap();
            if let Some(x) = value.as_f64() {
                assert_eq!(cell.parse::<f64>().unwrap().to_bits(), x.to_bits(), "{key}");
                numbers += 1;
            } else if value.is_null() {
                assert_eq!(*cell, "", "{key}");
            }
        }
        assert!(numbers > 30, "{numbers}");
    }
    let smallest = lines[0].iter().position(|k| *k == "smallest.total").unwrap();
    let expected = report.rows[2].smallest.total;
    assert_eq!(lines[3][smallest].parse::<f64>().unwrap().to_bits(), expected.to_bits());
    let reach = report.reach_csv();
    assert_eq!(table(&reach).len(), 1 + report.reach().len());
    assert!(reach.starts_with("scene,scheme,constraint,linear_asked,precision,norm,error,seconds"));
}

#[test]
fn smallest_and_median_are_those_of_all_runs() {
    let mut m = measured("p1", 8, 1.0);
    let row = m.row.clone();
    for total in [2.0, 9.0, 4.0, 7.0] {
        m.add(&row, Phases { solve: total, total, ..Phases::default() });
    }
    assert_eq!((m.runs, m.smallest.total, m.median.total), (5, 2.0, 7.0));
    assert_eq!(m.row.seconds.total, 2.0);
    assert!(m.row.warnings.is_empty());
    let mut other = row.clone();
    other.iterations.outer = Some(99);
    m.add(&other, Phases::default());
    assert_eq!(m.row.warnings, ["status or counts differ between runs"]);
}

/// Rows of each table in Markdown: bars in each.
fn bars(markdown: &str) -> Vec<Vec<usize>> {
    let lines = markdown.split("\n\n").map(|block| block.lines().filter(|l| l.starts_with('|')));
    let count = |line: &str| line.replace("\\|", "").matches('|').count();
    lines.map(|l| l.map(count).collect()).filter(|v: &Vec<usize>| !v.is_empty()).collect()
}

#[test]
fn markdown_tables_have_as_many_cells_in_each_line() {
    let text = synthetic().to_markdown();
    let tables = bars(&text);
    assert_eq!(tables.len(), 4, "{text}");
    for lines in &tables {
        assert!(lines.iter().all(|n| n == &lines[0]), "{lines:?}\n{text}");
    }
    assert_eq!(tables[0].len(), 2 + 8);
    assert!(text.contains("### radial-2d: time to reach an error in L2"));
}

#[test]
fn latex_tables_have_as_many_cells_as_columns_and_nothing_unescaped() {
    let mut report = synthetic();
    report.rows[0].row.status = "odd_status & 100%".into();
    let text = report.to_latex();
    let tables: Vec<&str> = text.split("\\begin{tabular}").skip(1).collect();
    assert_eq!(tables.len(), 4);
    for table in tables {
        let (columns, rest) = table[1..].split_once('}').unwrap();
        let body = rest.split("\\end{tabular}").next().unwrap();
        let lines: Vec<&str> = body.lines().filter(|l| l.ends_with("\\\\")).collect();
        assert!(lines.len() > 3);
        for line in lines {
            assert_eq!(line.matches(" & ").count() + 1, columns.len(), "{line}");
        }
        for rule in ["\\toprule", "\\midrule", "\\bottomrule"] {
            assert_eq!(body.matches(rule).count(), 1);
        }
    }
    assert!(text.contains("odd\\_status \\& 100\\%"), "{text}");
    assert_eq!(text.matches("\\begin{table}").count(), text.matches("\\end{table}").count());
}

#[test]
fn latex_compiles_where_it_is_installed() {
    if Command::new("pdflatex").arg("--version").output().is_err() {
        eprintln!("pdflatex is not installed: skipped");
        return;
    }
    let scratch = Scratch::new("latex");
    std::fs::create_dir_all(&scratch.0).unwrap();
    let document = format!(
        "\\documentclass{{article}}\n\\usepackage{{booktabs}}\n\\begin{{document}}\n{}\\end{{document}}\n",
        synthetic().to_latex()
    );
    std::fs::write(scratch.0.join("report.tex"), document).unwrap();
    let output = Command::new("pdflatex")
        .args(["-interaction=nonstopmode", "-halt-on-error", "report.tex"])
        .current_dir(&scratch.0)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn a_baseline_tells_changed_counts_and_errors_and_ignores_times() {
    let baseline = synthetic().to_json();
    let mut report = synthetic();
    for m in &mut report.rows {
        m.smallest.total *= 7.0;
        m.row.seconds.solve *= 3.0;
        m.row.peak_memory_bytes = None;
        // a rounding error is no change
        m.row.error.h1 = m.row.error.h1.map(|e| e * (1.0 + 1e-12));
    }
    let same = changes(&baseline, &report).unwrap();
    assert_eq!(same.changed, [""; 0]);
    assert_eq!((same.compared, same.missing.len(), same.new.len()), (8, 0, 0));

    report.rows[1].row.iterations.outer = Some(4);
    report.rows[2].row.error.l2 = report.rows[2].row.error.l2.map(|e| 1.001 * e);
    report.rows[4].row.status = "cycling".into();
    let dropped = report.rows.pop().unwrap();
    report.rows.push(measured("cr", 8, 1.0));
    let different = changes(&baseline, &report).unwrap();
    assert_eq!(different.changed.len(), 3, "{different}");
    let name = "radial-2d, p1, vertices, direct, f64, level 16";
    assert_eq!(different.changed[0], format!("{name}: iterations.outer was 3, is 4"));
    assert!(different.changed[1].contains("level 32: error.l2 was 0.0009765625, is 0.000977"));
    assert!(different.changed[2].contains("status was \"converged\", is \"cycling\""));
    assert_eq!(different.missing.len(), 1);
    assert!(different.missing[0].ends_with(&format!("level {}", dropped.row.level)));
    assert!(different.new[0].contains("cr"));
    assert!(different.to_string().starts_with("against the baseline: 7 rows compared, 3 numbers"));
    assert!(changes("{}", &report).is_err() && changes("no JSON", &report).is_err());
}

#[test]
fn failures_are_listed_and_drawn() {
    let mut report = synthetic();
    report.rows[2].row.status = "cycling".into();
    let failures = report.failures();
    assert_eq!(failures.len(), 1);
    assert_eq!((failures[0].case.level, &failures[0].why[..]), (32, "cycling"));
    assert!(report.to_text().contains("failed: p1, level 32: cycling"));
    let scratch = Scratch::new("drawn");
    let written = report.write(&scratch.0).unwrap();
    assert_eq!(written.len(), 6 + 2 * 3);
    for plot in ["time", "unknowns", "memory"] {
        let text = scratch.read(&format!("radial-2d-{plot}.svg"));
        assert!(text.contains("did not converge"), "{plot}");
        let png = std::fs::read(scratch.0.join(format!("radial-2d-{plot}.png"))).unwrap();
        assert_eq!(png[1..4], *b"PNG");
    }
    assert!(scratch.read("radial-2d-memory.svg").contains("peak memory in MB"));
    // nothing is left of what was on its way
    let hidden = std::fs::read_dir(&scratch.0).unwrap();
    let is_hidden = |e: std::fs::DirEntry| e.file_name().to_string_lossy().starts_with('.');
    assert!(!hidden.map(Result::unwrap).any(is_hidden));
}

fn tiny<'a>() -> WorkPrecision<'a, 2> {
    WorkPrecision::<2>::new(|| scenes::radial(1.0)).scheme(ConformingP1).scheme(Wopsip::default())
}

#[test]
fn an_interrupted_study_leaves_a_readable_report_of_what_is_finished() {
    let scratch = Scratch::new("interrupted");
    let seen = RefCell::new(Vec::new());
    // what stands on the disc when the second round begins, before anything else is finished
    let report = tiny()
        .levels([4, 8])
        .rounds(2)
        .write_to(&scratch.0)
        .observer(|progress| {
            if let WorkProgress::Started(_, 1) = progress {
                seen.borrow_mut().push(scratch.read("report.json"));
            }
        })
        .run()
        .unwrap();
    let early: Value = serde_json::from_str(&seen.borrow()[0]).unwrap();
    assert_eq!(early["rows"].as_array().unwrap().len(), 4);
    assert!(early["rows"].as_array().unwrap().iter().all(|r| r["runs"] == 1));
    assert_eq!(early["provenance"]["complete"], false);
    assert_eq!(early["provenance"]["rounds"], 2);
    let late: Value = serde_json::from_str(&scratch.read("report.json")).unwrap();
    assert_eq!(late["provenance"]["complete"], true);
    assert!(scratch.read("radial-2d-time.svg").contains("wopsip"));
    assert!(report.rows.iter().all(|m| m.runs == 2));
}

#[test]
fn a_tiny_study_measures_every_variant_alike() {
    let report = tiny()
        .scheme(FacetMeans(Wopsip::default()))
        .linear([unilateral::solve::Linear::Direct, unilateral::solve::Linear::Iterative])
        .precisions([Precision::Double, Precision::Single])
        .levels([8, 4])
        .rounds(3)
        .memory(|case| Some(case.level as u64))
        .run()
        .unwrap();
    assert_eq!(report.rows.len(), 3 * 2 * 2 * 2);
    assert_eq!(report.failures(), []);
    assert_eq!(report.program.precision, "f64, f32");
    let labels: Vec<String> =
        report.variants().iter().map(|v| v.label(&report.variants())).collect();
    assert_eq!(labels.len(), 12);
    assert_eq!(labels[0], "p1, direct, f64");
    assert_eq!(labels[11], "wopsip, facet-means, iterative, f32");
    for m in &report.rows {
        assert_eq!(m.runs, 3);
        assert!(m.smallest.total > 0.0 && m.smallest.total <= m.median.total);
        for p in [m.smallest, m.median] {
            let sum = p.mesh + p.assemble + p.coarse + p.solve;
            assert!((sum - p.total).abs() <= 1e-9, "{p:?}");
            // WOPSIP starts from P1, P1 on the coarsest level from nothing
            assert_eq!(p.coarse > 0.0, m.row.scheme != "p1" || m.row.level == 8, "{p:?}");
        }
        assert_eq!(m.row.peak_memory_bytes, Some(m.row.level as u64));
        let is_single = m.precision == "f32";
        assert!(m.row.certificate.residual < if is_single { 1e-4 } else { 1e-9 });
        // the same counts and errors as a study of this scheme alone
        assert_eq!(m.row.order.l2.is_some(), m.row.level == 8);
    }
    let alone = Study::<f64, 2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .solver(unilateral::solve::ActiveSet {
            linear: unilateral::solve::Linear::Direct,
            ..Default::default()
        })
        .levels([4, 8])
        .run()
        .unwrap();
    for (a, m) in alone.rows.iter().zip(&report.rows) {
        assert_eq!(
            (a.error, a.nonzeros, a.iterations),
            (m.row.error, m.row.nonzeros, m.row.iterations)
        );
    }
}

#[test]
fn wrong_requests_are_refused_before_anything_runs() {
    let message = |study: WorkPrecision<2>| study.run().unwrap_err().to_string();
    assert!(message(tiny()).contains("needs a scheme"));
    assert!(message(tiny().levels([0, 4])).contains("at least one subdivision"));
    assert!(message(tiny().scheme(ConformingP1).levels([4])).contains("must have its own name"));
    let named = unilateral::study::Named { name: "nothing".into(), options: Default::default() };
    assert!(message(tiny().scheme(named).levels([4])).contains("no scheme of this name"));
}

#[test]
fn what_takes_too_long_is_not_repeated_and_finer_levels_are_listed() {
    let report = tiny().levels([4, 8]).rounds(2).limit(1e-12).run().unwrap();
    assert_eq!(report.rows.len(), 2);
    assert!(report.rows.iter().all(|m| m.runs == 1 && m.row.level == 4));
    let failures = report.failures();
    assert_eq!(failures.len(), 2);
    assert!(failures.iter().all(|f| f.why.starts_with("not run: level 4 took")));
}
