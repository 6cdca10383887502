//! Series of a report: one scheme on uniform and on adaptive meshes.

use crate::rows::row;
use unilateral::prelude::*;
use unilateral::study::{Series, fill_orders};

/// The reports of a scheme on uniform and on adaptive meshes, and that of all their rows.
fn reports() -> [Report; 3] {
    let study = || Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1);
    let uniform = study().levels([16, 4, 8, 32]).run().unwrap();
    let adaptive = study().adaptive(Adaptivity::default().steps(4)).run().unwrap();
    let mut both = uniform.clone();
    both.rows.extend(adaptive.rows.clone());
    [uniform, adaptive, both]
}

#[test]
fn uniform_and_adaptive_meshes_are_two_series() {
    let [uniform, adaptive, mut both] = reports();
    let series = both.series();
    let of = |s: &Series<'_>| (s.name.clone(), s.rows.iter().map(|r| r.level).collect::<Vec<_>>());
    let [first, second] = &series[..] else { panic!("{series:?}") };
    assert_eq!(of(first), ("p1".to_owned(), vec![4, 8, 16, 32]));
    assert_eq!(of(second), ("p1".to_owned(), vec![0, 1, 2, 3, 4]));
    assert_eq!(first.variant.theta, None);
    assert!(second.variant.theta.is_some() && second.variant.label == "p1");

    // orders, limits and verdicts are those of the two reports
    let orders = |report: &Report| report.rows.iter().map(|r| r.order).collect::<Vec<_>>();
    let alone = [orders(&uniform), orders(&adaptive)].concat();
    fill_orders(&mut both.rows);
    assert_eq!(orders(&both), alone);
    assert!(both.rows[3].order.h1.is_some() && both.rows[6].order.bound.is_some());
    assert_eq!(both.extrapolated(), uniform.extrapolated());
    let observed = [uniform.observed_orders(0.1), adaptive.observed_orders(0.1)].concat();
    assert_eq!(both.observed_orders(0.1), observed);
    assert_eq!(both.assert_orders(0.1), uniform.assert_orders(0.1));
}

/// Steps that mark other shares of the bound do not continue each other.
#[test]
fn each_share_of_marked_cells_is_a_series() {
    let mut rows = [0.5, 0.3].map(|theta| [0, 1].map(|step| (theta, step))).concat();
    let step = |(theta, step): (f64, usize)| {
        let mut row = row("radial-2d", "p1", 8 << step);
        (row.level, row.theta) = (step, Some(theta));
        row
    };
    rows.swap(1, 2);
    let mut rows: Vec<_> = rows.into_iter().map(step).collect();
    fill_orders(&mut rows);
    let has_order: Vec<bool> = rows.iter().map(|row| row.order.h1.is_some()).collect();
    assert_eq!(has_order, [false, false, true, true]);
    assert_eq!(crate::rows::report(rows).series().len(), 2);
}
