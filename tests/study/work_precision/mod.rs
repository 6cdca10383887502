//! Work against precision: times to reach an error, studies, reports that end early.

mod files;
mod interpolation;
pub mod synthetic;

use std::cell::{Cell, RefCell};

use crate::support::scratch::Scratch;
use synthetic::{measured, synthetic};
use unilateral::inequality::Outcome;
use unilateral::measure::{ErrorNorm, Errors};
use unilateral::prelude::*;
use unilateral::study::{Journal, Program, Progress, Row, Seconds, Variant};
use unilateral::work_precision::{Rounds, Standing, WorkAtError};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn times_to_reach_an_error_come_with_the_ratio_to_the_best() {
    let report = synthetic();
    let reach = report.work_at_errors();
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
fn standing(report: &Report, scene: &str, label: &str, error: f64) -> (Standing, Option<f64>) {
    let at = report.work_at_errors().into_iter().find(|r| {
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
    let at = |report: &Report, label: &str, error: f64| standing(report, "radial-2d", label, error);
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Reached, None));
    assert_eq!(at(&report, "wopsip", 2e-3), (Standing::NotReached, Some(4.5e-6 * 4096.0)));
    assert_eq!(at(&report, "cr", 2e-3), (Standing::Undercut, Some(1e-6 * 32768.0)));
    // a table states both bounds and what they mean
    let text = report.work_to_text(100);
    assert!(text.contains("> 1.84e-2") && text.contains("< 3.28e-2"), "{text}");
    assert!(text.contains("> t: not reached by the finest level"), "{text}");

    // a finer level was asked for and not run
    let mut finer = measured("wopsip", 32, 4.5e-6);
    (finer.status, finer.error) = (Outcome::TimeLimit, Errors::default());
    report.rows.push(finer);
    assert_eq!(at(&report, "wopsip", 2e-3), (Standing::NotRun, None));
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Reached, None));
    // a level between did not converge, which says nothing of errors above it
    report.rows[4].status = Outcome::Cycling;
    assert_eq!((&report.rows[4].label[..], report.rows[4].level), ("sipg", 16));
    assert_eq!(at(&report, "sipg", 5e-3), (Standing::Failed, None));
    let text = report.work_to_text(100);
    assert!(text.contains("  failed  "), "{text}");
    report.program.subject = Some("wopsip".to_owned());
    let verdicts = report.verdicts();
    assert!(verdicts[0].contains("; undercut on the coarsest mesh by cr"), "{verdicts:?}");
    // schemes of another scene
    let elsewhere = ["p1", "sipg"].map(|scheme| [8, 16].map(|n| measured(scheme, n, 1e-6)));
    report.rows.extend(elsewhere.into_iter().flatten().map(|mut row| {
        row.scene = "signorini-2d".into();
        row
    }));
    assert_eq!(standing(&report, "signorini-2d", "cr", 5e-3), (Standing::NotRun, None));
    assert_eq!(standing(&report, "signorini-2d", "p1", 5e-3), (Standing::Reached, None));
    let title = "signorini-2d: time to reach an error in L2\n";
    let text = report.work_to_text(100);
    let table = text.split(title).nth(1).unwrap();
    let of_cr = table.lines().find(|line| line.starts_with("cr ")).unwrap();
    let words: Vec<&str> = of_cr.split_whitespace().collect();
    assert_eq!(words, ["cr", "not", "run", "not", "run"]);
    // no errors in a norm are no failure
    let mut report = synthetic();
    report.rows.iter_mut().skip(6).for_each(|row| row.error.l2 = None);
    assert_eq!(at(&report, "wopsip", 5e-3), (Standing::Unknown, None));
}

#[test]
fn costs_at_an_error_are_time_unknowns_and_entries() {
    let mut report = synthetic();
    for row in &mut report.rows {
        let mut again = row.clone();
        again.seconds.total *= 1.25;
        row.add_run(&again);
    }
    let tables = report.work_tables();
    let costs =
        tables.iter().map(|table| table.to_text(100)).find(|t| t.contains("costs")).unwrap();
    let lines: Vec<&str> = costs.lines().collect();
    assert_eq!(lines[0], "radial-2d: costs at an error of 5e-3 in L2");
    // level 200^(1/2): 6 unknowns and 70 entries to its square
    let p1: Vec<&str> = lines[2].split_whitespace().collect();
    assert_eq!(p1, ["p1", "2.83e-3", "(1.00)", "1.25", "1200", "14000"]);
    assert!(report.work_to_text(100).contains("is up to 1.25 times the least"));
}

