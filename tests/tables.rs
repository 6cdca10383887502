//! Observed orders, and the tables that a terminal shows.

mod rows;

use rows::{report, row};
use unilateral::study::{Errors, ExpectedOrders, Row, fill_orders, observed_order};

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
    rows[4].status = "cycling".into();
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
    rows[3].status = "iteration-limit".into();
    rows[3].error = Errors::default();
    rows[3].warnings = vec!["eta below its bound".into()];
    rows[2].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
    rows[3].expected_order = ExpectedOrders { l2: None, h1: Some(0.5) };
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
        row.expected_order = ExpectedOrders::default();
    }
    let text = report(rows).to_string();
    assert!(!text.contains("L2") && !text.contains("order"), "{text}");
    assert!(text.contains("vertices") && text.contains("facets"), "{text}");
    let widest = report(rows::rows()).to_string().lines().map(str::len).max().unwrap();
    assert!(widest <= 100, "{widest}");
    assert_eq!(report(Vec::new()).to_string(), "");
}
