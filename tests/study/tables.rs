//! Observed orders, and the tables that a terminal shows.

use crate::rows::{self, report, row};
use unilateral::inequality::Outcome;
use unilateral::measure::{ErrorNorm, Errors};
use unilateral::scheme::ExpectedOrders;
use unilateral::study::{OrderVerdict, Row, fill_orders};

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
    rows[7].label = "p1:facet-means".into();
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
    rows[2].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
    rows[3].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
    fill_orders(&mut rows);
    let expected = "\
radial-2d: solver active-set/direct; expected order L2 2 H1 1 (p1), H1 0.5 (wopsip)
scheme  n       h unknowns     L2 (order)     H1 (order) active certif. systems assem.  solve
p1      8 1.25e-1      384        1.09e-2        2.50e-1      8 2.5e-15       4 2.0e-4 0.0125
p1     16 6.25e-2     1536 2.73e-3 (2.00) 1.25e-1 (1.00)     16 2.5e-15       4 2.0e-4 0.0125

wopsip  8 1.25e-1      384        1.09e-2        2.50e-1      8 2.5e-15       4 2.0e-4 0.0125
wopsip 16 6.25e-2     1536              -              -     16 2.5e-15       4 2.0e-4 0.0125
  wopsip at 16: iteration-limit: the limit of iterations was reached while the active set still
    changed; raise it, or use another solver
  wopsip at 16: eta below its bound
";
    assert_eq!(report(rows).details_to_text(100), expected);
}

#[test]
fn tables_leave_out_what_says_nothing_and_have_a_line_for_every_label() {
    let mut rows = vec![row("n", "sipg", 8), row("n", "sipg", 8)];
    rows[1].label += ":facet-means";
    for row in &mut rows {
        row.error = Errors::default();
        row.expected_order = ExpectedOrders::default();
    }
    let text = report(rows).details_to_text(100);
    assert!(!text.contains("L2") && !text.contains("(order)"), "{text}");
    assert!(text.contains("\nsipg ") && text.contains("\nsipg:facet-means "), "{text}");
    let widest = report(rows::rows()).details_to_text(100).lines().map(str::len).max().unwrap();
    assert!(widest <= 100, "{widest}");
    assert_eq!(report(Vec::new()).details_to_text(100), "");
}

/// Rows of four levels in the order of their errors: 2 in L2, 1 in H1, which is what is promised.
fn four_levels(scheme: &str) -> Vec<Row> {
    [8, 16, 32, 64].map(|level| row("radial-2d", scheme, level)).to_vec()
}

/// Rows whose H1 errors have these orders from level to level, and nothing in L2.
fn with_local_orders(scheme: &str, orders: &[f64]) -> Vec<Row> {
    let mut error = 1.0;
    let mut rows: Vec<Row> = Vec::new();
    for (k, order) in [0.0].iter().chain(orders).enumerate() {
        let mut row = row("radial-2d", scheme, 8 << k);
        error /= 2_f64.powf(*order);
        (row.error.l2, row.error.h1) = (None, Some(error));
        row.expected_order = ExpectedOrders { l2: None, h1: Some(1.5) };
        rows.push(row);
    }
    rows
}

