//! Simplified friction: closed solutions with stick and slip, orders, counts of systems, bounds, and what is refused.

use std::path::Path;

use unilateral::algebra::Contact;
use unilateral::inequality::{Outcome, solver_by_name};
use unilateral::linear::LinearMethod;
use unilateral::mesh::gmsh;
use unilateral::prelude::*;
use unilateral::problem::ValueOf;
use unilateral::real::{Point, Precision};

const LINEARS: [&str; 9] = ["p1", "cr", "sipg", "nipg", "iipg", "wopsip", "ldg", "br2", "bmmpr"];

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    name.parse::<NamedScheme>().unwrap().make()
}

/// A problem with the constraint set that a name has behind its scheme.
fn placed<const D: usize>(mut problem: Problem<D>, name: &str) -> Problem<D> {
    problem.constraint_set = name.parse::<NamedScheme>().unwrap().constraint_set();
    problem
}

/// A box with friction at the lower end of the last axis, its other sides held.
fn on_floor<const D: usize>(problem: &Problem<D>, n: usize) -> Mesh<D> {
    let mut low = Point::repeat(-1.0);
    low[D - 1] = 0.0;
    let mut unit = BoxDomain::<D>::dirichlet(low, Point::repeat(1.0));
    unit = unit.side(D - 1, 0, BoundaryCondition::Neumann);
    let mut counts = [2 * n; D];
    counts[D - 1] = n;
    problem.bind_boundary(Mesh::kuhn_box(&unit, counts).unwrap()).unwrap()
}

/// `u = sign (g y + c r^(3/2) cos(3 theta / 2))` sticks for `x < 0` and slips for `x > 0`, `theta` the angle at the origin of
/// the plane of the first and the last coordinate.
fn stick_slip<const D: usize>(sign: f64) -> Problem<D> {
    let (g, c) = (1.0, 1.0);
    let polar = |x: &Point<D>| {
        let (a, b) = (x[0], x[D - 1]);
        ((a * a + b * b).sqrt(), b.atan2(a))
    };
    let value = move |x: &Point<D>| {
        let (r, theta) = polar(x);
        sign * (g * x[D - 1] + c * r.powf(1.5) * (1.5 * theta).cos())
    };
    let gradient = move |x: &Point<D>| {
        let (r, theta) = polar(x);
        let mut slope = Point::<D>::zeros();
        slope[0] = sign * c * 1.5 * r.sqrt() * (0.5 * theta).cos();
        slope[D - 1] = sign * (g - c * 1.5 * r.sqrt() * (0.5 * theta).sin());
        slope
    };
    let floor = ["left", "bottom", "back"][D - 1];
    Problem::new().exact(value, gradient).friction_on(floor, g)
}

/// The errors in H1 on two levels, with counts of systems and bounds that stay level.
fn has_its_orders<const D: usize>(levels: [usize; 2], names: &[&str]) {
    for name in names {
        for sign in [1.0, -1.0] {
            let problem = placed(stick_slip::<D>(sign), name);
            let errors = levels.map(|n| {
                let mesh = on_floor(&problem, n);
                let solved = solve(&problem, &mesh, &*scheme::<D>(name)).unwrap();
                assert!(solved.converged(), "{name} at {n}: {:?}", solved.certificate());
                assert!(solved.solution().systems.unwrap() <= 8, "{name} at {n}");
                let error = solved.errors().unwrap().broken_energy.unwrap();
                let quotient = solved.bound().unwrap().discrete / error;
                let most = match solved.discretisation().degree() {
                    1 => 2.0,
                    _ if name.ends_with(":bernstein") => 7.5,
                    _ => 2.5,
                };
                assert!((0.99..most).contains(&quotient), "{name} at {n}: {quotient}");
                error
            });
            let (order, expected) = ((errors[0] / errors[1]).log2(), 0.85);
            assert!(order > expected, "{name} in {D}: {order}");
        }
    }
}

#[test]
fn schemes_have_their_orders_at_a_point_of_stick_and_slip() {
    has_its_orders::<2>([8, 16], &LINEARS);
    has_its_orders::<2>([16, 32], &["wopsip:facet-means", "p2", "p2:bernstein", "sipg-p2"]);
    has_its_orders::<3>([4, 8], &["p1", "cr", "sipg", "wopsip"]);
}

