//! What a report writes: keys, numbers, tables, plots and fields, read back by other means.

use crate::rows::{report, row, rows};
use crate::support::keys::ROW_KEYS;
use crate::support::scratch::Scratch;
use serde_json::Value;
use std::path::Path;
use unilateral::error_bound::Unproven;
use unilateral::facet::PenaltyParameters;
use unilateral::inequality::Outcome;
use unilateral::measure::Errors;
use unilateral::plot::convergence;
use unilateral::scheme::ExpectedOrders;
use unilateral::study::{Program, Row};

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn json_has_the_keys_that_scripts_rely_on() {
    let json: Value = serde_json::from_str(&report(rows()).to_json()).unwrap();
    assert_eq!(keys(&json), ["program", "complete", "rows", "extrapolated"]);
    let program = ["name", "version", "threads", "precision", "repeat", "target_cpu"];
    let added = ["processor", "request"];
    assert_eq!(keys(&json["program"]), [&program[..], &added].concat());
    assert!(json["program"]["target_cpu"].as_str().unwrap().starts_with(std::env::consts::ARCH));
    let row = &json["rows"][0];
    let added = ["solver", "linear", "warnings"];
    let mut present = keys(row);
    present.retain(|key| !added.contains(key));
    assert_eq!(present, ROW_KEYS);
    assert_eq!(keys(row).len(), ROW_KEYS.len() + added.len());
    assert_eq!(keys(&row["parameters"]), ["sigma", "eta", "rule"]);
    assert_eq!(keys(&row["error"]), ["l2", "h1", "energy", "broken_energy", "max"]);
    let orders = ["l2", "h1", "energy", "max", "bound", "multiplier_l1", "multiplier_l2"];
    assert_eq!(keys(&row["order"]), orders);
    assert_eq!(keys(&row["expected_order"]), ["l2", "h1"]);
    assert_eq!(
        keys(&row["iterations"]),
        ["outer", "linear", "levels", "systems", "start_cycles", "stages"]
    );
    let certificate =
        ["feasibility", "multiplier", "complementarity", "residual", "algebraic_bound"];
    assert_eq!(keys(&row["certificate"]), certificate);
    let bound = "total distance discrete guaranteed unproven mismatch obstacle contact oscillation \
                 algebra effectivity effectivity_of_v exceeds_norm reason";
    assert_eq!(keys(&row["bound"]), bound.split(' ').collect::<Vec<_>>());
    assert_eq!(keys(&row["seconds"]), ["mesh", "assemble", "solve", "start", "bound", "total"]);
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
    assert!(report.details_to_text(100).contains("NaN"), "a table must not hide a NaN");
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

/// Rows of an earlier run need not have all keys of this one.
#[test]
fn csv_has_the_keys_of_all_rows() {
    let mut rows = rows();
    rows[1].history = Some(vec![(1, 0.5, None), (2, 0.75, Some(1e-10))]);
    rows[2].runs = Some(vec![1.0, 2.0]);
    let levels = [0, 1, 2].map(|k| rows[k].level.to_string());
    let csv = read_csv(&report(rows).to_csv());
    for (key, cells) in [
        ("history", ["", "[1,0.5,null]; [2,0.75,1e-10]", ""]),
        ("runs", ["", "", "1.0; 2.0"]),
        ("level", levels.each_ref().map(String::as_str)),
    ] {
        let column = csv[0].iter().position(|of| of == key).expect(key);
        for (line, cell) in csv[1..].iter().zip(cells) {
            assert_eq!((line.len(), &*line[column]), (csv[0].len(), cell), "{key}");
        }
    }
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
        "report.md",
        "report.tex",
        "convergence.svg",
        "work_precision.svg",
        "report.html",
    ];
    assert_eq!(names, expected);
    for (svg, x) in [(&written[4], "mesh size h"), (&written[5], "time in s")] {
        let text = std::fs::read_to_string(svg).unwrap();
        let labels = ["L2 error", "radial-2d", "signorini-2d", "p1", "sipg", "wopsip"];
        let notes = ["did not converge", "no exact solution: no errors"];
        for label in [x].into_iter().chain(labels).chain(notes) {
            assert!(
                text.contains(&format!(">{label}</text>")),
                "{label} is not in {}",
                svg.display()
            );
        }
        assert!(text.starts_with("<svg width=\"780\""), "{}", &text[..80]);
    }
}