#[test]
fn the_verdict_is_a_sentence_made_from_the_figures() {
    let expected = "radial-2d: at an L2 error of 5e-3 wopsip takes 1.27e-2 s, 4.5 times the time of p1; 1.5 times that of sipg.";
    let mut report = synthetic();
    let fastest = &report.verdicts()[0];
    assert!(fastest.contains("p1 takes 2.83e-3 s, 0.33 times the time of sipg; 0.22"), "{fastest}");
    report.program.subject = Some("wopsip".to_owned());
    assert_eq!(report.verdicts(), [expected]);
}

#[test]
fn smallest_and_median_are_those_of_all_runs() {
    let mut row = measured("p1", 8, 1.0);
    assert_eq!(row.median_over_least(), None);
    let first = row.clone();
    for total in [2.0, 9.0, 4.0, 7.0] {
        let mut again = first.clone();
        again.seconds = Seconds::new(0.0, 0.0, total);
        row.add_run(&again);
    }
    assert_eq!(row.runs, Some(vec![2.0, 4.0, 7.0, 9.0, 512.0]));
    assert_eq!((row.median_over_least(), row.seconds.total), (Some(3.5), 2.0));
    assert!(row.warnings.is_empty());
    let mut other = first;
    other.iterations.outer = Some(99);
    row.add_run(&other);
    assert_eq!(row.warnings, ["status or counts differ between runs"]);
}

fn tiny<'a>() -> Study<'a, 2> {
    Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).scheme(Wopsip::default())
}

/// The names of the variants of a report.
fn names(report: &Report) -> Vec<String> {
    report.series().into_iter().map(|series| series.name).collect()
}

#[test]
fn the_rows_so_far_are_handed_over_after_every_round() {
    let begun = RefCell::new(0);
    let study = tiny().levels([4, 8]).observer(|progress| {
        if let Progress::Started(..) = progress {
            *begun.borrow_mut() += 1;
        }
    });
    let mut kept = Vec::new();
    let scratch = Scratch::new("interrupted");
    let journal = Journal::create(&scratch.0, Program::new("rounds", "f64", 1, 2)).unwrap();
    let earlier = measured("cr", 8, 1.0);
    journal.add(&earlier).unwrap();
    let mut keep = |rows: &[Row]| {
        kept.push((*begun.borrow(), rows.to_vec()));
        journal.replace_after(1, rows)
    };
    let rows = Rounds::new(2).rows(&study, &mut keep).unwrap();
    let (runs, first) = &kept[0];
    assert_eq!((*runs, first.len()), (4, 4));
    assert!(first.iter().all(|row| row.runs.as_ref().is_some_and(|runs| runs.len() == 1)));
    assert_eq!((kept.len(), *begun.borrow()), (2, 8));
    assert!(rows.iter().all(|row| row.median_over_least() >= Some(1.0)));
    // what is on disc is readable before the end
    let read = Report::read(&scratch.0).unwrap();
    assert!(!read.complete && read.rows[0] == earlier && read.rows[1..] == rows);
}

#[test]
fn a_tiny_study_measures_every_variant_alike() {
    let study = || tiny().scheme_on(Wopsip::default(), FacetMeans).levels([8, 4]);
    let report = Rounds::new(3).run(&study()).unwrap();
    assert_eq!(report.rows.len(), 3 * 2);
    assert!(report.rows.iter().all(Row::converged));
    assert_eq!((&report.program.precision[..], report.program.repeat), ("f64", 3));
    let names = names(&report);
    assert_eq!(names, ["p1", "wopsip", "wopsip:facet-means"]);
    for row in &report.rows {
        let runs = row.runs.as_ref().unwrap();
        assert_eq!((runs.len(), runs[0]), (3, row.seconds.total));
        assert!(runs[0] > 0.0 && runs.is_sorted());
        let Seconds { mesh, assemble, solve, start, .. } = row.seconds;
        assert!((mesh + assemble + solve - runs[0]).abs() <= 1e-9, "{:?}", row.seconds);
        // WOPSIP starts from P1, P1 on the coarsest level from nothing
        let start = start.unwrap();
        assert!(start <= solve, "{:?}", row.seconds);
        assert_eq!(start > 0.0, row.scheme != "p1" || row.level == 8, "{:?}", row.seconds);
        assert!(row.certificate.residual < 1e-9);
        assert_eq!(row.order.l2.is_some(), row.level == 8);
    }
    // the same counts and errors as a study in one round
    let alone = study().run().unwrap();
    for (a, row) in alone.rows.iter().zip(&report.rows) {
        let of = |row: &Row| (row.label.clone(), row.level, row.error.clone(), row.nonzeros);
        assert_eq!((of(a), &a.iterations), (of(row), &row.iterations));
    }
}