/// Counts of systems stay level under refinement, from a cold start and on nested meshes.
#[test]
fn counts_of_systems_stay_level() {
    let problem = stick_slip::<2>(-1.0);
    for name in ["p1", "sipg", "wopsip"] {
        for n in [8, 32, 64] {
            let mesh = on_floor(&problem, n);
            for is_cold in [false, true] {
                let mut nested = NestedIteration::new(&problem, &mesh).cold_start(is_cold);
                let solved = nested.solve(&*scheme::<2>(name)).unwrap();
                assert!(solved.converged(), "{name} at {n}");
                let systems = solved.solution().systems.unwrap();
                assert!(systems <= 12, "{name} at {n}, cold {is_cold}: {systems}");
            }
        }
    }
}

/// Every solver of inequalities finds the solution; forces balance the load.
#[test]
fn every_solver_finds_stick_and_slip() {
    let problem = Problem::<2>::new()
        .constant_source(2.0)
        .friction_on("left", 2.0)
        .friction_on("right", 0.5)
        .neumann_on("top", |_, _| 0.0)
        .neumann_on("bottom", |_, _| 0.0);
    let mut square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    for (axis, end) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        square = square.side(axis, end, BoundaryCondition::Neumann);
    }
    let mesh = problem.bind_boundary(Mesh::kuhn_box(&square, [6, 6]).unwrap()).unwrap();
    for solver in ["active-set", "interior-point", "monotone-multigrid", "proximal"] {
        for name in ["p1", "sipg", "wopsip", "cr", "p2"] {
            let method = solver_by_name(solver, LinearMethod::default(), Precision::Double);
            let mut nested =
                NestedIteration::new(&problem, &mesh).shared_solver(method.unwrap().into());
            let solved = nested.solve(&*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{solver} {name}: {:?}", solved.outcome());
            let force = |group: &str| ValueOf::Force(group.to_owned());
            let found = solved.values_of(&[force("left"), force("right")]).unwrap();
            let [left, right] = [0, 1].map(|k| found[k].value.unwrap());
            assert!(
                (left + 1.5).abs() < 1e-6 && (right + 0.5).abs() < 1e-6,
                "{name}: {left} {right}"
            );
            let resultants = solved.resultants().unwrap();
            assert!((resultants["left"] - left).abs() < 1e-12, "{resultants:?}");
            assert!((solved.resultant().unwrap() + 2.0).abs() < 1e-6, "{solver} {name}");
        }
    }
}

/// A constant in the data moves the place of the kinks.
#[test]
fn friction_counts_from_zero_where_data_have_a_constant() {
    // u = 300 at the left end is dragged down by the load and held at zero at the right end
    let solved_by = |load: f64, threshold: f64| {
        let line = BoxDomain::<1>::dirichlet(Point::from([0.0]), Point::from([1.0])).side(
            0,
            1,
            BoundaryCondition::Neumann,
        );
        let problem = Problem::<1>::new()
            .constant_source(load)
            .dirichlet_on("left", 300.0)
            .friction_on("right", threshold);
        let mesh = problem.bind_boundary(Mesh::kuhn_box(&line, [8]).unwrap()).unwrap();
        let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.converged());
        (solved.value_at(&Point::from([1.0])).unwrap(), solved.active())
    };
    // -u'' = 0, u(0) = 300: u' = -300 reaches zero; with a smaller threshold it slips at u = 300 - g
    let (value, active) = solved_by(0.0, 1e3);
    assert!(value.abs() < 1e-9 && active == Some(1), "{value}");
    let (value, active) = solved_by(0.0, 100.0);
    assert!((value - 200.0).abs() < 1e-9 && active == Some(0), "{value}");
}

