//! The stability study: criteria that are promised, completeness, reports that read back.

use std::collections::BTreeSet;

use crate::support::scratch::Scratch;
use serde_json::Value;
use unilateral::error::Error;
use unilateral::stability::{
    Effort, STABILITY_CASES, Stability, StabilityReport, StabilityRow, Verdict, criteria, slivers,
};

fn quick(cases: &[&str], schemes: &[&str]) -> StabilityReport {
    let study = Stability::new(Effort::Quick);
    study.cases(cases.iter().copied()).schemes(schemes.iter().copied()).run().unwrap()
}

fn describe(row: &StabilityRow) -> String {
    format!(
        "{} {} {:?} {} {:?}: {} {:?}, expected {}: {:?} ({})",
        row.criterion,
        row.label,
        row.level,
        row.parameter,
        row.value,
        row.quantity,
        row.measured,
        row.expected.words(),
        row.verdict,
        row.detail
    )
}

/// The rows of a criterion, at least one.
fn of<'r>(report: &'r StabilityReport, criterion: &str) -> Vec<&'r StabilityRow> {
    let rows: Vec<_> = report.rows.iter().filter(|r| r.criterion == criterion).collect();
    assert!(!rows.is_empty(), "{criterion}");
    rows
}

/// No row of these misses what it should keep.
fn keeps(report: &StabilityReport) {
    assert_eq!(report.failures, Vec::<String>::new());
    let missed: Vec<String> =
        report.rows.iter().filter(|r| r.verdict == Verdict::Missed).map(describe).collect();
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    assert!(report.rows.iter().any(|r| r.verdict == Verdict::Met));
}

/// Every row of a choice that is known to fail does.
fn fails(report: &StabilityReport, criterion: &str, is_shown: impl Fn(&StabilityRow) -> bool) {
    let shown: Vec<_> = of(report, criterion).into_iter().filter(|r| is_shown(r)).collect();
    assert!(!shown.is_empty());
    for row in shown {
        assert_eq!(row.verdict, Verdict::FailsAsExpected, "{}", describe(row));
    }
}

#[test]
fn stretched_cells_ask_for_weights_by_heights() {
    let report = quick(&["stretched-cells"], &["wopsip", "sipg"]);
    keeps(&report);
    fails(&report, "error-on-stretched-cells", |r| {
        r.label == "wopsip@eta=1" && r.value.is_some_and(|a| a > 5.0)
    });
    fails(&report, "definite-on-stretched-cells", |r| {
        r.label == "sipg@sigma=10" && r.value.is_some_and(|a| a > 5.0)
    });
}

/// Cells of edges of 2e-10 beside ones of size one: the measures of their facets must not vanish.
#[test]
fn interior_penalty_stands_graded_meshes() {
    let report = quick(&["graded-meshes"], &["p1", "sipg"]);
    keeps(&report);
}

#[test]
fn units_do_not_matter() {
    let report = quick(&["scaling"], &["p1", "cr", "sipg", "wopsip"]);
    keeps(&report);
    fails(&report, "size-of-domain", |r| r.label.ends_with("@eta=1"));
}

#[test]
fn a_constant_in_the_data_does_not_matter() {
    let report = quick(&["constant"], &["p1", "cr", "sipg", "wopsip", "p2"]);
    keeps(&report);
    assert_eq!(of(&report, "constant-in-the-data").len(), 10);
}

#[test]
fn contrast_does_not_matter() {
    keeps(&quick(&["contrast"], &["p1", "wopsip"]));
}

#[test]
fn coercivity_is_told_by_inertia() {
    let report = quick(&["coercivity"], &["sipg"]);
    keeps(&report);
    fails(&report, "inertia", |r| r.parameter == "sigma" && r.value.is_some_and(|s| s < 3.0));
}

#[test]
fn slivers_leave_the_schemes_definite() {
    let study = Stability::new(Effort::Quick).cases(["slivers"]).schemes(["p1", "cr"]);
    let report = study.mesh("given", slivers(1.0, 2, 0.1).unwrap()).run().unwrap();
    keeps(&report);
    let given = of(&report, "given-meshes");
    assert_eq!(given.len(), 2);
    assert!(given.iter().all(|r| r.problem == "given" && r.level.is_none()), "{given:?}");
}

