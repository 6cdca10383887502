//! Robin sides: orders, limits, balance of forces, bounds, and what is refused.

use unilateral::error_bound::ErrorBound;
use unilateral::prelude::*;
use unilateral::problem::{Datum, ValueOf};
use unilateral::real::Point;

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    name.parse::<NamedScheme>().unwrap().make()
}

/// The unit box with a Robin side at the upper end of the first axis, held elsewhere unless it is free.
fn mesh<const D: usize>(problem: &Problem<D>, n: usize, is_free: bool) -> Mesh<D> {
    let mut unit = BoxDomain::<D>::dirichlet(Point::zeros(), Point::repeat(1.0));
    for axis in 0..D {
        for end in 0..2 {
            if is_free || (axis, end) == (0, 1) {
                unit = unit.side(axis, end, BoundaryCondition::Neumann);
            }
        }
    }
    problem.bind_boundary(Mesh::kuhn_box(&unit, [n; D]).unwrap()).unwrap()
}

/// A smooth solution with a Robin side whose coefficient varies: `k = 2 + y` in the plane.
fn smooth<const D: usize>() -> Problem<D> {
    let angle = |x: &Point<D>| (0..D).map(|k| x[k] * (1.0 + 0.5 * k as f64)).sum::<f64>() + 0.2;
    let slopes = Point::<D>::from_fn(|k, _| 1.0 + 0.5 * k as f64);
    let coefficient = |x: &Point<D>| 2.0 + x[D - 1];
    let value = move |x: &Point<D>| angle(x).sin();
    let gradient = move |x: &Point<D>| slopes * angle(x).cos();
    Problem::new()
        .source(move |x| slopes.norm_squared() * value(x))
        .exact(value, gradient)
        .robin_on("right", coefficient, move |x: &Point<D>| {
            value(x) + gradient(x)[0] / coefficient(x)
        })
}

fn has_its_orders<const D: usize>(levels: [usize; 2], names: &[(&str, f64)]) {
    for &(name, expected) in names {
        let problem = smooth::<D>();
        let errors = levels.map(|n| {
            let mesh = mesh(&problem, n, false);
            let solved = solve(&problem, &mesh, &*scheme::<D>(name)).unwrap();
            assert!(solved.converged(), "{name} at {n}");
            let errors = solved.errors().unwrap();
            [errors.h1.unwrap(), errors.energy.unwrap(), errors.l2.unwrap()]
        });
        let order = |k: usize| (errors[0][k] / errors[1][k]).log2();
        assert!(order(0) > expected - 0.1, "{name} in {D}: H1 {:?}", order(0));
        assert!(order(1) > expected - 0.15, "{name} in {D}: energy {:?}", order(1));
        // penalties without a symmetric form lose one order for quadratics
        let of_values =
            if name.ends_with("ipg-p2") && name != "sipg-p2" { 2.0 } else { expected + 1.0 };
        assert!(order(2) > of_values - 0.2, "{name} in {D}: L2 {:?}", order(2));
    }
}

#[test]
fn schemes_have_their_orders_beside_a_robin_side() {
    let linears = ["p1", "cr", "sipg", "nipg", "iipg", "wopsip", "ldg", "br2", "bmmpr"];
    let linears = linears.map(|name| (name, 1.0));
    has_its_orders::<1>([16, 32], &[("p1", 1.0), ("wopsip", 1.0), ("p2", 2.0)]);
    has_its_orders::<2>([8, 16], &linears);
    has_its_orders::<2>([8, 16], &[("p2", 2.0), ("sipg-p2", 2.0), ("wopsip:facet-means", 1.0)]);
    has_its_orders::<3>([4, 8], &[("p1", 1.0), ("sipg", 1.0), ("wopsip", 1.0), ("cr", 1.0)]);
}

/// A wall in the line whose solution is linear: `u' = k_0 (u - g_0)` at the left end, `u' = -k_1 (u - g_1)` at the right one.
#[test]
fn a_wall_between_two_fluids_has_its_linear_profile_under_every_constant() {
    let (k, g) = ([2.0, 0.5], [10.0, 40.0]);
    let resistance = 1.0 / k[0] + 1.0 + 1.0 / k[1];
    let flow = (g[1] - g[0]) / resistance;
    for constant in [0.0, 273.15, 1e6] {
        let problem = Problem::<1>::new().robin_on("left", k[0], g[0] + constant).robin_on(
            "right",
            k[1],
            g[1] + constant,
        );
        let mesh = mesh(&problem, 8, true);
        let cold = g[0] + flow / k[0];
        for name in ["p1", "sipg", "p2", "cr"] {
            let solved = solve(&problem, &mesh, &*scheme::<1>(name)).unwrap();
            assert!(solved.converged(), "{name} {constant}");
            let at = |x: f64| ValueOf::At(Point::from([x]));
            let wanted = [
                at(0.0),
                at(1.0),
                ValueOf::Reaction("left".to_owned()),
                ValueOf::Reaction("right".to_owned()),
            ];
            let found = solved.values_of(&wanted).unwrap();
            let expected = [cold + constant, cold + flow + constant, -flow, flow];
            for (found, expected) in found.iter().zip(expected) {
                let error = (found.value.unwrap() - expected).abs();
                assert!(error < 1e-9 + 1e-15 * constant, "{name} {constant}: {error}");
            }
        }
    }
}

