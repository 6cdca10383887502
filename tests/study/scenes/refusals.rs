//! The check says no.

use unilateral::mesh::BoundaryCondition;
use unilateral::mesh::BoxDomain;
use unilateral::problem::{Datum, Exact, Given, Problem};
use unilateral::real::Point;
use unilateral::scenes::{Scene, ball_2d, check_scene, hertz_2d, lshape_2d, radial, signorini_2d};
use unilateral::scheme::Regularity;

/// A datum that takes the place of that of a scene.
fn given<const D: usize>(f: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static) -> Given<Datum<D>> {
    Datum::from(f).into()
}

fn refused<const D: usize>(scene: &Scene<D>) -> String {
    check_scene(scene, 300).expect_err("a wrong scene passed").condition
}

#[test]
fn the_check_refuses_a_load_of_the_wrong_sign() {
    let mut scene = radial::<2>(1.0);
    scene.problem.source.everywhere = Some(2.0.into());
    let condition = refused(&scene);
    assert!(
        ["-div(alpha grad u) + c u = f off contact", "sign of the multiplier on contact"]
            .contains(&&condition[..]),
        "{condition}"
    );
}

#[test]
fn the_check_refuses_a_load_that_is_slightly_off() {
    let mut scene = signorini_2d();
    let f = scene.problem.source.everywhere.take().unwrap();
    scene.problem = scene.problem.source(move |x| f.at(x) + 1e-4);
    assert_eq!(refused(&scene), "-div(alpha grad u) + c u = f off contact");
}

#[test]
fn the_check_refuses_a_multiplier_of_the_wrong_sign() {
    let mut scene = radial::<2>(1.0);
    scene.problem.source = given(|x: &Point<2>| if x.norm() <= 1.0 { 1.0 } else { -2.0 });
    assert_eq!(refused(&scene), "sign of the multiplier on contact");
}

#[test]
fn the_check_refuses_a_wrong_gradient() {
    let mut scene = hertz_2d();
    let Exact { value, gradient, .. } = scene.problem.exact.take().unwrap();
    scene.problem = scene.problem.exact(move |x| value.at(x), move |x| gradient(x) * (1.0 + 1e-4));
    assert_eq!(refused(&scene), "gradient equal to the derivative of the value");
}

#[test]
fn the_check_refuses_an_obstacle_above_the_solution() {
    let mut scene = radial::<2>(1.0);
    scene.problem.lower = given(|x: &Point<2>| if x.norm() < 0.5 { 1e-3 } else { 0.0 });
    assert_eq!(refused(&scene), "solution above the lower obstacle");
    let mut scene = radial::<2>(1.0);
    scene.problem = scene.problem.obstacle_above(|x| if x.norm() < 1.2 { 1e-3 } else { 1e3 });
    assert_eq!(refused(&scene), "solution below the upper obstacle");
}

#[test]
fn the_check_refuses_wrong_boundary_data() {
    let mut scene = ball_2d();
    scene.problem = scene.problem.dirichlet(|x| (2.0 / x.norm()).ln());
    assert_eq!(refused(&scene), "Dirichlet data equal to the solution");
    let mut scene = radial::<2>(1.0);
    scene.domain = BoxDomain::centred(1.5).side(0, 1, BoundaryCondition::Neumann).into();
    scene.problem = scene.problem.neumann(|_, _| 0.0);
    assert_eq!(refused(&scene), "Neumann data equal to the flux of the solution");
}

#[test]
fn the_check_refuses_broken_signorini_conditions() {
    let mut scene = hertz_2d();
    scene.problem.gap = given(|x| 1e-3 - x[0] * x[0] / 2.0);
    assert_eq!(refused(&scene), "u >= g on the contact boundary");
    let mut scene = hertz_2d();
    scene.problem.gap = given(|x| -1e-3 - x[0] * x[0] / 2.0);
    assert_eq!(refused(&scene), "u = g or alpha du/dn = 0 on the contact boundary");
    let mut scene = hertz_2d();
    scene.domain = BoxDomain::above_contact().side(1, 1, BoundaryCondition::Contact).into();
    scene.problem.gap = given(|_| -10.0);
    assert!(
        [
            "alpha du/dn >= 0 on the contact boundary",
            "u = g or alpha du/dn = 0 on the contact boundary"
        ]
        .contains(&&refused(&scene)[..])
    );
}