#[test]
fn plots_show_promised_orders_and_no_single_points() {
    let lines = |rows: Vec<Row>| -> Vec<String> {
        let svg = convergence(&rows).to_svg();
        svg.split("</text>").map(|text| text.rsplit('>').next().unwrap().to_owned()).collect()
    };
    let has = |lines: &[String], text: &str| lines.iter().any(|line| line == text);
    let mut all = rows();
    let drawn = lines(all.clone());
    assert!(has(&drawn, "orders promised by theory"));
    // an order that is no whole number has its own slope
    all.iter_mut().for_each(|r| r.expected_order = ExpectedOrders { l2: None, h1: Some(1.5) });
    assert!(has(&lines(all.clone()), "1.5"));
    all.iter_mut().for_each(|r| r.expected_order = ExpectedOrders::default());
    assert!(!has(&lines(all.clone()), "orders promised by theory"));
    assert!(has(&lines(all.clone()), "slopes for comparison"));
    // labels of an axis are of one kind: numbers for mesh sizes from 1/32 to 1/8
    assert!(has(&drawn, "0.1") && has(&drawn, "0.05"), "{drawn:?}");
    // a band from each error in the H1 seminorm, which is the energy norm here, to the bound on it
    let bands = |rows: &[Row]| convergence(rows).to_svg().matches("opacity=\"0.12\"").count();
    assert_eq!(bands(&all), 0);
    let text = "band: up to the bound on the error";
    assert!(!has(&drawn, text));
    for row in &mut all {
        row.bound.discrete = Some(4.0 * row.mesh_size);
    }
    assert!(has(&lines(all.clone()), text));
    assert_eq!(bands(&all), 2 * 3 * 2 + 1, "two parts of six curves, and the legend");
    all[2].status = Outcome::Stalled;
    assert_eq!(bands(&all), 2 * 3 * 2, "none to a run that failed");
    all[2].status = Outcome::Converged;
    // bounds alone where no error is known
    let mut without: Vec<Row> = all.clone();
    without.iter_mut().for_each(|row| row.error = Errors::default());
    let bounds = lines(without);
    assert!(has(&bounds, "error bound") && !has(&bounds, "broken H1 error"));
    all.retain(|r| r.level == 8);
    let single = lines(all);
    assert!(has(&single, "one level: no curve"));
    assert!(!has(&single, "broken H1 error"), "one panel says so");
}

#[test]
fn a_report_of_one_row_or_none_is_written_too() {
    for rows in [vec![row("radial-1d", "p1", 4)], Vec::new()] {
        let scratch = Scratch::new(&format!("few-{}", rows.len()));
        assert_eq!(report(rows).write(&scratch.0).unwrap().len(), 7);
    }
}

/// Opening tags less closing ones, of elements that have both.
fn open_elements(html: &str, name: &str) -> isize {
    let opened =
        html.matches(&format!("<{name} ")).count() + html.matches(&format!("<{name}>")).count();
    opened as isize - html.matches(&format!("</{name}>")).count() as isize
}

#[test]
fn the_page_begins_with_how_the_comparison_ended_and_needs_no_network() {
    let scratch = Scratch::new("page");
    let mut rows = rows();
    rows[4].label = "a<b> & \"c\"".into();
    rows[0].error.l2 = Some(1.234_567_891_2e-3);
    std::fs::write(scratch.0.join("radial-2d-p1.svg"), "<svg></svg>\n").unwrap();
    let mut report = report(rows);
    let words = ["unilateral", "--scheme", "p1,sipg", "my file.toml"];
    report.program.command = Some(Program::quoted(words.into_iter().map(str::to_owned)));
    report.write(&scratch.0).unwrap();
    let html = scratch.read("report.html");
    for foreign in ["<script", "http:", "https:", "@import", "url("] {
        let found = html.replace("http://www.w3.org/2000/svg", "").contains(foreign);
        assert!(!found, "{foreign}");
    }
    for name in ["svg", "g", "table", "tr", "td", "th", "section", "figure", "div", "text"] {
        assert_eq!(open_elements(&html, name), 0, "{name}");
    }
    let (first, rest) = html.split_once("</section>").unwrap();
    assert!(first.contains(&format!("all {} runs converged.", report.rows.len())), "{first}");
    assert_eq!((first.matches("<svg").count(), rest.matches("<svg").count()), (2, 0));
    assert!(first.matches("<th scope=\"col\"").count() <= 8 * 2, "{first}");
    assert!(first.contains("class=\"n best\">"), "{first}");
    assert!(html.contains("a&lt;b&gt; &amp; &quot;c&quot;") && !html.contains("a<b"));
    // the first picture of a solution stands beside the plots, and nothing is shown twice
    assert_eq!(first.matches("<img src=\"radial-2d-p1.svg\"").count(), 1, "{first}");
    for picture in ["radial-2d-p1.svg", "convergence.svg", "work_precision.svg"] {
        assert!(!rest.contains(&format!("<img src=\"{picture}\"")), "{picture}");
        assert!(scratch.0.join(picture).exists(), "{picture}");
    }
    assert!(rest.contains("unilateral --scheme p1,sipg 'my file.toml'"), "{rest}");
    assert!(html.len() < 300_000, "{} bytes", html.len());
    assert!(html.contains("<title>Comparison of schemes</title>"));
    // of one problem the page has the name
    report.rows.retain(|row| row.scene == "radial-2d");
    report.write(&scratch.0).unwrap();
    assert!(scratch.read("report.html").contains("<h1>radial-2d</h1>"));
}

