//! The catalogue: every scene solves its inequality, and the check that says so can say no.

use std::collections::HashSet;

use unilateral::error::Error;
use unilateral::mesh::BoundaryPart;
use unilateral::problem::{Exact, Problem};
use unilateral::real::Point;
use unilateral::scenes::check::{Condition, Violation};
use unilateral::scenes::{
    AnyScene, BoxDomain, Entry, Parameters, Regularity, Scene, ball_2d, by_name, catalogue,
    check_scene, hertz_2d, radial, signorini_2d, signorini_harmonic,
};

const SAMPLES: usize = 1000;

fn check_any(scene: &AnyScene) -> Result<(), Violation> {
    match scene {
        AnyScene::One(scene) => check_scene(scene, SAMPLES),
        AnyScene::Two(scene) => check_scene(scene, SAMPLES),
        AnyScene::Three(scene) => check_scene(scene, SAMPLES),
    }
}

fn exact<const D: usize>(scene: &Scene<D>) -> &Exact<D> {
    scene.problem.exact.as_ref().expect("the scene states its solution")
}

fn value<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> f64 {
    (exact(scene).value)(&Point::from(x))
}

fn gradient<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> [f64; D] {
    (exact(scene).gradient)(&Point::from(x)).into()
}

fn source<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> f64 {
    scene.problem.source.as_ref().map_or(0.0, |f| f.at(&Point::from(x)))
}

/// Equal to the digits a table prints.
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

// --- The catalogue ---------------------------------------------------------------------------

#[test]
fn every_registered_scene_solves_its_inequality() {
    for entry in catalogue() {
        let scene = entry.make(&Parameters::default()).unwrap();
        check_any(&scene).unwrap_or_else(|violation| panic!("{violation}"));
    }
}

#[test]
fn every_scaled_scene_solves_its_inequality_at_extreme_scales() {
    for entry in catalogue().into_iter().filter(|entry| entry.takes.scale) {
        for scale in [1e-6, 1e-3, 1e6] {
            let scene =
                entry.make(&Parameters { scale: Some(scale), ..Parameters::default() }).unwrap();
            check_any(&scene).unwrap_or_else(|violation| panic!("scale {scale}: {violation}"));
        }
    }
}

#[test]
fn names_are_unique_and_end_in_the_dimension() {
    let entries = catalogue();
    let names: HashSet<_> = entries.iter().map(|entry| entry.name.clone()).collect();
    assert_eq!(names.len(), entries.len());
    for entry in &entries {
        assert!(entry.name.ends_with(&format!("-{}d", entry.dimension)), "{}", entry.name);
        assert!(!entry.summary.is_empty() && !entry.summary.contains('\n'));
    }
    let in_order: Vec<_> = entries.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(
        in_order,
        [
            "radial-1d",
            "radial-2d",
            "radial-3d",
            "ball-2d",
            "signorini-harmonic-2d",
            "signorini-2d",
            "hertz-2d",
            "signorini-harmonic-3d",
        ]
    );
}

#[test]
fn scenes_are_found_by_name_only() {
    let entry = by_name("radial-3d").unwrap();
    assert_eq!((entry.dimension, entry.takes.scale), (3, true));
    assert!(matches!(entry.make(&Parameters::default()).unwrap(), AnyScene::Three(_)));
    assert!(by_name("radial").is_none());
    assert!(by_name("Radial-3d").is_none());
}

#[test]
fn a_scale_must_be_positive_and_finite() {
    let entry = by_name("radial-2d").unwrap();
    for (scale, text) in [
        (0.0, "0"),
        (-1.0, "-1"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (1e-200, "1e-200"),
        (1e200, "1e200"),
    ] {
        let made = entry.make(&Parameters { scale: Some(scale), ..Parameters::default() });
        let Err(Error::Parameter { parameter, value, .. }) = made else {
            panic!("scale {scale} was admitted")
        };
        assert_eq!((parameter, &value[..]), ("scale", text));
    }
}

#[test]
fn a_parameter_that_a_scene_does_not_take_is_refused() {
    let one = Some(1.0);
    let cases = [
        ("ball-2d", "scale", Parameters { scale: one, ..Parameters::default() }),
        ("radial-2d", "contrast", Parameters { contrast: one, ..Parameters::default() }),
        ("radial-2d", "load", Parameters { load: one, ..Parameters::default() }),
    ];
    for (name, expected, parameters) in cases {
        let Err(error) = by_name(name).unwrap().make(&parameters) else {
            panic!("{name} took a {expected}")
        };
        assert!(matches!(error, Error::Parameter { parameter, .. } if parameter == expected));
        assert!(error.to_string().contains(&format!("{name} takes no {expected}")), "{error}");
    }
}

#[test]
fn entries_outside_the_catalogue_hand_their_parameter_on() {
    let loaded = Entry::loaded(-2.0, |load| {
        let mut scene = radial::<1>(1.0);
        scene.problem.source = Some(load.into());
        scene
    });
    assert!(loaded.takes.load && !loaded.takes.scale);
    let load_of = |parameters: &Parameters| match loaded.make(parameters).unwrap() {
        AnyScene::One(scene) => source(&scene, [0.0]),
        _ => unreachable!("the scene is one-dimensional"),
    };
    assert_eq!(load_of(&Parameters::default()), -2.0);
    assert_eq!(load_of(&Parameters { load: Some(-5.0), ..Parameters::default() }), -5.0);
    let made = loaded.make(&Parameters { load: Some(f64::NAN), ..Parameters::default() });
    assert!(matches!(made, Err(Error::Parameter { parameter: "load", .. })));
    let contrasted = Entry::contrasted(1e4, |_| radial::<1>(1.0));
    let made = contrasted.make(&Parameters { contrast: Some(0.0), ..Parameters::default() });
    assert!(matches!(made, Err(Error::Parameter { parameter: "contrast", .. })));
}

// --- Check values and constants --------------------------------------------------------------

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
    assert_eq!(small.domain.upper, unit.domain.upper * scale);
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
    let psi = scene.problem.lower.as_ref().unwrap();
    let at = |r: f64| psi(&Point::from([r, 0.0]));
    let h = 1e-6;
    assert_close((at(0.9) - at(0.9 - h)) / h, (at(0.9 + h) - at(0.9)) / h, 1e-4);
    assert_close(at(0.9), 0.19_f64.sqrt(), 1e-15);
    assert!(at(1.0).is_finite() && at(2.0).is_finite());
    assert!(at(2.0) < value(&scene, [2.0, 0.0]));
}

