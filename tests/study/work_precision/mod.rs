//! Work against precision: times to reach an error, studies, reports that end early.

mod files;
mod synthetic;

use std::cell::RefCell;

use crate::scratch::Scratch;
use serde_json::Value;
use synthetic::{measured, synthetic};
use unilateral::inequality::Outcome;
use unilateral::measure::ErrorNorm;
use unilateral::prelude::*;
use unilateral::work_precision::{
    Failure, Measured, Phases, Standing, WorkAtError, WorkPrecision, WorkProgress, WorkReport,
};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
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

/// Where an error in L2 stands for a scheme, and the seconds of the level that bounds the time.
fn standing(report: &WorkReport, scene: &str, label: &str, error: f64) -> (Standing, Option<f64>) {
    let at = report.reach().into_iter().find(|r| {
        (&r.variant.scene[..], &r.variant.label[..], r.norm, r.error)
            == (scene, label, ErrorNorm::L2, error)
    });
    let at = at.unwrap();
    assert_eq!(at.seconds.is_some(), at.standing == Standing::Reached);
    (at.standing, at.seconds_bound)
}

#[test]
fn errors_without_a_time_say_why() {
    let mut report = synthetic();
    report.rows.extend([32, 64].map(|level| measured("cr", level, 1e-6)));
    let at =
        |report: &WorkReport, label: &str, error: f64| standing(report, "radial-2d", label, error);
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Reached, None));
    assert_eq!(at(&report, "wopsip", 2e-3), (Standing::NotReached, Some(4.5e-6 * 4096.0)));
    assert_eq!(at(&report, "cr", 2e-3), (Standing::Undercut, Some(1e-6 * 32768.0)));
    // a table states both bounds and what they mean
    let text = report.to_text();
    assert!(text.contains("> 1.84e-2") && text.contains("< 3.28e-2"), "{text}");
    assert!(text.contains("> t: not reached by the finest level"), "{text}");

    // a finer level was asked for and not run
    let mut finer = report.rows[7].case();
    assert_eq!((&finer.variant.label[..], finer.level), ("wopsip", 16));
    finer.level = 32;
    report.refused.push(Failure::new(finer, "not run: level 16 took 21.0 s"));
    assert_eq!(at(&report, "wopsip", 2e-3), (Standing::NotRun, None));
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Reached, None));
    // a level between did not converge, which says nothing of errors above it
    report.rows[4].row.status = Outcome::Cycling;
    assert_eq!((&report.rows[4].row.label[..], report.rows[4].row.level), ("sipg", 16));
    assert_eq!(at(&report, "sipg", 5e-3), (Standing::Failed, None));
    let text = report.to_text();
    assert!(text.contains("  failed  "), "{text}");
    assert!(
        report.verdicts()[0].contains("; undercut on the coarsest mesh by cr"),
        "{:?}",
        report.verdicts()
    );
    // schemes of another scene
    let elsewhere = ["p1", "sipg"].map(|scheme| [8, 16].map(|n| measured(scheme, n, 1e-6)));
    report.rows.extend(elsewhere.into_iter().flatten().map(|mut m| {
        m.row.scene = "signorini-2d".into();
        m
    }));
    assert_eq!(standing(&report, "signorini-2d", "cr", 5e-3), (Standing::NotRun, None));
    assert_eq!(standing(&report, "signorini-2d", "p1", 5e-3), (Standing::Reached, None));
    let title = "signorini-2d: time to reach an error in L2\n";
    let text = report.to_text();
    let table = text.split(title).nth(1).unwrap();
    let of_cr = table.lines().find(|line| line.starts_with("cr ")).unwrap();
    let words: Vec<&str> = of_cr.split_whitespace().collect();
    assert_eq!(words, ["cr", "not", "run", "not", "run"]);
    // no errors in a norm are no failure
    let mut report = synthetic();
    report.rows.iter_mut().skip(6).for_each(|m| m.row.error.l2 = None);
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Unknown, None));
}

