//! Observed orders of convergence, of two meshes and fitted to several.

use unilateral::measure::{fit_order, observed_order};

#[test]
fn orders_are_of_the_ratio_of_mesh_sizes() {
    let order = observed_order(4e-2, 1e-2, 0.5, 0.25).unwrap();
    assert!((order - 2.0).abs() < 1e-12);
    assert_eq!(observed_order(4e-2, 0.0, 0.5, 0.25), None);
    let order = observed_order(8.0, 1.0, 0.9, 0.3).unwrap();
    assert!((order - 8f64.ln() / 3f64.ln()).abs() < 1e-14);
    // quotients that overflow or vanish have an order all the same
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
fn fitted_orders_have_the_spread_of_a_regression() {
    // logarithms of base 2 at 0, 1, 2, 3: 0, -1, -3, -4; slope -1.4, residuals 0.1, -0.3, 0.3, -0.1
    let fitted = fit_order(&[(1.0, 1.0), (0.5, 0.5), (0.25, 0.125), (0.125, 0.0625)]).unwrap();
    assert!((fitted.order - 1.4).abs() < 1e-14);
    assert!((fitted.spread - 2.0 * (0.2_f64 / 2.0 / 5.0).sqrt()).abs() < 1e-14);
    assert!(fitted.local.iter().zip([1.0, 2.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-14));
    assert_eq!(fit_order(&[(1.0, 1.0), (0.5, 0.5)]).unwrap().spread, f64::INFINITY);
    for wrong in [
        &[(1.0, 1.0)][..],
        &[(1.0, f64::NAN), (0.5, 1.0), (0.25, 0.5)],
        &[(1.0, 1.0), (0.5, 0.0), (0.25, 0.5)],
        &[(0.5, 1.0), (0.5, 0.5)],
    ] {
        assert_eq!(fit_order(wrong), None);
    }
}

#[test]
fn a_power_law_has_its_order_and_no_spread() {
    let fitted = fit_order(&[(0.4, 4.0), (0.2, 1.0), (0.1, 0.25), (0.05, 0.0625)]).unwrap();
    assert!((fitted.order - 2.0).abs() < 1e-12 && fitted.spread < 1e-12);
}
