//! Observed orders, and the tables that a terminal shows.

use crate::rows::{self, report, row};
use unilateral::inequality::Outcome;
use unilateral::measure::{ErrorNorm, Errors, observed_order};
use unilateral::scheme::ExpectedOrders;
use unilateral::study::orders_table;
use unilateral::study::{OrderMissed, Row, fill_orders};

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
    rows[4].status = Outcome::Cycling;
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
    rows[3].status = Outcome::IterationLimit;
    rows[3].error = Errors::default();
    rows[3].warnings = vec!["eta below its bound".into()];
    rows[2].expected_order = ExpectedOrders::none().with_h1(0.5);
    rows[3].expected_order = ExpectedOrders::none().with_h1(0.5);
    fill_orders(&mut rows);
    let expected = "\
radial-2d: solver active-set/direct; expected order L2 2 H1 1 (p1), H1 0.5 (wopsip)
scheme  n       h unknowns outer      L2 order      H1 order active  certif. assem.  solve
p1      8 1.25e-1      384     3 1.09e-2     - 2.50e-1     -      8 2.50e-15 2.0e-4 0.0125
p1     16 6.25e-2     1536     3 2.73e-3  2.00 1.25e-1  1.00     16 2.50e-15 2.0e-4 0.0125

wopsip  8 1.25e-1      384     3 1.09e-2     - 2.50e-1     -      8 2.50e-15 2.0e-4 0.0125
wopsip 16 6.25e-2     1536     3       -     -       -     -     16 2.50e-15 2.0e-4 0.0125
  ^ did not converge: iteration-limit
  warning, wopsip: eta below its bound
";
    assert_eq!(report(rows).to_string(), expected);
}

#[test]
fn tables_leave_out_what_says_nothing_and_name_constraints_that_vary() {
    let mut rows = vec![row("n", "sipg", 8), row("n", "sipg", 8)];
    rows[1].constraint = "facet-means".into();
    for row in &mut rows {
        row.error = Errors::default();
        row.expected_order = ExpectedOrders::none();
    }
    let text = report(rows).to_string();
    assert!(!text.contains("L2") && !text.contains("order"), "{text}");
    assert!(text.contains("vertices") && text.contains("facets"), "{text}");
    let widest = report(rows::rows()).to_string().lines().map(str::len).max().unwrap();
    assert!(widest <= 100, "{widest}");
    assert_eq!(report(Vec::new()).to_string(), "");
}

/// Rows of four levels in the order of their errors: 2 in L2, 1 in H1, which is what is promised.
fn four_levels(scheme: &str) -> Vec<Row> {
    [8, 16, 32, 64].map(|level| row("radial-2d", scheme, level)).to_vec()
}

#[test]
fn kept_promises_pass() {
    let mut rows = four_levels("p1");
    assert_eq!(report(rows.clone()).assert_orders(1e-9), Ok(()));
    // Coarse levels do not count, whatever their errors.
    rows[0].error = Errors::default();
    (rows[0].error.l2, rows[0].error.h1) = (Some(1e-9), Some(1e-9));
    assert_eq!(report(rows.clone()).assert_orders(1e-9), Ok(()));
    // Nor do levels that did not converge: the two finest that did are compared.
    rows[3].status = Outcome::Cycling;
    rows[3].error.h1 = Some(7.0);
    let report = report(rows);
    assert_eq!(report.observed_orders()[0].levels, Some([16, 32]));
    assert_eq!(report.assert_orders(1e-9), Ok(()));
}

#[test]
fn orders_above_the_promise_keep_it() {
    let mut rows = four_levels("p1");
    rows.iter_mut().for_each(|r| r.expected_order = ExpectedOrders::none().with_h1(0.5));
    assert_eq!(report(rows).assert_orders(0.0), Ok(()));
}

#[test]
fn a_missed_promise_names_the_row() {
    let mut rows = four_levels("p1");
    rows.extend(four_levels("sipg"));
    rows[7].error.h1 = rows[6].error.h1.map(|e| e / 2_f64.powf(0.8));
    let missed = report(rows.clone()).assert_orders(0.1).unwrap_err();
    let [OrderMissed::Below { scene, scheme, coarse, fine, norm, observed, promised, .. }] =
        &missed.0[..]
    else {
        panic!("{missed}")
    };
    assert_eq!((&scene[..], &scheme[..], *coarse, *fine), ("radial-2d", "sipg", 32, 64));
    assert_eq!((*norm, *promised), (ErrorNorm::H1, 1.0));
    assert!((observed - 0.8).abs() < 1e-12);
    let text = missed.to_string();
    let expected =
        "sipg (vertices) on radial-2d: order 0.800 in H1 from level 32 to 64, promised 1";
    assert_eq!(text, expected);
    // what a `main` that returns it prints
    assert_eq!(format!("{missed:?}"), expected);
    assert_eq!(report(rows.clone()).assert_orders(0.21), Ok(()));
    // Where nothing is promised, nothing is missed.
    rows[7].expected_order.h1 = None;
    assert_eq!(report(rows).assert_orders(0.1), Ok(()));
}

#[test]
fn a_promise_that_cannot_be_tested_is_missed() {
    let mut rows = four_levels("p1");
    rows[..3].iter_mut().for_each(|row| row.status = Outcome::Stalled);
    let missed = report(rows.clone()).assert_orders(0.1).unwrap_err();
    assert_eq!(missed.0.len(), 2, "one for each norm");
    assert!(matches!(missed.0[0], OrderMissed::Unobserved { norm: ErrorNorm::L2, .. }), "{missed}");
    assert!(missed.to_string().contains("fewer than two levels"), "{missed}");
    rows.iter_mut().for_each(|row| row.expected_order = ExpectedOrders::none());
    assert_eq!(report(rows).assert_orders(0.1), Ok(()));
}

#[test]
fn the_table_of_orders_gives_a_verdict_for_every_scheme() {
    let mut rows: Vec<Row> =
        ["p1", "cr", "sipg", "wopsip"].into_iter().flat_map(four_levels).collect();
    rows[7].error.h1 = rows[6].error.h1;
    rows[8..12].iter_mut().for_each(|row| row.expected_order = ExpectedOrders::none());
    rows[12..15].iter_mut().for_each(|row| row.status = Outcome::Cycling);
    rows[12..16].iter_mut().for_each(|row| row.constraint = "facet-means".into());
    let text = orders_table(&report(rows).observed_orders(), 0.1);
    let lines: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("|---")).collect();
    assert_eq!(
        lines[1..],
        [
            "| radial-2d | p1 | vertices | 32, 64 | 2.00 | 2 | 1.00 | 1 | kept |",
            "| radial-2d | cr | vertices | 32, 64 | 2.00 | 2 | 0.00 | 1 | missed in H1 |",
            "| radial-2d | sipg | vertices | 32, 64 | 2.00 | - | 1.00 | - | nothing promised |",
            "| radial-2d | wopsip | facet-means | - | - | 2 | - | 1 | unobserved; level 8 cycling; \
             level 16 cycling; level 32 cycling |",
        ]
    );
}