#[test]
fn costs_at_an_error_are_time_unknowns_and_entries() {
    let mut report = synthetic();
    for m in &mut report.rows {
        let row = m.row.clone();
        let total = 1.25 * m.smallest.total;
        m.add(&row, Phases { solve: total, total, ..Phases::default() });
    }
    let tables = report.tables();
    let costs =
        tables.iter().map(|table| table.to_text(100)).find(|t| t.contains("costs")).unwrap();
    let lines: Vec<&str> = costs.lines().collect();
    assert_eq!(lines[0], "radial-2d: costs at an error of 5e-3 in L2");
    // level 200^(1/2): 6 unknowns and 70 entries to its square
    let p1: Vec<&str> = lines[2].split_whitespace().collect();
    assert_eq!(p1, ["p1", "2.83e-3", "(1.00)", "1.25", "1200", "14000"]);
    assert!(report.to_text().contains("is up to 1.25 times the least"));
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

#[test]
fn smallest_and_median_are_those_of_all_runs() {
    let mut m = measured("p1", 8, 1.0);
    assert_eq!((m.median_over_least, m.largest_over_least), (None, None));
    let row = m.row.clone();
    for total in [2.0, 9.0, 4.0, 7.0] {
        m.add(&row, Phases { solve: total, total, ..Phases::default() });
    }
    assert_eq!((m.runs, m.smallest.total, m.median.total), (5, 2.0, 7.0));
    assert_eq!(m.median_over_least, Some(3.5));
    let largest = m.largest_over_least.unwrap();
    assert!(close(largest, 512.0 / 2.0), "{largest}");
    assert_eq!(m.row.seconds.total, 2.0);
    assert!(m.row.warnings.is_empty());
    let mut other = row.clone();
    other.iterations.outer = Some(99);
    m.add(&other, Phases::default());
    assert_eq!(m.row.warnings, ["status or counts differ between runs"]);
}

fn tiny<'a>() -> WorkPrecision<'a, 2> {
    WorkPrecision::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).scheme(Wopsip::default())
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
        .scheme_on(Wopsip::default(), FacetMeans)
        .linear([
            unilateral::linear::LinearMethod::Direct,
            unilateral::linear::LinearMethod::Iterative,
        ])
        .levels([8, 4])
        .rounds(3)
        .run()
        .unwrap();
    assert_eq!(report.rows.len(), 3 * 2 * 2);
    assert_eq!(report.failures(), []);
    assert_eq!(report.program.precision, "f64");
    let labels: Vec<String> =
        report.variants().iter().map(|v| v.name_among(&report.variants())).collect();
    assert_eq!(labels.len(), 6);
    assert_eq!(labels[0], "p1, direct");
    assert_eq!(labels[5], "wopsip:facet-means, iterative");
    for m in &report.rows {
        assert_eq!(m.runs, 3);
        assert!(m.smallest.total > 0.0 && m.smallest.total <= m.median.total);
        for p in [m.smallest, m.median] {
            let sum = p.mesh + p.assemble + p.coarse + p.solve;
            assert!((sum - p.total).abs() <= 1e-9, "{p:?}");
            // WOPSIP starts from P1, P1 on the coarsest level from nothing
            assert_eq!(p.coarse > 0.0, m.row.scheme != "p1" || m.row.level == 8, "{p:?}");
        }
        assert!(m.row.certificate.residual < 1e-9);
        // the same counts and errors as a study of this scheme alone
        assert_eq!(m.row.order.l2.is_some(), m.row.level == 8);
    }
    let alone = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .solver(
            unilateral::inequality::ActiveSet::default()
                .linear(unilateral::linear::LinearMethod::Direct),
        )
        .levels([4, 8])
        .run()
        .unwrap();
    for (a, m) in alone.rows.iter().zip(&report.rows) {
        assert_eq!(
            (a.error, a.nonzeros, a.iterations.clone()),
            (m.row.error, m.row.nonzeros, m.row.iterations.clone())
        );
    }
}