/// `-u'' = 2 q` on the line, held by friction alone: the left end sticks, the right one slips.
#[test]
fn a_string_held_by_friction_alone_sticks_at_one_end_and_slips_at_the_other() {
    let (q, g) = (1.0, [2.0, 0.5]);
    let c = 2.0 * q - g[1];
    for sign in [1.0, -1.0] {
        let problem = Problem::<1>::new()
            .constant_source(sign * 2.0 * q)
            .exact(
                move |x| sign * (c * x[0] - q * x[0] * x[0]),
                move |x| Point::from([sign * (c - 2.0 * q * x[0])]),
            )
            .friction_on("left", g[0])
            .friction_on("right", g[1]);
        let line = BoxDomain::<1>::dirichlet(Point::from([0.0]), Point::from([1.0]))
            .side(0, 0, BoundaryCondition::Neumann)
            .side(0, 1, BoundaryCondition::Neumann);
        let mesh = problem.bind_boundary(Mesh::kuhn_box(&line, [8]).unwrap()).unwrap();
        for name in ["p1", "p2", "sipg", "cr", "wopsip"] {
            let solved = solve(&problem, &mesh, &*scheme::<1>(name)).unwrap();
            assert!(solved.converged(), "{name}: {:?}", solved.outcome());
            assert_eq!(solved.active(), Some(1), "{name}: one end sticks");
            let error = solved.errors().unwrap().max.unwrap();
            assert!(error < if name == "wopsip" { 0.1 } else { 1e-9 }, "{name}: {error}");
        }
    }
}

/// Slip in both signs on one line, with a reaction: `u = x - 2 x^3 / 3`.
#[test]
fn a_string_slips_in_both_signs() {
    let value = |x: &Point<1>| x[0] - 2.0 / 3.0 * x[0].powi(3);
    let problem = Problem::<1>::new()
        .source(move |x: &Point<1>| 4.0 * x[0] + value(x))
        .reaction(1.0)
        .exact(value, |x| Point::from([1.0 - 2.0 * x[0] * x[0]]))
        .friction_on("left", 1.0)
        .friction_on("right", 1.0);
    let line = BoxDomain::<1>::centred(1.0).side(0, 0, BoundaryCondition::Neumann).side(
        0,
        1,
        BoundaryCondition::Neumann,
    );
    for name in LINEARS {
        let errors = [16, 32].map(|n| {
            let mesh = problem.bind_boundary(Mesh::kuhn_box(&line, [n]).unwrap()).unwrap();
            let solved = solve(&problem, &mesh, &*scheme::<1>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            assert_eq!(solved.active(), Some(0), "{name}");
            assert!(solved.solution().contact.iter().all(|c| *c == Contact::Inactive));
            let error = solved.errors().unwrap().broken_energy.unwrap();
            let quotient = solved.bound().unwrap().discrete / error;
            assert!((0.99..1.2).contains(&quotient), "{name} at {n}: {quotient}");
            solved.errors().unwrap().h1.unwrap()
        });
        assert!((errors[0] / errors[1]).log2() > 0.9, "{name}: {errors:?}");
    }
}

/// Without a threshold it is a Neumann side, with a huge one it sticks everywhere.
#[test]
fn its_limits_are_the_neumann_and_the_dirichlet_side() {
    for name in ["p1", "sipg", "wopsip", "cr", "p2"] {
        let energy = |problem: Problem<2>| {
            let mesh = on_floor(&problem, 4);
            let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            (solved.energy().unwrap().unwrap(), solved.active())
        };
        let loaded = || Problem::<2>::new().constant_source(-1.0);
        let none = energy(loaded().friction_on("bottom", 0.0)).0;
        let free = energy(loaded().neumann_on("bottom", |_, _| 0.0)).0;
        assert!((none - free).abs() < 1e-13, "{name}: {none} {free}");
        let huge = energy(loaded().friction_on("bottom", 1e9));
        if name == "p1" {
            let problem = loaded();
            let held = BoxDomain::<2>::dirichlet(Point::from([-1.0, 0.0]), Point::repeat(1.0));
            let mesh = Mesh::kuhn_box(&held, [8, 4]).unwrap();
            let held = solve(&problem, &mesh, &ConformingP1).unwrap().energy().unwrap().unwrap();
            assert!((huge.0 - held).abs() < 1e-12, "{huge:?} {held}");
            assert_eq!(huge.1, Some(7));
        }
    }
}

/// A body held by friction alone: solvable where the resultant is below the thresholds, not at them, not above.
#[test]
fn friction_holds_a_body_up_to_its_thresholds() {
    let line = BoxDomain::<1>::dirichlet(Point::from([0.0]), Point::from([1.0]))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann);
    for (load, expected) in [
        (1.9, Outcome::Converged),
        (-1.9, Outcome::Converged),
        (2.1, Outcome::NoSolution),
        (-2.1, Outcome::NoSolution),
        (2.0, Outcome::NotUnique),
        (-2.0, Outcome::NotUnique),
    ] {
        let problem = Problem::<1>::new()
            .constant_source(load)
            .friction_on("left", 1.0)
            .friction_on("right", 1.0);
        let mesh = problem.bind_boundary(Mesh::kuhn_box(&line, [8]).unwrap()).unwrap();
        for name in ["p1", "sipg", "wopsip"] {
            let solved = solve(&problem, &mesh, &*scheme::<1>(name)).unwrap();
            assert_eq!(solved.outcome(), expected, "{name} {load}");
        }
    }
}