/// With more panels than the first screen holds, the plots of all scenes stand below it.
#[test]
fn the_page_of_many_scenes_shows_their_plots_below_the_first_screen() {
    let scratch = Scratch::new("many-scenes");
    let scenes = (1..=5).flat_map(|k| [4, 8].map(|n| row(&format!("scene-{k}"), "p1", n)));
    report(scenes.collect()).write(&scratch.0).unwrap();
    let html = scratch.read("report.html");
    let (_, rest) = html.split_once("</section>").unwrap();
    for picture in ["convergence.svg", "work_precision.svg"] {
        assert_eq!(rest.matches(&format!("<img src=\"{picture}\"")).count(), 1, "{picture}");
    }
}

/// Equal warnings of several levels are one line, with the levels where they are not all.
#[test]
fn equal_warnings_are_one_line_with_their_levels() {
    let mut rows: Vec<Row> = ["p1", "sipg", "wopsip"]
        .iter()
        .flat_map(|label| [4, 8, 16].map(|n| row("radial-2d", label, n)))
        .collect();
    for k in [0, 1, 3, 4, 8] {
        rows[k].warnings.push("too coarse".to_owned());
    }
    let text = report(rows).details_to_text(100);
    assert_eq!(text.matches("too coarse").count(), 1, "{text}");
    assert!(text.contains("p1, sipg at 4, 8; wopsip at 16: too coarse"), "{text}");
}

