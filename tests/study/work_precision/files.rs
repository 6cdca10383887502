//! The files of a report of work against precision, read back.

use std::process::Command;

use super::synthetic::synthetic;
use crate::support::scratch::Scratch;
use unilateral::inequality::Outcome;
use unilateral::output::LATEX_PACKAGES;

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
    for (line, row) in lines[1..].iter().zip(&report.rows) {
        // not read back from JSON: that reader may be wrong in the last digit
        let row = serde_json::to_value(row).unwrap();
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
    let scratch = Scratch::new("reach");
    report.write(scratch.0.join("made")).unwrap();
    let reach = scratch.read("made/reach.csv");
    assert_eq!(table(&reach).len(), 1 + report.work_at_errors().len());
    assert!(reach.starts_with("scene,label,solver,meshes,norm,error,standing,"));
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
    assert_eq!(tables[4].len(), 2 + 8, "the phases of all runs");
    assert!(text.contains("### radial-2d: time to reach an error in L2"));
}

#[test]
fn latex_tables_have_as_many_cells_as_columns_and_nothing_unescaped() {
    let mut report = synthetic();
    report.rows[0].warnings.push("odd_reason & 100%".into());
    let text = report.to_latex();
    let tables: Vec<&str> = text.split("\\begin{tabular}{").skip(1).collect();
    assert_eq!(tables.len(), report.work_tables().len());
    for table in tables {
        let (columns, rest) = table.split_once("}\n\\toprule\n").unwrap();
        let body = rest.split("\\end{tabular}").next().unwrap();
        let lines: Vec<&str> = body.lines().filter(|l| l.contains(" & ")).collect();
        assert!(columns.len() == 1 || lines.len() > 1, "{table}");
        for line in lines {
            assert_eq!(line.matches(" & ").count() + 1, columns.len(), "{line}");
            assert!(line.ends_with("\\\\"), "{line}");
        }
        assert_eq!(body.matches("\\bottomrule").count(), 1);
    }
    assert!(!text.contains("phases") && text.contains("\\num{2.83e-3}"), "{text}");
    let all: String = report.tables().iter().map(|table| table.to_latex()).collect();
    assert!(all.contains("odd\\_reason \\& 100\\%") && all.contains("\\num{9.77e-4}"), "{all}");
}

#[test]
#[ignore = "needs pdflatex"]
fn needs_pdflatex_to_compile_latex() {
    let mut report = synthetic();
    report.rows[5].status = Outcome::OutOfMemory;
    let mut rows = crate::rows::rows();
    rows[3].label += ":facet-means@factor=10,weight=anisotropic";
    rows[5].status = Outcome::Stalled;
    let scratch = Scratch::new("latex");
    crate::rows::report(rows).write(&scratch.0).unwrap();
    let texts = [report.to_latex(), scratch.read("report.tex")];
    let document = format!(
        "\\documentclass{{article}}\n{LATEX_PACKAGES}\n\\begin{{document}}\n{}\\end{{document}}\n",
        texts.join("\\clearpage\n")
    );
    std::fs::write(scratch.0.join("all.tex"), document).unwrap();
    let output = Command::new("pdflatex")
        .args(["-interaction=nonstopmode", "-halt-on-error", "all.tex"])
        .current_dir(&scratch.0)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn failures_are_listed_and_drawn() {
    let mut report = synthetic();
    report.rows[2].status = Outcome::Cycling;
    report.complete = false;
    let text = report.details_to_text(100);
    assert!(text.contains("p1 at 32: cycling: "), "{text}");
    let scratch = Scratch::new("drawn");
    let written = report.write(&scratch.0).unwrap();
    assert_eq!(written.len(), 8 + 2);
    for plot in ["time", "unknowns"] {
        let text = scratch.read(&format!("radial-2d-{plot}.svg"));
        assert!(text.contains("did not converge"), "{plot}");
    }
    let page = scratch.read("report.html");
    assert!(page.matches("<svg").count() == 2 && page.contains("time to reach an error"), "{page}");
    // nothing is left of what was on its way
    let hidden = std::fs::read_dir(&scratch.0).unwrap();
    let is_hidden = |e: std::fs::DirEntry| e.file_name().to_string_lossy().starts_with('.');
    assert!(!hidden.map(Result::unwrap).any(is_hidden));
}

#[test]
fn figures_are_as_wide_as_their_longest_label() {
    let width = |label: &str| {
        let mut report = synthetic();
        report.rows.iter_mut().for_each(|row| row.label = format!("{}{label}", row.scheme));
        let figures = report.work_figures();
        let of_time = figures.iter().find(|(name, _)| name == "radial-2d-time").unwrap();
        let text = of_time.1.to_svg();
        for scheme in ["p1", "sipg", "wopsip"] {
            assert!(text.contains(&format!(">{scheme}{label}</text>")), "{scheme}{label}");
        }
        let start = text.split("width=\"").nth(1).unwrap();
        start.split('"').next().unwrap().parse::<f64>().unwrap()
    };
    assert_eq!(width("@factor=1.05"), 400.0);
    let long = ":facet-means@factor=10,weight=anisotropic, iterative, f32, and something else";
    assert!(width(long) > 500.0);
}