/// The errors of conforming quadratics on disc-2d, whose local orders swing by 0.7: neither of the
/// two finest levels decides, and four levels do not.
#[test]
fn verdicts_do_not_depend_on_the_last_level() {
    let swing = [0.82, 2.20, 0.81, 1.54];
    let verdict = |orders: &[f64], promised: f64| {
        let mut rows = with_local_orders("p2", orders);
        let promise = ExpectedOrders { l2: None, h1: Some(promised) };
        rows.iter_mut().for_each(|row| row.expected_order = promise);
        report(rows).observed_orders(0.1)[1].verdict
    };
    assert_eq!(verdict(&swing[..2], 1.5), OrderVerdict::TooFewLevels);
    assert_eq!(verdict(&swing[..3], 1.5), OrderVerdict::Undecided);
    assert_eq!(verdict(&swing[1..], 1.5), OrderVerdict::Undecided);
    assert_eq!(verdict(&swing, 1.5), OrderVerdict::Kept);
    // what the spread cannot change is decided
    assert_eq!(verdict(&swing[..3], 1.0), OrderVerdict::Kept);
    assert_eq!(verdict(&swing[..3], 1.8), OrderVerdict::Missed);
    assert_eq!(verdict(&[1.3, 1.3, 1.3], 1.5), OrderVerdict::Missed);
    assert_eq!(verdict(&[1.41, 1.41, 1.41], 1.5), OrderVerdict::Kept);
    // orders that rise towards the promise are those of coarse meshes
    assert_eq!(verdict(&[1.1, 1.2, 1.31], 1.5), OrderVerdict::Undecided);
    assert_eq!(verdict(&[1.1, 1.2, 1.29], 1.5), OrderVerdict::Missed);
    assert_eq!(verdict(&[1.2, 1.1, 1.4], 1.5), OrderVerdict::Missed);
}

#[test]
fn kept_promises_pass() {
    let mut rows = four_levels("p1");
    assert_eq!(report(rows.clone()).assert_orders(1e-9), Ok(()));
    // levels that did not converge do not count
    rows.push(row("radial-2d", "p1", 128));
    rows[4].status = Outcome::Cycling;
    rows[4].error.h1 = Some(7.0);
    let report = report(rows);
    assert_eq!(report.observed_orders(0.1)[0].levels, [8, 16, 32, 64]);
    assert_eq!(report.assert_orders(1e-9), Ok(()));
}

#[test]
fn orders_above_the_promise_keep_it() {
    let mut rows = four_levels("p1");
    rows.iter_mut().for_each(|r| r.expected_order = ExpectedOrders { l2: None, h1: Some(0.5) });
    assert_eq!(report(rows).assert_orders(0.0), Ok(()));
}

#[test]
fn a_missed_promise_names_the_row() {
    let mut rows = four_levels("p1");
    rows.extend(with_local_orders("sipg", &[1.2, 1.2, 1.2]));
    let missed = report(rows.clone()).assert_orders(0.1).unwrap_err();
    let [only] = &missed.0[..] else { panic!("{missed}") };
    assert_eq!((&only.scene[..], &only.label[..]), ("radial-2d", "sipg"));
    assert_eq!((only.norm, only.promised), (ErrorNorm::H1, Some(1.5)));
    assert!((only.fitted.as_ref().unwrap().order - 1.2).abs() < 1e-12);
    let expected = "sipg (vertices) on radial-2d: missed: order 1.20 ± 0.00 in H1 over levels \
                    8 to 64 (4), promised 1.5";
    assert_eq!(missed.to_string(), expected);
    // what a `main` that returns it prints
    assert_eq!(format!("{missed:?}"), expected);
    assert_eq!(report(rows.clone()).assert_orders(0.31), Ok(()));
    // Where nothing is promised, nothing is missed.
    rows[7].expected_order.h1 = None;
    assert_eq!(report(rows).assert_orders(0.1), Ok(()));
}

#[test]
fn a_promise_that_cannot_be_tested_is_missed() {
    let mut rows = four_levels("p1");
    rows[0].status = Outcome::Stalled;
    let missed = report(rows.clone()).assert_orders(0.1).unwrap_err();
    assert_eq!(missed.0.len(), 2, "one for each norm");
    assert_eq!(missed.0[0].verdict, OrderVerdict::TooFewLevels);
    let expected = "p1 (vertices) on radial-2d: too few levels: 16 to 64 (3) converged with an error \
                    in L2, four are needed, promised 2";
    assert_eq!(missed.0[0].to_string(), expected);
    rows.iter_mut().for_each(|row| row.expected_order = ExpectedOrders::default());
    assert_eq!(report(rows).assert_orders(0.1), Ok(()));
}