/// Without coefficient it is a Neumann side, with a large one the values are held.
#[test]
fn its_limits_are_the_neumann_and_the_dirichlet_side() {
    let loaded = || Problem::<2>::new().constant_source(1.0);
    for name in ["p1", "sipg", "wopsip", "cr", "p2"] {
        let value = |problem: Problem<2>, is_held: bool| {
            let mut unit = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
            if !is_held {
                unit = unit.side(0, 1, BoundaryCondition::Neumann);
            }
            let mesh = problem.bind_boundary(Mesh::kuhn_box(&unit, [8; 2]).unwrap()).unwrap();
            let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            solved.energy().unwrap().unwrap()
        };
        let none = value(loaded().robin_on("right", 0.0, 5.0), false);
        let free = value(loaded().neumann_on("right", |_, _| 0.0), false);
        assert!((none - free).abs() < 1e-13, "{name}: {none} {free}");
        if ["p1", "p2"].contains(&name) {
            let large = value(loaded().robin_on("right", 1e9, 0.0), false);
            let held = value(loaded().dirichlet_on("right", 0.0), true);
            assert!((large - held).abs() < 1e-8, "{name}: {large} {held}");
        }
    }
}

/// Loads, sides, reactions and contact forces add up to zero.
#[test]
fn forces_balance_beside_a_robin_side_under_an_obstacle() {
    for name in ["p1", "cr", "sipg", "nipg", "wopsip", "wopsip:facet-means", "br2", "p2", "sipg-p2"]
    {
        let problem = Problem::<2>::new()
            .constant_source(-3.0)
            .reaction(2.0)
            .obstacle_below(|_| -0.05)
            .dirichlet_on("left", |x: &Point<2>| 0.1 * x[1])
            .robin_on("right", |x: &Point<2>| 1.0 + x[1], 0.3)
            .neumann_on("top", |_, _| 0.2);
        let mut unit = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
        unit = unit.side(0, 1, BoundaryCondition::Neumann).side(1, 1, BoundaryCondition::Neumann);
        let mesh = problem.bind_boundary(Mesh::kuhn_box(&unit, [8; 2]).unwrap()).unwrap();
        let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
        assert!(solved.converged(), "{name}");
        let all = || "default".to_owned();
        let found = solved.values_of(&[ValueOf::Mean(all()), ValueOf::Reaction(all())]).unwrap();
        let [mean, reactions] = [0, 1].map(|k| found[k].value.unwrap());
        let pressed = solved.resultant().unwrap();
        assert!(pressed > 0.5, "{name}: {pressed}");
        let sum = -3.0 + 0.2 - 2.0 * mean + reactions + pressed;
        assert!(sum.abs() < 1e-8, "{name}: {sum}");
    }
}

fn bound(problem: &Problem<2>, n: usize, name: &str) -> (ErrorBound, [f64; 2]) {
    let mesh = mesh(problem, n, false);
    let solved = solve(problem, &mesh, &*scheme::<2>(name)).unwrap();
    assert!(solved.converged(), "{name}");
    let errors = solved.errors().unwrap();
    (solved.bound().unwrap(), [errors.h1, errors.energy].map(Option::unwrap))
}

/// The bound holds from a side that is nearly free to one that is nearly held, and stays sharp.
#[test]
fn bounds_hold_and_are_sharp_for_small_and_large_coefficients() {
    for name in ["p1", "cr", "sipg", "wopsip", "p2", "sipg-p2"] {
        for k in [1e-3, 1.0, 1e3, 1e6] {
            // u = x^2 + x y + 1 with -Laplace u = -2
            let problem = Problem::<2>::new()
                .constant_source(-2.0)
                .exact(
                    |x| x[0] * x[0] + x[0] * x[1] + 1.0,
                    |x| Point::from([2.0 * x[0] + x[1], x[0]]),
                )
                .robin_on(
                    "right",
                    k,
                    Datum::polynomial(1, move |x: &Point<2>| 2.0 + x[1] + (2.0 + x[1]) / k),
                )
                .polynomial_data(2);
            let (bound, [broken, energy]) = bound(&problem, 16, name);
            if problem_is_exact(name) {
                assert!(bound.discrete < 1e-6, "{name} {k}: {}", bound.discrete);
                continue;
            }
            assert!(bound.discrete > broken, "{name} {k}: {} {broken}", bound.discrete);
            assert!(bound.discrete < 2.0 * energy, "{name} {k}: {} {energy}", bound.discrete);
        }
    }
}

