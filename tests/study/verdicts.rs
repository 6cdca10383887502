//! Verdicts of the stability study, their numbers in words, its criteria, and its mesh of slivers.

use unilateral::stability::{ExpectedRange, STABILITY_CASES, Verdict, criteria, slivers};

fn range(at_least: Option<f64>, at_most: Option<f64>) -> ExpectedRange {
    let mut range = ExpectedRange::default();
    (range.at_least, range.at_most) = (at_least, at_most);
    range
}

fn at_most(most: f64) -> ExpectedRange {
    range(None, Some(most))
}

#[test]
fn verdicts_follow_from_figures() {
    let most = at_most(1.5);
    assert_eq!(Verdict::on(&most, Some(1.5)), Verdict::Met);
    assert_eq!(Verdict::on(&most, Some(3.0)), Verdict::Missed);
    assert_eq!(Verdict::on(&most, None), Verdict::Missed);
    let mut fail = most;
    fail.to_fail = true;
    assert_eq!(Verdict::on(&fail, Some(3.0)), Verdict::FailsAsExpected);
    assert_eq!(Verdict::on(&fail, Some(1.0)), Verdict::BetterThanExpected);
    assert_eq!(Verdict::on(&ExpectedRange::default(), Some(1.0)), Verdict::Reported);
    assert!(!range(Some(0.9), None).holds(f64::NAN));
}

#[test]
fn numbers_are_short() {
    for (number, expected) in
        [(1.5, "1.5"), (1e-10, "1e-10"), (0.0, "0"), (120.0, "120"), (2.34e7, "2.34e7")]
    {
        assert_eq!(at_most(number).words(), format!("at most {expected}"));
        assert_eq!(range(Some(number), None).words(), format!("at least {expected}"));
    }
    assert_eq!(range(Some(0.5), Some(2.0)).words(), "0.5 to 2");
    assert_eq!(ExpectedRange::default().words(), "-");
}

#[test]
fn names_are_unique_and_every_case_has_criteria() {
    for (k, (_, c)) in criteria().enumerate() {
        assert!(criteria().take(k).all(|(_, other)| other.name != c.name), "{}", c.name);
    }
    for case in STABILITY_CASES {
        assert!(criteria().any(|of| of.0 == case), "{case}");
    }
}

#[test]
fn sentences_state_all_limits() {
    for (_, c) in criteria() {
        for range in c.limits {
            let limit = range.words();
            let limit = limit.rsplit(' ').next().unwrap();
            assert!(c.sentence.contains(limit), "{}: {limit}", c.sentence);
        }
    }
    let sentence = |name: &str| criteria().find(|of| of.1.name == name).unwrap().1.sentence;
    assert!(sentence("active-sets-tried").contains("at most 40 linear systems"));
    assert!(sentence("equilibrium").contains("at most 1e-6 of the integral"));
}

#[test]
fn slivers_fill_the_cube() {
    let flatness = 1e-3;
    let mesh = slivers(1.0, 4, flatness).unwrap();
    assert_eq!(mesh.n_cells(), 5 * 64 + 16);
    let volumes: Vec<f64> = (0..mesh.n_cells()).map(|c| mesh.geometry(c).volume).collect();
    let total: f64 = volumes.iter().sum();
    assert!((total - 8.0).abs() < 1e-12, "{total}");
    let least = volumes.iter().copied().fold(f64::INFINITY, f64::min);
    // a third of the height times the square of the side, which is 1/2
    assert!((least / (flatness / 24.0) - 1.0).abs() < 1e-9, "{least}");
    // the boundary is that of the cube
    let area = |f: &unilateral::mesh::BoundaryFacet| {
        mesh.geometry(f.cell as usize).facet_measure(f.local.into())
    };
    let surface: f64 = mesh.boundary().iter().map(area).sum();
    assert!((surface - 24.0).abs() < 1e-12, "{surface}");
    assert!(slivers(1.0, 4, 0.0).is_err());
}