/// A factor outside of the limits fails, whatever else it keeps.
#[test]
fn small_factors_fail() {
    let study = Stability::new(Effort::Quick).cases(["penalty-factor"]);
    let report = study.schemes(["wopsip"]).run().unwrap();
    let small: Vec<_> = of(&report, "error-of-large-factors")
        .into_iter()
        .filter(|r| r.value.is_some_and(|eta| eta < 1.0))
        .collect();
    assert!(!small.is_empty());
    assert!(small.iter().all(|r| r.verdict == Verdict::FailsAsExpected), "{}", describe(small[0]));
}

/// Every factor that is swept has limits.
#[test]
fn no_factor_is_reported_without_a_limit() {
    let study = Stability::new(Effort::Quick).cases(["penalty-factor", "coercivity", "round-off"]);
    let report = study.schemes(["wopsip", "sipg"]).run().unwrap();
    let swept = report.rows.iter().filter(|r| r.parameter == "eta" || r.parameter == "sigma");
    for row in swept {
        assert_ne!(row.verdict, Verdict::Reported, "{}", describe(row));
    }
}

#[test]
fn schemes_are_written_as_everywhere() {
    let study = Stability::new(Effort::Quick).cases(["scaling"]);
    let report = study.schemes(["sipg@factor=1.05", "br2@factor=2", "lifts=full"]).run().unwrap();
    keeps(&report);
    let shown: BTreeSet<(&str, &str)> =
        report.rows.iter().map(|r| (&r.scheme[..], &r.label[..])).collect();
    let labels = [("br2", "br2@factor=2,lifts=full"), ("sipg", "sipg@factor=1.05")];
    assert_eq!(shown, BTreeSet::from(labels));
}

#[test]
fn what_does_not_exist_is_refused_before_anything_runs() {
    let study = |case: &str, scheme: &str| {
        Stability::new(Effort::Quick).cases([case]).schemes([scheme]).run()
    };
    for (case, scheme, said) in
        [("nothing", "p1", "case = nothing: "), ("scaling", "p7", "scheme = p7: ")]
    {
        assert!(matches!(study(case, scheme), Err(Error::Parameter(why)) if why.starts_with(said)));
    }
}

#[test]
fn reports_read_back() {
    let scratch = Scratch::new("stability");
    let study = Stability::new(Effort::Quick).cases(["scaling"]).schemes(["p1", "wopsip"]);
    let folder = scratch.0.join("made by the study");
    let report = study.write_to(&folder).run().unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();

    let json: Value = serde_json::from_str(&read("stability.json")).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), report.rows.len());
    for (read, row) in rows.iter().zip(&report.rows) {
        assert_eq!(read["criterion"], row.criterion.as_str());
        let verdict = serde_json::to_value(row.verdict).unwrap();
        assert_eq!(read["verdict"], verdict);
        assert_eq!(read["measured"].is_null(), row.measured.is_none());
    }
    assert_eq!(json["complete"], true);
    assert_eq!(json["criteria"].as_array().unwrap().len(), criteria().count());

    let csv = read("stability.csv");
    assert_eq!(csv.lines().count(), report.rows.len() + 1);
    assert!(csv.starts_with("case,criterion,scheme,label,precision,problem,level,"));
    let markdown = read("stability.md");
    assert!(markdown.starts_with("# Stability\n"));
    for row in &report.rows {
        assert!(markdown.contains(row.verdict.name()), "{}", describe(row));
    }
}

/// In release builds: `cargo test --release --test study stability:: -- --ignored`.
#[test]
#[ignore = "takes long"]
fn every_criterion_has_its_rows_in_the_quick_study() {
    let schemes = Stability::SCHEMES;
    let study = Stability::new(Effort::Quick).schemes(schemes);
    let report = study.mesh("given", slivers(1.0, 2, 0.1).unwrap()).run().unwrap();
    assert_eq!(report.failures, Vec::<String>::new());
    let asked: BTreeSet<&str> = report.rows.iter().map(|r| r.criterion.as_str()).collect();
    let missing: Vec<&str> =
        criteria().map(|of| of.1.name).filter(|name| !asked.contains(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    for case in STABILITY_CASES {
        for scheme in schemes.iter().filter(|s| **s != "nipg") {
            let has = report.rows.iter().any(|r| r.case == case && r.scheme == *scheme);
            assert!(has, "{case} has no row of {scheme}");
        }
    }
    for row in &report.rows {
        assert_eq!(row.verdict, Verdict::on(&row.expected, row.measured), "{}", describe(row));
        let is_judged = row.expected.at_least.is_some() || row.expected.at_most.is_some();
        assert_eq!(is_judged, row.verdict != Verdict::Reported, "{}", describe(row));
    }
}
