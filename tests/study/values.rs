//! Values by name: their right values, orders, and the balance of forces.

use std::path::Path;

use unilateral::prelude::*;
use unilateral::problem_file::read;
use unilateral::scenes::AnyScene;
use unilateral::scheme::SCHEMES;
use unilateral::study::Row;

/// What all forces leave of the loads, over the largest of them.
fn imbalance(row: &Row, loads: f64, reaction: f64) -> f64 {
    let value = |name: &str| row.values.get(name).copied().flatten().unwrap_or(0.0);
    let absorbed = reaction * value("mean");
    let (held, resultant) = (value("held"), row.resultant.unwrap_or(0.0));
    let size = [loads, absorbed, held, resultant].into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    (loads - absorbed + held + resultant).abs() / size
}

/// The rows of all schemes on a scene of which the sum of loads is known, and the reaction coefficient times the volume.
fn balanced<const D: usize>(scene: Scene<D>, level: usize, loads: f64, reaction: f64) {
    let all = || "default".to_owned();
    let mut scene = scene;
    scene.problem =
        scene.problem.value("mean", ValueOf::Mean(all())).value("held", ValueOf::Reaction(all()));
    let mut study = Study::new(scene).levels([level]);
    let placements = ["wopsip:facet-means", "sipg:facet-means", "wopsip@factor=100"];
    for name in SCHEMES.iter().map(|scheme| scheme.0).chain(placements) {
        study = study.named_scheme(&name.parse().unwrap());
    }
    for row in &study.run().unwrap().rows {
        assert!(row.converged(), "{}: {}", row.label, row.status);
        let imbalance = imbalance(row, loads, reaction);
        assert!(imbalance < 1e-8, "{} on {}: {imbalance:.1e}", row.label, row.scene);
    }
}

fn balance() -> Scene<2> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/balance.toml");
    match read(&path).unwrap().scene {
        AnyScene::Two(scene) => scene,
        _ => panic!("a problem in the plane"),
    }
}

#[test]
fn values_of_the_example_tend_to_those_of_its_solution() {
    let right = [
        ("middle", 0.375),
        ("mean", 1.0 / 3.0),
        ("lowest", -1.5),
        ("outlet", -1.0 / 6.0),
        ("left", 0.5),
        ("top", -4.0),
        ("held", -3.5),
        ("pressed", 2.0),
    ];
    let mut study = Study::new(balance()).levels([4, 8, 16]);
    for name in ["p1", "cr", "sipg", "nipg", "br2", "wopsip", "p2", "sipg-p2"] {
        study = study.named_scheme(&name.parse().unwrap());
    }
    let report = study.run().unwrap();
    for row in &report.rows {
        assert_eq!(row.values.len(), right.len());
        for (name, right) in right {
            let (value, error) = (row.values[name].unwrap(), row.error.values[name].unwrap());
            // the solution is in the space of quadratics; a corner of two pinned groups is divided between them
            let is_divided = row.label == "p2" && ["left", "top"].contains(&name);
            let is_exact = row.label.ends_with("p2") && !is_divided;
            let limit = if is_exact { 1e-9 } else { 2.0 * row.mesh_size };
            assert!((value - right).abs() < limit, "{} {}: {name} {value}", row.label, row.level);
            assert!((error - (value - right).abs()).abs() < 1e-9, "{}: {name} {error}", row.label);
        }
        assert_eq!(row.values_at.keys().collect::<Vec<_>>(), ["lowest"]);
        let place = &row.values_at["lowest"];
        assert!((place[0] - 2.0).abs() + (place[1] - 1.0).abs() < 1e-12, "{place:?}");
        assert!(imbalance(row, 8.0 / 3.0 - 0.5, 2.0) < 1e-8, "{}", row.label);
    }
    // means converge with order two, and the limits of three levels are nearer than the last one
    for found in report.extrapolated() {
        if found.label.ends_with("p2") {
            continue;
        }
        let limit = found.values["mean"].unwrap_or_else(|| panic!("no limit of {}", found.label));
        let last = report.rows.iter().rfind(|row| row.label == found.label).unwrap();
        assert!((1.6..2.6).contains(&limit.order.unwrap()), "{}: {limit:?}", found.label);
        let (of_limit, of_last) =
            (limit.value - 1.0 / 3.0, last.values["mean"].unwrap() - 1.0 / 3.0);
        assert!(of_limit.abs() < 0.3 * of_last.abs(), "{}: {of_limit} {of_last}", found.label);
    }
}