/// Adaptive meshes follow the bound, and the bound is what the verdict compares by.
#[test]
fn the_work_of_adaptive_meshes_is_that_of_all_steps() {
    let study = tiny().levels([4]).adaptive(Adaptivity::default().steps(3));
    let report = Rounds::new(2).run(&study).unwrap();
    assert!(report.rows.iter().all(Row::converged));
    let alone = study.run().unwrap();
    assert_eq!(report.rows.len(), alone.rows.len());
    for (row, alone) in report.rows.iter().zip(&alone.rows) {
        assert_eq!((row.level, &row.error, &row.bound), (alone.level, &alone.error, &alone.bound));
        assert_eq!(row.runs.as_ref().map(Vec::len), Some(2));
        let Seconds { mesh, assemble, solve, bound, total, .. } = row.seconds;
        assert!((mesh + assemble + solve + bound.unwrap() - total).abs() <= 1e-9);
        assert_eq!(row.seconds_to(ErrorNorm::Bound), total);
    }
    let verdict = &report.verdicts()[0];
    assert!(verdict.starts_with("radial-2d: at an error bound of "), "{verdict}");
    let by_bound = |r: &&WorkAtError| r.norm == ErrorNorm::Bound;
    for r in report.work_at_errors().iter().filter(by_bound) {
        let of = |row: &&Row| Variant::of(row) == r.variant && row.bound.total > Some(r.error);
        let coarser = report.rows.iter().rfind(of);
        let is_above = |row: &Row| r.seconds.is_none_or(|s| s >= row.seconds_to(r.norm));
        assert!(coarser.is_none_or(is_above), "{r:?}");
    }
    let text = report.work_to_text(100);
    assert!(text.contains("time to reach an error bound\n"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let scratch = Scratch::new("work-adaptive");
    report.write(&scratch.0).unwrap();
    assert!(scratch.read("radial-2d-time.svg").contains("time in s, bound included"));
}

#[test]
fn wrong_requests_are_refused_before_anything_runs() {
    let message = |study: Study<2>| Rounds::new(1).run(&study).unwrap_err().to_string();
    assert!(message(tiny()).contains("needs levels"));
    let share = Adaptivity::default().theta(2.0);
    assert!(message(tiny().levels([4]).adaptive(share)).contains("share of marked cells"));
    assert!(message(tiny().levels([0, 4])).contains("at least one subdivision"));
    assert!(message(tiny().scheme(ConformingP1).levels([4])).contains("tell their rows apart"));
}

#[test]
fn what_takes_too_long_is_not_repeated_and_finer_levels_are_listed() {
    let report = Rounds::new(2).limit(1e-12).run(&tiny().levels([4, 8, 16])).unwrap();
    assert_eq!(report.rows.len(), 6);
    for row in &report.rows {
        let runs = row.runs.as_ref().map(Vec::len);
        let message = row.message.as_deref().unwrap_or_default();
        match row.level {
            4 => assert!(row.converged() && runs == Some(1)),
            8 => assert!(message.starts_with("not run: level 4 took"), "{message}"),
            _ => assert_eq!(message, "not run: level 8 was not, either"),
        }
        assert_eq!(row.status == Outcome::TimeLimit, row.level > 4);
    }
}

#[test]
fn errors_are_against_a_reference_where_there_is_one() {
    let begun = Cell::new(0);
    let study = || tiny().levels([4, 8]).reference(ConformingP2, 32);
    let rows = study().run().unwrap().rows;
    let observed = study().observer(|progress| {
        begun.set(begun.get() + usize::from(matches!(progress, Progress::Started(..))));
    });
    // two rounds, and once against the reference, which is solved too
    let found = Rounds::new(2).run(&observed).unwrap().rows;
    assert_eq!(begun.get(), 2 * 4 + 4 + 1);
    for (row, alone) in found.iter().zip(&rows) {
        assert_eq!(row.against.as_deref(), Some("p2 at level 32"));
        assert_eq!((&row.label, &row.error), (&alone.label, &alone.error));
    }
}