#[test]
fn the_homogeneous_signorini_scene_takes_its_check_values() {
    let scene = signorini_2d();
    assert_close(value(&scene, [0.3, 0.4]), 0.0483449, 5e-9);
    assert_close(source(&scene, [0.3, 0.4]), 0.48699076, 5e-9);
    assert_close(value(&scene, [-0.6, 0.2]), -0.14342142, 5e-9);
    assert_close(source(&scene, [-0.6, 0.2]), -1.79012171, 5e-9);
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
    assert!(plane.problem.source.is_none() && space.problem.source.is_none());
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
        assert_eq!(scene.domain.sides[1][0], BoundaryPart::Contact);
        for x in [-0.9, -0.5, -1e-9] {
            assert_eq!(value(&scene, [x, 0.0]), 0.0);
            assert_eq!(gradient(&scene, [-x, 0.0])[1], 0.0);
        }
    }
}

// --- The check says no -----------------------------------------------------------------------

fn refused<const D: usize>(scene: &Scene<D>) -> Condition {
    check_scene(scene, 300).expect_err("a wrong scene passed").condition
}

#[test]
fn the_check_refuses_a_load_of_the_wrong_sign() {
    let mut scene = radial::<2>(1.0);
    scene.problem.source = Some(2.0.into());
    let condition = refused(&scene);
    assert!(matches!(condition, Condition::Equation | Condition::MultiplierSign), "{condition}");
}

#[test]
fn the_check_refuses_a_load_that_is_slightly_off() {
    let mut scene = signorini_2d();
    let f = scene.problem.source.take().unwrap();
    scene.problem = scene.problem.source(move |x| f.at(x) + 1e-4);
    assert_eq!(refused(&scene), Condition::Equation);
}

#[test]
fn the_check_refuses_a_multiplier_of_the_wrong_sign() {
    let mut scene = radial::<2>(1.0);
    scene.problem = scene.problem.source(|x| if x.norm() <= 1.0 { 1.0 } else { -2.0 });
    assert_eq!(refused(&scene), Condition::MultiplierSign);
}

#[test]
fn the_check_refuses_a_wrong_gradient() {
    let mut scene = hertz_2d();
    let Exact { value, gradient, .. } = scene.problem.exact.take().unwrap();
    scene.problem = scene.problem.exact(value, move |x| gradient(x) * (1.0 + 1e-4));
    assert_eq!(refused(&scene), Condition::Gradient);
}

#[test]
fn the_check_refuses_an_obstacle_above_the_solution() {
    let mut scene = radial::<2>(1.0);
    scene.problem = scene.problem.obstacle_below(|x| if x.norm() < 0.5 { 1e-3 } else { 0.0 });
    assert_eq!(refused(&scene), Condition::LowerObstacle);
    let mut scene = radial::<2>(1.0);
    scene.problem = scene.problem.obstacle_above(|x| if x.norm() < 1.2 { 1e-3 } else { 1e3 });
    assert_eq!(refused(&scene), Condition::UpperObstacle);
}

#[test]
fn the_check_refuses_wrong_boundary_data() {
    let mut scene = ball_2d();
    scene.problem = scene.problem.dirichlet(|x| (2.0 / x.norm()).ln());
    assert_eq!(refused(&scene), Condition::Dirichlet);
    let mut scene = radial::<2>(1.0);
    scene.domain = scene.domain.side(0, 1, BoundaryPart::Neumann);
    scene.problem = scene.problem.neumann(|_, _| 0.0);
    assert_eq!(refused(&scene), Condition::Neumann);
}