#[test]
fn reactions_and_forces_balance_the_loads_in_every_scheme() {
    balanced(balance(), 8, 8.0 / 3.0 - 0.5, 2.0);
    // the obstacle touches the Dirichlet data
    let domain = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    let problem = Problem::new().constant_source(-1.0).obstacle_below(|_| 0.0);
    balanced(Scene::new("pressed everywhere", domain.clone(), problem), 6, -1.0, 0.0);
    let problem = Problem::new()
        .constant_source(-30.0)
        .obstacle_below(|x: &Point<2>| -0.6 * x[0])
        .coefficient(|x: &Point<2>| 1.0 + x[1]);
    balanced(Scene::new("pressed at one side", domain, problem), 6, -30.0, 0.0);
    let line = BoxDomain::<1>::dirichlet(Point::zeros(), Point::repeat(2.0));
    let problem = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.25);
    balanced(Scene::new("string", line, problem), 16, -16.0, 0.0);
    let cube = BoxDomain::<3>::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 1, BoundaryCondition::Neumann)
        .side(2, 0, BoundaryCondition::Contact);
    let problem = Problem::new()
        .constant_source(-6.0)
        .reaction(2.0)
        .neumann(|_: &Point<3>, _: &Point<3>| 0.5)
        .signorini(|_: &Point<3>| -0.01);
    balanced(Scene::new("cube", cube, problem), 3, -6.0 + 0.5, 2.0);
}

/// Against a reference, errors of values are differences from its values.
#[test]
fn values_are_measured_against_a_reference() {
    let mut scene = balance();
    scene.problem.exact = None;
    let study = Study::new(scene).scheme(ConformingP1).levels([4, 8]);
    let report = study.reference(ConformingP2, 32).run().unwrap();
    for row in &report.rows {
        for (name, right) in [("mean", 1.0 / 3.0), ("held", -3.5), ("lowest", -1.5)] {
            let error = (row.values[name].unwrap() - right).abs();
            assert!((row.error.values[name].unwrap() - error).abs() < 1e-8, "{name}");
        }
    }
}

/// A quadratic function has its extremes between the nodes.
#[test]
fn extremes_are_those_between_nodes() {
    let (a, b) = (0.3, 0.55);
    let value = move |x: &Point<2>| 2.0 - (x[0] - a).powi(2) - 3.0 * (x[1] - b).powi(2);
    let gradient = move |x: &Point<2>| Point::<2>::from([-2.0 * (x[0] - a), -6.0 * (x[1] - b)]);
    let domain = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mut problem = Problem::new().constant_source(8.0).dirichlet(value);
    problem = problem.exact(value, gradient).value("top", ValueOf::Largest("default".to_owned()));
    let scene = Scene::new("bump", domain, problem);
    let report =
        Study::new(scene).scheme(ConformingP2).scheme(ConformingP1).levels([2, 3]).run().unwrap();
    for row in &report.rows {
        let (found, place) = (row.values["top"].unwrap(), &row.values_at["top"]);
        if row.label == "p2" {
            assert!((found - 2.0).abs() < 1e-10, "{found}");
            assert!((place[0] - a).abs() + (place[1] - b).abs() < 1e-8, "{place:?}");
        }
        let error = row.error.values["top"].unwrap();
        assert!((error - (found - 2.0).abs()).abs() < 1e-9, "{error} and {found}");
    }
}

#[test]
fn values_of_names_that_the_mesh_does_not_have_are_refused() {
    let scene = balance();
    let mesh = scene.domain.mesh(4).unwrap();
    let solved = solve(&scene.problem, &mesh, &Sipg::default()).unwrap();
    for (of, expected) in [
        (
            ValueOf::Reaction("right".to_owned()),
            "no dirichlet or robin boundary group `right`; it has left, top",
        ),
        (
            ValueOf::Force("left".to_owned()),
            "no contact or friction boundary group `left`; it has bottom",
        ),
        (ValueOf::Integral("lid".to_owned()), "no boundary group `lid`; it has"),
        (ValueOf::Mean("steel".to_owned()), "no region `steel`; it has none with a name"),
    ] {
        let error = solved.values_of(&[of]).unwrap_err();
        assert!(matches!(error, Error::UnknownGroup(_)), "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
    let outside = solved.values_of(&[ValueOf::At(Point::from([3.0, 0.0]))]).unwrap();
    assert_eq!(outside[0].value, None);
}