/// A plate from Gmsh that friction on two of its sides alone holds.
#[test]
fn friction_holds_a_plate_without_structure_up_to_its_thresholds() {
    let mesh = gmsh::read::<2>(Path::new("examples/problems/plate.msh")).unwrap().mesh;
    let problem = |load: f64| {
        Problem::<2>::new()
            .constant_source(load)
            .friction_on("ends", 1.0)
            .friction_on("bore", 0.0)
            .neumann_on("edges", |_, _| 0.0)
    };
    let measure = |of: &dyn Fn(usize) -> f64| (0..mesh.n_cells()).map(of).sum::<f64>();
    let area = measure(&|cell| mesh.geometry(cell).volume);
    let bound = problem(1.0).bind_boundary(mesh.clone()).unwrap();
    let is_end = |group: u16| bound.boundary_groups()[usize::from(group)].names == ["ends"];
    let ends = bound.boundary().iter().filter(|f| is_end(f.group));
    let length: f64 =
        ends.map(|f| bound.geometry(f.cell as usize).facet_measure(f.local.into())).sum();
    for (share, expected) in
        [(0.9, Outcome::Converged), (1.0, Outcome::NotUnique), (1.1, Outcome::NoSolution)]
    {
        for name in ["p1", "cr", "sipg", "wopsip", "p2"] {
            let load = share * length / area;
            let problem = problem(load);
            let solved = solve(&problem, &bound, &*scheme::<2>(name)).unwrap();
            assert_eq!(solved.outcome(), expected, "{name} at {share}");
            if expected == Outcome::Converged {
                let force = solved.resultants().unwrap()["ends"];
                assert!((force + load * area).abs() < 1e-8 * length, "{name}: {force}");
            }
        }
    }
}

/// One mesh from a cold start: huge and tiny thresholds, and values in kelvin.
#[test]
fn thresholds_of_any_size_are_solved() {
    for threshold in [1e-12, 1e-3, 1e3, 1e12] {
        for shift in [0.0, 273.16] {
            let problem = Problem::<2>::new()
                .constant_source(-1.0)
                .dirichlet(move |_| shift)
                .friction_on("bottom", threshold);
            let mesh = on_floor(&problem, 8);
            for name in ["p1", "sipg", "wopsip"] {
                let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
                assert!(solved.converged(), "{name} {threshold} {shift}: {:?}", solved.outcome());
                assert!(solved.solution().systems.unwrap() <= 8, "{name} {threshold} {shift}");
                // friction counts from zero in both, in the energy at the two corners that are held too
                let at_corners = threshold * shift / 8.0;
                let [objective, energy] =
                    [solved.objective().unwrap() + at_corners, solved.energy().unwrap().unwrap()];
                assert!(
                    name != "p1" || (objective - energy).abs() < 1e-8 * (1.0 + energy.abs()),
                    "{threshold} {shift}: {objective} {energy}"
                );
            }
        }
    }
}

/// A threshold that vanishes at a vertex leaves it free.
#[test]
fn a_threshold_may_vanish_at_a_vertex() {
    let problem =
        Problem::<2>::new().constant_source(2.0).friction_on("bottom", |x: &Point<2>| x[0].abs());
    let mesh = on_floor(&problem, 4);
    for name in ["p1", "p2", "sipg-p2", "p2:bernstein", "cr"] {
        let problem = placed(problem.clone(), name);
        let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
        assert!(solved.converged(), "{name}");
        let force = solved.resultants().unwrap()["bottom"];
        assert!((-1.0 - 1e-12..-0.5).contains(&force), "{name}: {force}");
        assert!(solved.bound().is_ok(), "{name}");
    }
}