#[test]
fn the_check_refuses_broken_signorini_conditions() {
    let mut scene = hertz_2d();
    scene.problem = scene.problem.signorini(|x| 1e-3 - x[0] * x[0] / 2.0);
    assert_eq!(refused(&scene), Condition::Gap);
    let mut scene = hertz_2d();
    scene.problem = scene.problem.signorini(|x| -1e-3 - x[0] * x[0] / 2.0);
    assert_eq!(refused(&scene), Condition::ContactComplementarity);
    let mut scene = hertz_2d();
    scene.domain = scene.domain.side(1, 1, BoundaryPart::Contact);
    scene.problem = scene.problem.signorini(|_| -10.0);
    assert!(matches!(refused(&scene), Condition::ContactFlux | Condition::ContactComplementarity));
    let mut scene = hertz_2d();
    scene.problem.gap = None;
    assert_eq!(refused(&scene), Condition::GapGiven);
}

#[test]
fn the_check_refuses_the_gradient_of_a_neglected_branch_cut() {
    // atan2 sees the sign of zero: just below the axis the angle is -pi.
    let power = |exponent: f64, x: &Point<f64, 2>| {
        let (r, theta) = (x.norm(), x[1].atan2(x[0]));
        (r.powf(exponent) * (exponent * theta).cos(), r.powf(exponent) * (exponent * theta).sin())
    };
    let mut scene = signorini_harmonic::<2>();
    scene.problem = scene.problem.exact(
        move |x| power(1.5, x).0,
        move |x| Point::from([1.5 * power(0.5, x).0, -1.5 * power(0.5, x).1]),
    );
    assert_eq!(refused(&scene), Condition::BoundaryLimit);
}

#[test]
fn the_check_refuses_data_that_are_not_finite() {
    let mut scene = ball_2d();
    scene.problem = scene.problem.obstacle_below(|x| (1.0 - x.norm_squared()).sqrt());
    assert_eq!(refused(&scene), Condition::Finite("lower obstacle"));
    let mut scene = radial::<3>(1.0);
    let Exact { value, gradient, .. } = scene.problem.exact.take().unwrap();
    scene.problem = scene.problem.exact(value, move |x| gradient(x) + x * (0.0 / x.norm()));
    let violation = check_scene(&scene, 300).unwrap_err();
    assert_eq!(violation.condition, Condition::Finite("gradient"));
    assert_eq!(violation.at, [0.0; 3]);
}

#[test]
fn the_check_refuses_a_coefficient_that_is_not_positive() {
    let mut scene = radial::<1>(1.0);
    scene.problem = scene.problem.coefficient(|x| x[0]);
    assert_eq!(refused(&scene), Condition::Ellipticity);
}

// --- A user's scene, and kinks ---------------------------------------------------------------

/// `u = sign * (1/2 - |x|/2)`, harmonic but for a kink at `x = 0` that only an obstacle can hold.
fn ridge(sign: f64, problem: Problem<1>) -> Scene<1> {
    Scene {
        name: "ridge".into(),
        summary: "a kink",
        domain: BoxDomain::dirichlet(Point::from([-1.0]), Point::from([1.0])),
        problem: problem.exact(
            move |x| sign * (1.0 - x[0].abs()) / 2.0,
            move |x| Point::from([-sign * x[0].signum() / 2.0]),
        ),
        regularity: Regularity { sobolev: 1.5, strictly_complementary: true },
    }
}

#[test]
fn a_kink_passes_only_where_an_obstacle_holds_it() {
    let held = Problem::new().obstacle_below(|x: &Point<f64, 1>| 0.5 - x[0].abs());
    check_scene(&ridge(1.0, held), 300).unwrap();
    let held = Problem::new().obstacle_above(|x: &Point<f64, 1>| x[0].abs() - 0.5);
    check_scene(&ridge(-1.0, held), 300).unwrap();
    assert_eq!(refused(&ridge(1.0, Problem::new())), Condition::Kink);
    // An obstacle from below cannot pull.
    let wrong_side = Problem::new().obstacle_below(|x: &Point<f64, 1>| -0.5 - x[0].abs());
    assert_eq!(refused(&ridge(-1.0, wrong_side)), Condition::Kink);
}

#[test]
fn the_check_refuses_a_jump_of_the_value() {
    let mut scene = radial::<2>(1.0);
    let Exact { value, gradient, .. } = scene.problem.exact.take().unwrap();
    scene.problem =
        scene.problem.exact(move |x| value(x) + f64::from(u8::from(x.norm() > 1.0)), gradient);
    assert_eq!(refused(&scene), Condition::Continuity);
}

#[test]
fn a_violation_says_what_where_and_by_how_much() {
    let mut scene = radial::<2>(1.0);
    scene.problem.source = Some(2.0.into());
    let text = check_scene(&scene, 300).unwrap_err().to_string();
    for part in ["radial-2d", "not fulfilled", "at [", "off by", "allowed"] {
        assert!(text.contains(part), "{text}");
    }
}
