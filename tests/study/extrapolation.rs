//! The limits of figures as the mesh size tends to zero.

use crate::rows::{report, row};
use unilateral::inequality::Outcome;
use unilateral::study::{Extrapolated, Row};

/// Rows on these mesh sizes with figures of the mesh size.
fn rows(mesh_sizes: &[f64], figures: impl Fn(f64) -> [f64; 3]) -> Vec<Row> {
    let row = |(k, &h): (usize, &f64)| {
        let mut row = row("radial-2d", "p1", 8 << k);
        row.mesh_size = h;
        let [energy, contact, resultant] = figures(h).map(Some);
        (row.energy, row.contact_measure, row.resultant) = (energy, contact, resultant);
        row
    };
    mesh_sizes.iter().enumerate().map(row).collect()
}

fn limits(rows: Vec<Row>) -> Extrapolated {
    report(rows).extrapolated().remove(0)
}

#[test]
fn a_power_of_the_mesh_size_has_its_limit_and_order() {
    for sizes in [[0.5, 0.25, 0.125], [0.6, 0.3, 0.1]] {
        let found = limits(rows(&sizes, |h| [2.0 + h * h, 1.0 - h, -3.0 + 4.0 * h.powf(1.5)]));
        assert_eq!((&found.scene[..], &found.label[..]), ("radial-2d", "p1"));
        for (limit, value, order) in [
            (found.energy, 2.0, 2.0),
            (found.contact_measure, 1.0, 1.0),
            (found.resultant, -3.0, 1.5),
        ] {
            let limit = limit.unwrap();
            assert!((limit.value - value).abs() < 1e-12, "{limit:?}");
            assert!((limit.order.unwrap() - order).abs() < 1e-12, "{limit:?}");
        }
    }
}

/// The last three levels that converged count.
#[test]
fn levels_that_failed_do_not_count() {
    let mut all = rows(&[1.0, 0.5, 0.4, 0.25, 0.125], |h| [2.0 + h * h, h, h]);
    all[0].energy = Some(7.0);
    all[2].energy = Some(9.0);
    all[2].status = Outcome::Stalled;
    let limit = limits(all.clone()).energy.unwrap();
    assert!((limit.value - 2.0).abs() < 1e-12, "{limit:?}");
    all[4].status = Outcome::Stalled;
    all[1].status = Outcome::Stalled;
    assert_eq!(report(all).extrapolated(), []);
}

#[test]
fn equal_figures_are_their_limit_and_others_have_none() {
    // within rounding; slower than any order; once larger and once smaller
    let found = limits(rows(&[0.5, 0.25, 0.125], |h| [5.0 + 1e-12 * h, h.powf(0.25), 0.0]));
    let energy = found.energy.unwrap();
    assert_eq!(energy.order, None);
    assert!((energy.value - 5.0).abs() < 1e-11);
    assert_eq!(found.contact_measure, None);
    let turning = |h: f64| [if h == 0.25 { 1.0 } else { 2.0 }, f64::NAN, h];
    let found = limits(rows(&[0.5, 0.25, 0.125], turning));
    assert_eq!((found.energy, found.contact_measure), (None, None));
    assert_eq!(limits(rows(&[0.5, 0.5, 0.125], |h| [h, h, h])).energy, None);
}
