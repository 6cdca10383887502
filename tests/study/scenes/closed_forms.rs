//! Closed forms, constants and rounding.

use unilateral::mesh::BoundaryCondition;
use unilateral::scenes::{Scene, ball_2d, hertz_2d, radial, signorini_2d, signorini_harmonic};

use super::{assert_close, gradient, source, value};
use unilateral::real::Point;

#[test]
fn radial_solutions_have_their_closed_forms() {
    let r: f64 = 1.3;
    assert_close(value(&radial::<1>(1.0), [-r]), (r - 1.0).powi(2), 1e-15);
    let two = radial::<2>(1.0);
    assert_close(value(&two, [0.5, -1.2]), r * r / 2.0 - r.ln() - 0.5, 1e-15);
    assert_close(value(&two, [1.5, 1.5]), 2.25 - 4.5_f64.ln() / 2.0 - 0.5, 1e-15);
    let in_space = r * r / 3.0 + 2.0 / (3.0 * r) - 1.0;
    assert_close(value(&radial::<3>(1.0), [0.3, -0.4, 1.2]), in_space, 1e-15);
}

#[test]
fn radial_solutions_touch_to_second_order_without_cancellation() {
    fn check<const D: usize>() {
        let scene = radial::<D>(1.0);
        for t in [1e-3, 1e-7, 1e-12] {
            let mut x = [0.0; D];
            x[0] = 1.0 + t;
            // The distance that is exactly representable, and w = t^2 (1 + O(t)).
            let t = x[0] - 1.0;
            let quotient = value(&scene, x) / (t * t);
            assert!((quotient - 1.0).abs() <= 2.0 * t + 1e-15, "D = {D}, t = {t}: {quotient}");
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn radial_solutions_depend_on_x_over_scale_alone() {
    // A power of two, so that x / scale is exact.
    let scale = 2.0_f64.powi(-20);
    let (unit, small) = (radial::<2>(1.0), radial::<2>(scale));
    for x in [[1.25, -0.75], [0.5, 0.25], [1.5, 1.5], [-1.0, 0.125]] {
        let y = x.map(|t| t * scale);
        assert_eq!(value(&small, y), value(&unit, x));
        assert_eq!(gradient(&small, y), gradient(&unit, x).map(|g| g / scale));
        assert_eq!(source(&small, y), source(&unit, x) / (scale * scale));
    }
    assert_eq!(small.domain.length(), unit.domain.length() * scale);
}

#[test]
fn the_contact_disc_of_the_ball_has_the_radius_of_its_equation() {
    let a: f64 = 0.697_965_148_223_373_6;
    assert_close(a * a * (2.0_f64.ln() - a.ln()), 1.0 - a * a, 1e-15);
    let amplitude = a * a / (1.0 - a * a).sqrt();
    assert_close(amplitude, 0.680_259_411_891_716_9, 1e-15);
    assert_close(amplitude * 2.0_f64.ln(), 0.471_519_893_402_110_1, 1e-15);
    let scene = ball_2d();
    let (inner, outer) = (a * (1.0 - 1e-12), a * (1.0 + 1e-12));
    assert_close(value(&scene, [inner, 0.0]), value(&scene, [outer, 0.0]), 1e-11);
    assert_close(gradient(&scene, [inner, 0.0])[0], gradient(&scene, [outer, 0.0])[0], 1e-11);
    assert_close(value(&scene, [0.0, 2.0]), 0.0, 1e-15);
    assert!(value(&scene, [2.0, 2.0]) < 0.0);
}

#[test]
fn the_obstacle_of_the_ball_is_finite_and_continuously_differentiable() {
    let scene = ball_2d();
    let psi = scene.problem.lower.everywhere.as_ref().unwrap();
    let at = |r: f64| psi.at(&Point::from([r, 0.0]));
    let h = 1e-6;
    assert_close((at(0.9) - at(0.9 - h)) / h, (at(0.9 + h) - at(0.9)) / h, 1e-4);
    assert_close(at(0.9), 0.19_f64.sqrt(), 1e-15);
    assert!(at(1.0).is_finite() && at(2.0).is_finite());
    assert!(at(2.0) < value(&scene, [2.0, 0.0]));
}

#[test]
fn hertz_takes_its_check_values() {
    let scene = hertz_2d();
    assert_close(value(&scene, [0.3, 0.4]), -0.15558987, 5e-9);
    assert_close(value(&scene, [-0.6, 0.2]), -0.17058987, 5e-9);
    // At these points s = 0.2 + 0.6i and s = -0.4 + 0.3i, so F' = -0.1 + 0.2i and 0.2 + 0.1i; the
    // gradient is the conjugate.
    for (x, expected) in [([0.3, 0.4], [-0.1, -0.2]), ([-0.6, 0.2], [0.2, -0.1])] {
        let found = gradient(&scene, x);
        assert_close(found[0], expected[0], 1e-14);
        assert_close(found[1], expected[1], 1e-14);
    }
    // The pressure of Hertz.
    for x in [-0.4, 0.0, 0.3] {
        assert_close(-gradient(&scene, [x, 0.0])[1], (0.25 - x * x).sqrt(), 1e-15);
        assert_close(value(&scene, [x, 0.0]), -x * x / 2.0, 1e-15);
    }
}

#[test]
fn the_harmonic_signorini_solution_is_the_same_in_two_and_three_dimensions() {
    let (plane, space) = (signorini_harmonic::<2>(), signorini_harmonic::<3>());
    for (x, z) in [(0.3, 0.4), (-0.6, 0.2), (-0.5, 0.0), (1.0, 1.0)] {
        let (r, theta) = (f64::hypot(x, z), f64::atan2(z, x));
        assert_close(value(&plane, [x, z]), r.powf(1.5) * (1.5 * theta).cos(), 1e-15);
        assert_eq!(value(&space, [x, 0.7, z]), value(&plane, [x, z]));
        let [along, across] = gradient(&plane, [x, z]);
        assert_eq!(gradient(&space, [x, 0.7, z]), [along, 0.0, across]);
    }
    assert!(plane.problem.source.everywhere.is_none() && space.problem.source.everywhere.is_none());
}

#[test]
fn tips_are_finite_and_rounding_does_not_cross_the_branch_cut() {
    fn check(scene: &Scene<2>, tips: &[f64]) {
        for &x in tips {
            for y in [0.0, -0.0, 1e-300, -1e-300] {
                assert!(value(scene, [x, y]).is_finite());
                assert!(gradient(scene, [x, y]).iter().all(|g| g.is_finite()));
                assert!(source(scene, [x, y]).is_finite());
            }
        }
        for x in [-1.0, -0.75, -0.25, 0.25, 0.75] {
            for y in [-0.0, -1e-17] {
                assert_eq!(value(scene, [x, y]), value(scene, [x, 0.0]), "{} {x}", scene.name);
                // The polynomial factors of some scenes feel y itself; the branch would cost O(1).
                let (found, expected) = (gradient(scene, [x, y]), gradient(scene, [x, 0.0]));
                assert_close(found[0], expected[0], 1e-16);
                assert_close(found[1], expected[1], 1e-16);
            }
        }
    }
    check(&signorini_2d(), &[0.0, -0.0]);
    check(&signorini_harmonic::<2>(), &[0.0, -0.0]);
    check(&hertz_2d(), &[-0.5, 0.0, 0.5]);
}

#[test]
fn zero_in_contact_is_exact_on_the_contact_side() {
    for scene in [signorini_2d(), signorini_harmonic::<2>()] {
        assert_eq!(scene.domain.bounding_box().sides[1][0], BoundaryCondition::Contact);
        for x in [-0.9, -0.5, -1e-9] {
            assert_eq!(value(&scene, [x, 0.0]), 0.0);
            assert_eq!(gradient(&scene, [-x, 0.0])[1], 0.0);
        }
    }
}