/// `u = sign * (1/2 - |x|/2)`, harmonic but for a kink at `x = 0` that only an obstacle can hold.
fn ridge(sign: f64, problem: Problem<1>) -> Scene<1> {
    let problem = problem.exact(
        move |x| sign * (1.0 - x[0].abs()) / 2.0,
        move |x| Point::from([-sign * x[0].signum() / 2.0]),
    );
    Scene::new("ridge", BoxDomain::centred(1.0), problem)
        .summary("a kink")
        .regularity(Regularity::new(1.5))
}

#[test]
fn a_kink_passes_where_an_obstacle_holds_it() {
    let held = Problem::new().obstacle_below(|x: &Point<1>| 0.5 - x[0].abs());
    check_scene(&ridge(1.0, held), 300).unwrap();
    let held = Problem::new().obstacle_above(|x: &Point<1>| x[0].abs() - 0.5);
    check_scene(&ridge(-1.0, held), 300).unwrap();
}

/// No step of differences resolves a function that oscillates within rounding.
#[test]
fn the_check_refuses_a_solution_without_derivatives() {
    let noise = |x: &Point<1>| 1.0 + 1e-3 * (1e12 * x[0]).sin();
    let problem = Problem::new().dirichlet(noise).exact(noise, |_| Point::zeros());
    let scene = Scene::new("noise", BoxDomain::centred(1.0), problem);
    assert_eq!(refused(&scene), "second derivatives that differences can resolve");
}

#[test]
fn a_violation_says_what_where_and_by_how_much() {
    let mut scene = radial::<2>(1.0);
    scene.problem.source.everywhere = Some(2.0.into());
    let text = check_scene(&scene, 300).unwrap_err().to_string();
    for part in ["radial-2d", "not fulfilled", "at [", "off by", "allowed"] {
        assert!(text.contains(part), "{text}");
    }
}

// --- Multipliers, contact sets, interfaces, other domains ------------------------------------

/// The scene with another statement on its solution.
fn restated<const D: usize>(
    mut scene: Scene<D>,
    restate: impl FnOnce(Exact<D>) -> Exact<D>,
) -> Scene<D> {
    let exact = scene.problem.exact.take().unwrap();
    scene.problem = scene.problem.solved_by(restate(exact));
    scene
}

#[test]
fn the_check_refuses_a_wrong_multiplier() {
    let doubled = restated(radial::<2>(1.0), |exact| exact.with_multiplier(|_| 2.0));
    assert_eq!(refused(&doubled), "stated multiplier equal to that of the solution");
    let none = restated(hertz_2d(), |exact| exact.with_multiplier(|_| 0.0));
    assert_eq!(refused(&none), "stated multiplier equal to that of the solution");
}

#[test]
fn the_check_refuses_a_wrong_contact_set() {
    for radius in [0.9, 1.1] {
        let off = move |x: &Point<2>| radius - x.norm();
        let scene = restated(radial::<2>(1.0), |exact| exact.with_contact(off, Vec::new()));
        assert_eq!(refused(&scene), "contact inside the stated contact set and nowhere else");
        let off = move |x: &Point<2>| radius / 2.0 - x[0].abs();
        let scene = restated(hertz_2d(), |exact| exact.with_contact(off, Vec::new()));
        assert_eq!(refused(&scene), "contact inside the stated contact set and nowhere else");
    }
    let nowhere = restated(signorini_2d(), |exact| exact.with_contact(|_| f64::NAN, Vec::new()));
    assert_eq!(refused(&nowhere), "contact inside the stated contact set and nowhere else");
}

#[test]
fn the_check_refuses_a_point_that_is_not_on_the_free_boundary() {
    let beside = vec![Point::from([1e-6, 0.0])];
    let scene = restated(signorini_2d(), |exact| exact.with_contact(|x| -x[0], beside));
    assert_eq!(refused(&scene), "free boundary between contact and no contact");
}

#[test]
fn the_check_refuses_wrong_data_on_the_re_entrant_sides() {
    let mut scene = lshape_2d();
    scene.problem = scene.problem.dirichlet(|x| if x.amax() < 1.9 { 1e-3 } else { 0.0 });
    assert_eq!(refused(&scene), "Dirichlet data equal to the solution");
}
