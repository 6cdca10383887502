//! Data that no problem can have.

use unilateral::inequality::{ActiveSet, Outcome, in_precision};
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::scheme::Regularity;
use unilateral::study::Row;

/// A scene on the unit square with these data, held on its sides.
fn scene(problem: Problem<2>) -> Scene<2> {
    let condition = if problem.gap.is_given() {
        BoundaryCondition::Contact
    } else {
        BoundaryCondition::Neumann
    };
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(1, 0, condition);
    Scene::new("mine", domain, problem).regularity(Regularity::new(2.0))
}

fn study(problem: Problem<2>) -> Result<Report, Error> {
    Study::<2>::new(scene(problem)).scheme(ConformingP1).scheme(Sipg::default()).levels([4]).run()
}

/// The messages of the rows with this outcome.
fn failed(problem: Problem<2>, outcome: Outcome) -> Vec<String> {
    let rows = study(problem).unwrap().rows;
    let of_outcome: Vec<&Row> = rows.iter().filter(|row| row.status == outcome).collect();
    assert!(!of_outcome.is_empty(), "{outcome} went unnoticed");
    of_outcome.iter().map(|row| row.message.clone().unwrap()).collect()
}

/// A datum that is bad right of the middle only.
fn partly(bad: f64) -> impl Fn(&Point<2>) -> f64 + Send + Sync + Copy + 'static {
    move |x| if x[0] > 0.5 { bad } else { 1.0 }
}

#[test]
fn data_that_are_not_finite_are_named_with_the_point() {
    let problem = || Problem::new().constant_source(1.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let value = partly(bad);
        for (name, problem) in [
            ("source", Problem::new().source(value)),
            ("source", Problem::new().constant_source(bad)),
            ("source", Problem::new().piecewise_source(value, |x| x[0] - 0.5)),
            ("source", Problem::new().piecewise_source(value, |x| x[0] - 0.6)),
            ("dirichlet", problem().dirichlet(value)),
            ("neumann", problem().neumann(move |x, _| value(x))),
            ("obstacle", problem().obstacle_below(value)),
            ("obstacle", problem().obstacle_above(value)),
            ("gap", problem().signorini(value)),
            ("reaction", problem().reaction(value)),
            ("reaction", problem().reaction(bad)),
            ("reaction", problem().reaction(Datum::piecewise(value, |x| x[0] - 0.6))),
        ] {
            for message in failed(problem, Outcome::NotFinite) {
                let (what, place) =
                    message.split_once(" at (").unwrap_or_else(|| panic!("{message}"));
                assert_eq!(what, format!("{name} is {bad}"));
                assert!(place.contains(", ") && place.contains(") in cell"), "{message}");
            }
        }
    }
}

#[test]
fn coefficients_must_be_positive_and_obstacles_leave_room() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let outcome = if bad.is_finite() { Outcome::NotCoercive } else { Outcome::NotFinite };
        for message in failed(Problem::new().coefficient(partly(bad)), outcome) {
            assert!(message.starts_with(&format!("coefficient is {bad} at (")), "{message}");
        }
    }
    let crossed = Problem::new().obstacle_below(|_| 0.5).obstacle_above(|x| 1.0 - x[0]);
    let over_datum = Problem::new().obstacle_below(|_| 0.5);
    for (problem, words) in [
        (crossed, ["the lower bound", "exceeds the upper bound"]),
        (over_datum, ["the lower obstacle, 0.5", "exceeds the Dirichlet value on `"]),
    ] {
        for message in failed(problem, Outcome::Infeasible) {
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        }
    }
}

/// Obstacles that touch the Dirichlet datum leave room, whatever rounding makes of them.
#[test]
fn obstacles_may_touch_the_datum() {
    fn touching(precision: Precision) -> Result<Report, Error> {
        let value = |x: &Point<2>| 0.1 + (x[0] * 7.0).sin();
        let again = |x: &Point<2>| ((x[0] * 7.0).sin() - 1.0) + 1.1;
        let problem = Problem::new().dirichlet(value).obstacle_below(again);
        let study = Study::<2>::new(scene(problem)).scheme(ConformingP1).levels([6]);
        study.boxed_solver(in_precision(precision, ActiveSet::default())).run()
    }
    for report in [touching(Precision::Double), touching(Precision::Single)] {
        assert!(report.unwrap().rows.iter().all(Row::converged));
    }
}

/// A coefficient that is fine in double precision may vanish or overflow in single precision.
#[test]
fn coefficients_must_fit_the_precision() {
    let run = |precision: Precision, alpha: f64| {
        let problem = Problem::new().constant_source(alpha).coefficient(move |_| alpha);
        let study = Study::<2>::new(scene(problem)).scheme(ConformingP1).levels([4]);
        let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
        study.run().unwrap().rows.remove(0)
    };
    for alpha in [1e-50, 1e-42, 1e50] {
        assert!(run(Precision::Double, alpha).converged());
        let row = run(Precision::Single, alpha);
        assert_eq!(row.status, Outcome::OutOfRange);
        assert!(row.warnings[0].starts_with("f32 does not hold"), "{:?}", row.warnings);
    }
    assert!(run(Precision::Single, 1e-3).converged());
}

/// A mesh that reaches where a scene has no data is refused before anything runs on it, also if
/// other meshes of the scene would do.
#[test]
fn meshes_beyond_the_data_of_a_scene_do_not_fit() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(2.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let runs = std::cell::Cell::new(0);
    let run = |problem: Problem<2>| {
        let mut scene = scene(problem);
        scene.domain = mesh.clone().into();
        let study = Study::<2>::new(scene).scheme(ConformingP1).levels([0]);
        let study = study.observer(|_| runs.set(runs.get() + 1));
        study.check().and_then(|()| study.run().map(|_| ()))
    };
    let far = |x: &Point<2>| if x[0] > 1.0 { f64::NAN } else { 0.0 };
    let above = |x: &Point<2>| x[0] - 1.5;
    for problem in [
        Problem::new().dirichlet(far),
        Problem::new().source(far),
        Problem::new().obstacle_below(far),
        Problem::new().obstacle_below(above),
        Problem::new().coefficient(move |x| 1.0 + far(x)),
    ] {
        let found = run(problem);
        assert!(matches!(found, Err(Error::UnfitMesh(_))), "{found:?}");
    }
    assert_eq!(runs.get(), 0, "nothing was told to run");
    run(Problem::new().constant_source(1.0)).unwrap();
    assert!(runs.get() > 0);
}
