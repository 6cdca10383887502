//! The files of a report of work against precision, read back.

use std::process::Command;

use super::synthetic::synthetic;
use crate::scratch::Scratch;
use unilateral::inequality::Outcome;
use unilateral::output::LATEX_PACKAGES;
use unilateral::stability::{Effort, Stability};
use unilateral::work_precision::Failure;

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
    assert!(reach.starts_with("scene,label,solver,linear_asked,meshes,norm,error,standing,"));
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
    assert_eq!(tables.len(), 5, "{text}");
    for lines in &tables {
        assert!(lines.iter().all(|n| n == &lines[0]), "{lines:?}\n{text}");
    }
    assert_eq!(tables[0].len(), 2 + 8);
    assert!(text.contains("### radial-2d: time to reach an error in L2"));
}

#[test]
fn latex_tables_have_as_many_cells_as_columns_and_nothing_unescaped() {
    let mut report = synthetic();
    let case = report.rows[0].case();
    report.refused.push(Failure::new(case, "odd_reason & 100%"));
    let files = report.to_latex();
    let names: Vec<&str> = files.iter().map(|(name, _)| &name[..]).collect();
    let scene = |what: &str| format!("table-radial-2d-{what}.tex");
    assert_eq!(names[0], "report.tex");
    for what in ["runs", "phases-of-the-fastest-run", "time-to-reach-an-error-in-l2"] {
        assert!(names.contains(&&*scene(what)), "{names:?}");
    }
    let summary = &files[0].1;
    assert!(!summary.contains(": runs") && summary.contains("longtable"), "{summary}");
    let all: String = files[1..].iter().map(|(_, text)| &text[..]).collect();
    let tables: Vec<&str> = all.split("\\begin{longtable}{").skip(1).collect();
    assert_eq!(tables.len(), 5);
    for table in tables {
        let (columns, rest) = table.split_once("}\n\\caption").unwrap();
        let columns =
            columns.matches(['l', 'r', 'p']).count() - 4 * columns.matches("ragged").count();
        let body = rest.split("\\end{longtable}").next().unwrap();
        let lines: Vec<&str> = body.lines().filter(|l| l.contains(" & ")).collect();
        assert!(lines.len() > 3);
        for line in lines {
            assert_eq!(line.matches(" & ").count() + 1, columns, "{line}");
            assert!(line.ends_with("\\\\"), "{line}");
        }
        let count = |rule: &str| body.matches(rule).count();
        assert_eq!((count("\\toprule"), count("\\label{tab:"), count("\\bottomrule")), (2, 1, 1));
    }
    assert!(all.contains("odd\\_reason \\& 100\\%") && all.contains("\\num{1.02e-3}"), "{all}");
}

#[test]
#[ignore = "needs pdflatex"]
fn needs_pdflatex_to_compile_latex() {
    // as wide as tables get: all errors, and schemes told apart by their choices
    let mut report = synthetic();
    for m in &mut report.rows {
        m.row.error.broken_energy = Some(1.23e-4);
        m.row.unknowns = Some(123_456);
    }
    let mut other = report.rows.clone();
    other.iter_mut().for_each(|m| m.row.label += ":facet-means@factor=10,weight=anisotropic");
    report.rows.extend(other);
    let case = report.rows[0].case();
    report.refused.push(Failure::new(case, "not run: would need about 12.5 GB of memory"));
    let stability = Stability::new(Effort::Trial).run().unwrap();
    let mut rows = crate::rows::rows();
    rows[3].label += ":facet-means@factor=10,weight=anisotropic";
    rows[5].status = Outcome::Stalled;
    let scratch = Scratch::new("latex");
    crate::rows::report(rows).write(&scratch.0).unwrap();
    let comparison = scratch.read("report.tex");
    let summaries =
        [&report.to_latex()[0].1, &stability.to_latex()[0].1, &comparison].map(Clone::clone);
    let alone = report.to_latex().into_iter().chain(stability.to_latex());
    let texts = summaries
        .into_iter()
        .chain(alone.filter(|(name, _)| name.starts_with("table-")).map(|(_, text)| text));
    let document = format!(
        "\\documentclass{{article}}\n{LATEX_PACKAGES}\n\\begin{{document}}\n{}\\end{{document}}\n",
        texts.collect::<Vec<_>>().join("\\clearpage\n")
    );
    std::fs::write(scratch.0.join("all.tex"), document).unwrap();
    let mut log = String::new();
    // the widths of a longtable are known in the second run
    for _ in 0..2 {
        let output = Command::new("pdflatex")
            .args(["-interaction=nonstopmode", "-halt-on-error", "all.tex"])
            .current_dir(&scratch.0)
            .output()
            .unwrap();
        log = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{log}");
    }
    let points = |line: &str| -> f64 {
        line.split('(').nth(1).unwrap().split("pt").next().unwrap().parse().unwrap()
    };
    let overfull: Vec<&str> =
        log.lines().filter(|l| l.starts_with("Overfull") && points(l) > 3.0).collect();
    assert!(overfull.is_empty(), "wider or higher than the text: {overfull:#?}\n{log}");
}

#[test]
fn failures_are_listed_and_drawn() {
    let mut report = synthetic();
    report.rows[2].row.status = Outcome::Cycling;
    let failures = report.failures();
    assert_eq!(failures.len(), 1);
    assert_eq!((failures[0].case.level, &failures[0].why[..]), (32, "cycling"));
    assert!(report.to_text().contains("failed: p1, level 32: cycling"));
    let scratch = Scratch::new("drawn");
    let written = report.write(&scratch.0).unwrap();
    assert_eq!(written.len(), 6 + 2);
    for plot in ["time", "unknowns"] {
        let text = scratch.read(&format!("radial-2d-{plot}.svg"));
        assert!(text.contains("did not converge"), "{plot}");
    }
    // a page and single tables come with the last round
    assert!(!scratch.0.join("report.html").exists());
    report.provenance.complete = true;
    let written = report.write(&scratch.0).unwrap();
    assert_eq!(written.len(), 7 + report.tables().len() + 2);
    let page = scratch.read("report.html");
    assert!(page.contains("<g class=\"s2\">") && page.contains("<tr class=\"s2\">"));
    // nothing is left of what was on its way
    let hidden = std::fs::read_dir(&scratch.0).unwrap();
    let is_hidden = |e: std::fs::DirEntry| e.file_name().to_string_lossy().starts_with('.');
    assert!(!hidden.map(Result::unwrap).any(is_hidden));
}

#[test]
fn figures_are_as_wide_as_their_longest_label() {
    let width = |label: &str| {
        let mut report = synthetic();
        report.rows.iter_mut().for_each(|m| m.row.label = format!("{}{label}", m.row.scheme));
        let scratch = Scratch::new(&format!("wide{}", label.len()));
        std::fs::create_dir_all(&scratch.0).unwrap();
        report.write_figures(&scratch.0, "radial-2d").unwrap();
        let text = scratch.read("radial-2d-time.svg");
        for scheme in ["p1", "sipg", "wopsip"] {
            assert!(text.contains(&format!(">{scheme}{label}</text>")), "{scheme}{label}");
        }
        let start = text.split("width=\"").nth(1).unwrap();
        start.split('"').next().unwrap().parse::<f64>().unwrap()
    };
    assert_eq!(width("@factor=1.05"), 400.0);
    let long = ":cell-means@factor=10,weight=anisotropic, iterative, f32, and something else";
    assert!(width(long) > 500.0);
}