fn problem_is_exact(name: &str) -> bool {
    name.contains("p2")
}

#[test]
fn a_bound_with_linear_data_is_guaranteed() {
    for name in ["p1", "sipg", "wopsip", "cr"] {
        for k in [0.1, 100.0] {
            let problem = Problem::<2>::new().constant_source(1.0).robin_on(
                "right",
                k,
                Datum::polynomial(2, |x: &Point<2>| x[1] * (1.0 - x[1])),
            );
            let (coarse, fine) = (mesh(&problem, 8, false), mesh(&problem, 32, false));
            let solved = solve(&problem, &coarse, &*scheme::<2>(name)).unwrap();
            let bound = solved.bound().unwrap();
            assert!(bound.is_guaranteed(), "{name} {k}: {:?}", bound.unproven);
            // against quadratics on a finer mesh, whose energy lies above the least one
            let fine = solve(&problem, &fine, &*scheme::<2>("p2")).unwrap();
            let energy = |of: &Solved<'_, 2>| of.energy().unwrap().unwrap();
            if name == "p1" {
                let error = (2.0 * (energy(&solved) - energy(&fine))).sqrt();
                assert!(bound.discrete > error, "{k}: {} {error}", bound.discrete);
                assert!(bound.discrete < 1.6 * error, "{k}: {} {error}", bound.discrete);
            }
        }
    }
}

/// A bound needs no Dirichlet side to be near the error.
#[test]
fn a_body_that_only_robin_sides_hold_has_a_solution_and_a_bound() {
    let value = |x: &Point<2>| x[0] * (1.0 - x[0]) + 1.0;
    let problem = Problem::<2>::new()
        .constant_source(2.0)
        .exact(value, |x| Point::from([1.0 - 2.0 * x[0], 0.0]))
        .robin_on("left", 1.0, 0.0)
        .robin_on("right", 1.0, 0.0)
        .neumann_on("top", |_, _| 0.0)
        .neumann_on("bottom", |_, _| 0.0);
    let mesh = mesh(&problem, 8, true);
    for name in ["p1", "cr", "sipg", "wopsip"] {
        let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
        assert!(solved.converged(), "{name}");
        let (bound, errors) = (solved.bound().unwrap().discrete, solved.errors().unwrap());
        // the energy norm of WOPSIP has its jumps
        let [broken, energy] = [errors.h1, errors.energy].map(Option::unwrap);
        assert!(bound > broken && bound < 2.0 * energy, "{name}: {bound} {broken} {energy}");
    }
}

/// A value far away behind a small coefficient is a flux: it costs no digits.
#[test]
fn a_small_coefficient_with_a_large_value_is_a_flux() {
    let energy = |problem: Problem<2>| {
        let mesh = mesh(&problem, 8, true);
        let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.converged());
        solved.energy().unwrap().unwrap()
    };
    let body = || Problem::<2>::new().reaction(1.0);
    let by_flux = energy(body().neumann_on("right", |_, _| 1.0));
    for k in [1e-6, 1e-9, 1e-12] {
        let by_side = energy(body().robin_on("right", k, 1.0 / k));
        assert!((by_side - by_flux).abs() < 2.0 * k + 1e-12, "{k}: {by_side} {by_flux}");
    }
}

#[test]
fn bad_data_of_a_robin_side_are_refused() {
    let refuse = |problem: Problem<2>| {
        let mesh = mesh(&problem, 2, false);
        solve(&problem, &mesh, &Sipg::default()).map(|_| ()).unwrap_err().to_string()
    };
    let negative = refuse(Problem::new().robin_on("right", |x: &Point<2>| x[1] - 0.5, 0.0));
    assert!(negative.contains("coefficient of the Robin side is -"), "{negative}");
    assert!(negative.contains("in cell") && negative.contains("not be negative"), "{negative}");
    let infinite = refuse(Problem::new().robin_on("right", 1.0, f64::INFINITY));
    assert!(infinite.contains("robin is inf"), "{infinite}");
    let both = refuse(Problem::new().robin_on("right", 1.0, 0.0).neumann_on("right", |_, _| 0.0));
    assert!(both.contains("right") && both.contains("two of a flux, Robin data"), "{both}");
}