/// An unknown may have an obstacle and friction: `u'' = 8` with `u(0) = 1` over an obstacle, friction of 1 at the other end.
///
/// Below zero the string lifts off the obstacle at `-1/4` where `u' = 8 (x - 7/8)`, which is 1 at the end. Above zero, at
/// `1/4`, friction presses the end onto the obstacle. The string comes down to the obstacle `psi` with `4 (a - x)^2`,
/// `4 a^2 = 1 - psi`.
#[test]
fn an_unknown_has_an_obstacle_and_friction() {
    let line = BoxDomain::<1>::dirichlet(Point::from([0.0]), Point::from([1.0]));
    let line = line.side(0, 1, BoundaryCondition::Neumann);
    for (obstacle, force, end) in [(-0.25, 1.0, -0.1875), (0.25, -1.0, 0.25)] {
        for sign in [1.0, -1.0] {
            let problem = Problem::<1>::new()
                .constant_source(-8.0 * sign)
                .dirichlet_on("left", sign)
                .friction_on("right", 1.0);
            let problem = match sign > 0.0 {
                true => problem.obstacle_below(move |_| obstacle),
                false => problem.obstacle_above(move |_| -obstacle),
            };
            let mesh = problem.bind_boundary(Mesh::kuhn_box(&line, [64]).unwrap()).unwrap();
            for name in ["p1", "cr", "sipg", "wopsip", "p2"] {
                let solved = solve(&problem, &mesh, &*scheme::<1>(name)).unwrap();
                assert!(solved.converged(), "{name} {obstacle}: {:?}", solved.certificate());
                let resultants = solved.resultants().unwrap();
                assert!((resultants["right"] - sign * force).abs() < 1e-9, "{resultants:?}");
                let touching = if obstacle < 0.0 { 0.875 } else { 1.0 };
                let a = (0.25 * (1.0 - obstacle)).sqrt();
                let expected = 8.0 * (touching - a) + if obstacle < 0.0 { 0.0 } else { 1.0 };
                let of_obstacle = resultants[if sign > 0.0 { "lower" } else { "upper" }];
                assert!((of_obstacle - sign * expected).abs() < 0.2, "{name}: {of_obstacle}");
                let found = sign * solved.value_at(&Point::from([1.0])).unwrap();
                assert!((found - end).abs() < 0.02, "{name} {obstacle}: {found}");
                let bound = solved.bound().unwrap();
                assert!(bound.total < 0.5, "{name} {obstacle}: {}", bound.total);
            }
        }
    }
}

/// Friction without a name lies on the Neumann boundary, not on a contact side beside it.
#[test]
fn friction_without_a_name_leaves_other_sides_alone() {
    let square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(1, 0, BoundaryCondition::Contact);
    let of = || Problem::<2>::new().source(|x: &Point<2>| 6.0 - 12.0 * x[0]).signorini(|_| -0.05);
    let everywhere = of().friction_on("default", |_: &Point<2>| 0.3);
    let named = of().friction_on("left", 0.3);
    for name in ["p1", "cr", "sipg", "p2"] {
        let found = [&everywhere, &named].map(|problem| {
            let mesh = problem.bind_boundary(Mesh::kuhn_box(&square, [6, 6]).unwrap()).unwrap();
            let solved = solve(problem, &mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            let forces = solved.resultants().unwrap();
            (solved.energy().unwrap().unwrap(), forces.into_values().collect::<Vec<_>>())
        });
        assert_eq!(found[0].1.len(), 2, "{name}: {:?}", found[0]);
        assert_eq!(found[0].0, found[1].0, "{name}");
    }
}

/// What friction cannot have is refused by name.
#[test]
fn what_friction_cannot_have_is_refused() {
    let refused = |problem: Problem<3>, name: &str| {
        let mesh = on_floor(&problem, 2);
        solve(&placed(problem, name), &mesh, &*scheme::<3>(name)).err().map(|e| e.to_string())
    };
    let back = || Problem::<3>::new().constant_source(1.0).friction_on("back", 1.0);
    let message = refused(back(), "p2").unwrap();
    assert!(message.contains("midpoints") && message.contains("bernstein"), "{message}");
    assert_eq!(refused(back(), "p2:bernstein"), None);
    assert_eq!(refused(back(), "p2:midpoints"), None);
    for threshold in [-1.0, f64::NAN] {
        let problem = Problem::<3>::new().friction_on("back", move |_: &Point<3>| threshold);
        let message = refused(problem, "p1").unwrap();
        assert!(message.contains("threshold of friction"), "{message}");
    }
    let message = refused(back().neumann_on("back", |_, _| 1.0), "p1").unwrap();
    assert!(message.contains("friction"), "{message}");
}