#[test]
fn the_summary_says_which_runs_did_not_converge_and_marks_the_best_of_the_others() {
    let mut rows = rows();
    let last = rows.iter().rposition(|row| row.scene == rows[0].scene).unwrap();
    rows[last].status = Outcome::Stalled;
    rows[last].message = Some("nothing moved".into());
    rows[last].error.l2 = Some(1e-9);
    rows[last - 3].error.l2 = Some(5e-4);
    let (name, level) = (rows[last].label.clone(), rows[last].level);
    let (scene, n) = (rows[last].scene.clone(), rows.len());
    let text = report(rows).summary_to_text(100);
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains(&format!(": 1 of {n} runs did not converge: {name} on {scene} at {level}.")),
        "{text}"
    );
    assert!(words.contains("stalled: nothing moved"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(!text.contains("\u{2022} 1.00e-9") && text.contains("\u{2022} 5.00e-4"), "{text}");
}

/// Width and height that a PNG file states.
fn png_size(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

/// A browser shows the first screen of the page, light and dark. `UNILATERAL_CHROMIUM` names the browser,
/// `UNILATERAL_KEEP` a directory that keeps the photographs.
#[test]
#[ignore = "needs chromium"]
fn needs_chromium_to_photograph_the_page() {
    let scratch = Scratch::new("photograph");
    let scene = unilateral::scenes::signorini_2d();
    let schemes = unilateral::scheme::NamedScheme::list(["p1", "sipg", "wopsip"]).unwrap();
    let study = unilateral::study::Study::<2>::new(scene).levels([4, 8, 16]);
    let report = schemes.iter().fold(study, unilateral::study::Study::named_scheme).run().unwrap();
    report.write(&scratch.0).unwrap();
    let keep = std::env::var_os("UNILATERAL_KEEP").map_or(scratch.0.clone(), Into::into);
    let browser = std::env::var("UNILATERAL_CHROMIUM").unwrap_or_else(|_| "chromium".to_owned());
    let photograph = |name: &str, scheme: u8| {
        let picture = keep.join(format!("{name}.png"));
        let output = std::process::Command::new(&browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
            .args(["--window-size=1280,800", "--virtual-time-budget=5000"])
            .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
            .arg(format!("--screenshot={}", picture.display()))
            .arg(format!("file://{}", scratch.0.join("report.html").display()))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        assert_eq!(png_size(&picture), (1280, 800), "{said}");
        std::fs::read(picture).unwrap()
    };
    let [dark, light] = [photograph("dark", 0), photograph("light", 1)];
    assert!(light.len() > 40_000, "{} bytes are a blank page", light.len());
    assert_ne!(light, dark);
}

#[test]
fn bounds_are_guaranteed_or_name_what_is_not_proven() {
    let mut rows = vec![row("a", "p1", 8), row("a", "p1", 16), row("a", "p2", 8)];
    rows[0].bound.discrete = Some(0.5);
    (rows[0].bound.guaranteed, rows[0].bound.unproven) = (Some(true), Some(Vec::new()));
    rows[1].bound.discrete = Some(0.25);
    rows[1].bound.effectivity = Some(1.75);
    let unproven = vec![Unproven::Quadrature, Unproven::Algebra];
    (rows[1].bound.guaranteed, rows[1].bound.unproven) = (Some(false), Some(unproven));
    rows[2].bound.reason = Some("no flux".into());
    let written = serde_json::to_value(&rows).unwrap();
    assert_eq!(written[0]["bound"]["guaranteed"], true);
    assert_eq!(written[1]["bound"]["guaranteed"], false);
    assert_eq!(written[1]["bound"]["unproven"], serde_json::json!(["quadrature", "algebra"]));
    assert!(written[2]["bound"]["guaranteed"].is_null());
    let read: Vec<Row> = serde_json::from_value(written.clone()).unwrap();
    assert!(read == rows);
    // reports of earlier versions have no bound
    let mut old = written[0].clone();
    old.as_object_mut().unwrap().shift_remove("bound");
    let read: Row = serde_json::from_value(old).unwrap();
    assert!(read.bound.discrete.is_none() && read.error == rows[0].error);
    let text = report(rows.clone()).details_to_text(100);
    assert!(text.contains(" bound/ ") && text.contains(" 1.75* "), "{text}");
    assert!(
        text.contains("* bound with terms that are not proven: quadrature, algebra\n"),
        "{text}"
    );
    let mut several = rows.clone();
    several[0].bound.guaranteed = Some(false);
    several[0].bound.unproven = Some(vec![Unproven::Algebra]);
    several[0].label = "other".into();
    let text = report(several).details_to_text(200);
    let [other, second] = ["algebra (other)".to_owned(), format!("algebra ({})", rows[1].label)];
    assert!(text.contains(&other) && text.contains(&format!("quadrature, {second}")), "{text}");
    rows.iter_mut().for_each(|row| row.bound.effectivity = None);
    let text = report(rows.clone()).details_to_text(100);
    assert!(text.contains(" 5.0e-1 ") && text.contains(" 2.5e-1* "), "{text}");
    assert!(report(rows).to_markdown().contains("| H1 (order) |"));
}

/// A bound above the norm of the solution says nothing, and neither does its quotient: the bound itself is shown.
#[test]
fn a_bound_above_the_norm_of_the_solution_stands_without_a_quotient() {
    let mut rows = rows();
    for row in &mut rows {
        row.bound.effectivity = Some(1.75);
        row.bound.discrete = Some(0.5);
    }
    let usual = report(rows.clone()).details_to_text(200);
    assert!(usual.contains(" 1.75 ") && !usual.contains('†'), "{usual}");
    rows[0].bound.exceeds_norm = Some(true);
    let text = report(rows).details_to_text(200);
    assert!(text.contains(" 5.0e-1† ") && text.contains(" 1.75 "), "{text}");
    assert!(
        text.contains("† the bound itself: it exceeds the energy norm of the solution"),
        "{text}"
    );
}

/// The least quotient of a column is its best, but for one below one: such a bound is none.
#[test]
fn a_bound_below_the_error_is_not_the_best() {
    let mut rows = vec![row("a", "p1", 8), row("a", "p2", 8), row("a", "cr", 8)];
    for (row, effectivity) in rows.iter_mut().zip([0.93, 1.42, 1.21]) {
        row.bound.effectivity = Some(effectivity);
        row.bound.discrete = Some(0.5);
    }
    let text = report(rows).summary_to_text(100);
    assert!(text.contains("\u{2022} 1.21") && !text.contains("\u{2022} 0.93"), "{text}");
}