#[test]
fn adaptive_meshes_stand_beside_uniform_ones() {
    let adaptivity = Adaptivity::default().steps(3);
    let study = || tiny().levels([4, 8]).adaptive(adaptivity).rounds(2);
    assert_eq!(study().check().unwrap().len(), 2 * 3);
    let scratch = Scratch::new("work-adaptive");
    let report = study().write_to(&scratch.0).run().unwrap();
    assert_eq!(report.failures(), []);
    assert_eq!(report.rows.len(), 2 * (2 + 4));
    let names: Vec<String> =
        report.variants().iter().map(|v| v.name_among(&report.variants())).collect();
    assert_eq!(names, ["p1, uniform", "p1, adaptive", "wopsip, uniform", "wopsip, adaptive"]);
    let alone = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Wopsip::default())
        .levels([4])
        .adaptive(adaptivity)
        .run()
        .unwrap();
    let adaptive = || report.rows.iter().filter(|m| m.meshes.is_adaptive());
    assert_eq!(adaptive().count(), alone.rows.len());
    for (m, row) in adaptive().zip(&alone.rows) {
        assert_eq!((m.row.level, m.row.error, &m.row.bound), (row.level, row.error, &row.bound));
        assert_eq!((m.runs, m.row.peak_memory_bytes), (2, None));
        let p = m.smallest;
        let sum = p.mesh + p.assemble + p.solve + p.bound.unwrap();
        assert!((sum - p.total).abs() <= 1e-9 && m.seconds_to(ErrorNorm::Bound) == p.total);
    }
    for m in report.rows.iter().filter(|m| !m.meshes.is_adaptive()) {
        let with_bound = m.smallest.total + m.smallest.bound.unwrap();
        assert_eq!(m.seconds_to(ErrorNorm::Bound), with_bound);
        assert_eq!(m.seconds_to(ErrorNorm::H1), m.smallest.total);
    }
    // adaptive meshes follow the bound, and the bound is what the verdict compares by
    let verdict = &report.verdicts()[0];
    assert!(verdict.starts_with("radial-2d: at an error bound of "), "{verdict}");
    let by_bound = |r: &&WorkAtError| r.norm == ErrorNorm::Bound;
    for r in report.reach().iter().filter(by_bound) {
        let of = |m: &&Measured| m.variant() == r.variant && m.row.bound.total > Some(r.error);
        let coarser = report.rows.iter().rfind(of);
        let is_above = |m: &Measured| r.seconds.is_none_or(|s| s >= m.seconds_to(r.norm));
        assert!(coarser.is_none_or(is_above), "{r:?}");
    }
    let text = report.to_text();
    assert!(text.contains("time to reach an error bound\n"), "{text}");
    let mut runs = text.lines().skip(1).take_while(|line| !line.contains("phases"));
    assert!(runs.all(|line| line.len() <= 110), "{text}");
    let rows: Value = serde_json::from_str(&scratch.read("report.json")).unwrap();
    assert_eq!(rows["rows"][2]["meshes"], "adaptive");
    assert!(scratch.read("radial-2d-time.svg").contains("time in s, bound included"));
}

#[test]
fn wrong_requests_are_refused_before_anything_runs() {
    let message = |study: WorkPrecision<2>| study.run().unwrap_err().to_string();
    assert!(message(tiny()).contains("needs a scheme"));
    let share = Adaptivity::default().theta(2.0);
    assert!(message(tiny().levels([4]).adaptive(share)).contains("share of marked cells"));
    assert!(message(tiny().levels([0, 4])).contains("at least one subdivision"));
    assert!(message(tiny().scheme(ConformingP1).levels([4])).contains("tell their rows apart"));
    let named: NamedScheme = "wopsip@factor=1".parse().unwrap();
    assert!(message(tiny().named_scheme(&named).levels([4])).contains("tell their rows apart"));
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
