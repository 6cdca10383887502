//! Patch tests: linear functions are reproduced by the consistent schemes, on any mesh and under
//! any data, and missed by the weakly over-penalised one by exactly as much as a closed form says.

use crate::runs::{mesh_of_folder, small_mesh, solve};
use crate::support::checks::Checks;
use crate::support::meshes::{Random, Raw, mixed_box};
use crate::support::scheme_lists::consistent_schemes;
use crate::support::schemes::wopsip;
use crate::support::tables::jump_norm;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{BoundaryCondition, Mesh};
use unilateral::prelude::*;

fn unit_box<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// On `(0, 1)` cut into `n` cells, with `u(0) = 0` and `u(1) = 1`, WOPSIP's solution has the slope
/// `s = 1 / (1 + (n + 1) h^3 / eta)` in every cell and the jump `s h^3 / eta` at every vertex:
/// the flux `s` through a vertex is what its penalty `eta h^-3` exerts, and slopes and jumps add
/// up to one.
#[test]
fn wopsip_misses_a_line_by_the_closed_form() {
    let mut checks = Checks::default();
    let known = 1.0 / (1.0 + 9.0 / 512.0);
    checks.close("slope for n = 8, eta = 1", known, 0.982_725_527_831_094, 1e-15);
    checks.close("jump for n = 8, eta = 1", known / 512.0, 1.919_385_796_5e-3, 5e-14);
    let cases = [
        (1, 1.0),
        (2, 0.1),
        (3, 1e-2),
        (5, 7.0),
        (8, 1e-2),
        (8, 1.0),
        (8, 50.0),
        (16, 1e-3),
        (16, 1.0),
        (32, 1e-2),
        (33, 0.3),
    ];
    for (n, eta) in cases {
        let h = 1.0 / n as f64;
        let slope = 1.0 / (1.0 + (n as f64 + 1.0) * h.powi(3) / eta);
        let jump = slope * h.powi(3) / eta;
        let mesh = Mesh::<1>::kuhn_box(&unit_box(), [n]).unwrap();
        let problem = Problem::new().exact(|x| x[0], |_| Point::repeat(1.0));
        let u = solve(&wopsip(eta), &problem, &mesh).fields.unwrap().u;
        let mut before = 0.0;
        for (cell, ends) in u.chunks(2).enumerate() {
            let what = |name: &str| format!("n = {n}, eta = {eta}, {name} of cell {cell}");
            checks.close(&what("slope"), (ends[1] - ends[0]) / h, slope, 1e-12 / h);
            checks.close(&what("jump"), ends[0] - before, jump, 1e-12);
            before = ends[1];
        }
        checks.close(&format!("n = {n}, eta = {eta}, last jump"), 1.0 - before, jump, 1e-12);
    }
    checks.finish();
}

/// The error on `x + 2y` in two dimensions, eta = 1: of second order inside the cells, of first
/// order in the jumps.
#[test]
fn wopsip_misses_a_plane_as_an_independent_implementation_does() {
    let cases = [
        (4, "0.23372", "0.62795"),
        (8, "0.064113", "0.33268"),
        (16, "0.016290", "0.16742"),
        (32, "0.0040641", "0.083399"),
    ];
    let mut checks = Checks::default();
    for (n, h1, jump) in cases {
        let mesh = Mesh::<2>::kuhn_box(&unit_box(), [n, n]).unwrap();
        let problem = Problem::new().exact(|x| x[0] + 2.0 * x[1], |_| Point::<2>::new(1.0, 2.0));
        let error = solve(&wopsip(1.0), &problem, &mesh).error;
        let [ours, energy] = [error.h1.unwrap(), error.energy.unwrap()];
        checks.printed(&format!("n = {n}, H1"), ours, h1, 0.5);
        checks.printed(&format!("n = {n}, jump"), jump_norm(energy, ours), jump, 0.5);
    }
    checks.finish();
}

/// The slope of the linear function `8 + x - 2y`, `8 + x - 2y - 3z` or `8 - x`: it falls along
/// every axis but the first, so that it presses on a contact boundary at the lower end of one.
fn slope<const D: usize>() -> Point<D> {
    Point::from_fn(|k, _| if k == 0 && D > 1 { 1.0 } else { -(k as f64 + 1.0) })
}

fn linear<const D: usize>(x: &Point<D>) -> f64 {
    8.0 + slope::<D>().dot(x)
}

/// Problems that a linear function solves.
fn linear_problems<const D: usize>() -> Vec<(&'static str, Problem<D>)> {
    let poisson = || Problem::new().exact(linear, |_| slope());
    vec![
        ("boundary data", poisson()),
        ("coefficient", poisson().coefficient(|_| 5.0)),
        ("reaction", poisson().reaction(3.0).source(|x| 3.0 * linear(x))),
        ("varying reaction", {
            let c = |x: &Point<D>| x.norm_squared();
            let f = move |x: &Point<D>| c(x) * linear(x);
            poisson().source(f).reaction(c)
        }),
        ("obstacle in contact", poisson().constant_source(-1.0).obstacle_below(linear)),
        ("obstacle below", poisson().obstacle_below(|x| linear(x) - 1.0)),
        ("two obstacles", {
            poisson()
                .constant_source(4.0)
                .obstacle_below(|x| linear(x) - 1.0)
                .obstacle_above(linear)
        }),
    ]
}

/// Asserts that every consistent scheme reproduces the exact solution, up to this.
fn reproduces<const D: usize>(
    checks: &mut Checks,
    on: &str,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    tolerance: f64,
) {
    for scheme in consistent_schemes() {
        let solved = solve(&*scheme, &scheme.constrain(problem), mesh);
        let [value, gradient] = [solved.error.max, solved.error.h1].map(|e| e.unwrap_or(f64::NAN));
        let what = format!("{} ({}) on {on}", scheme.name(), scheme.constraint());
        checks.that(value <= tolerance && gradient <= tolerance / mesh.mesh_size(), || {
            format!("{what}: {}, error {value:.2e}, of gradient {gradient:.2e}", solved.outcome)
        });
    }
}

/// All linear problems on a mesh. Where it has a contact boundary, the gap is the solution itself.
fn all_linear<const D: usize>(checks: &mut Checks, on: &str, mesh: &Mesh<D>, tolerance: f64) {
    for (name, problem) in linear_problems() {
        let problem = if mesh.has_condition(BoundaryCondition::Contact) {
            problem.signorini(linear)
        } else {
            problem
        };
        reproduces(checks, &format!("{on}, {name}"), &problem, mesh, tolerance);
    }
}

fn on_boxes<const D: usize>(n: usize) {
    let mut checks = Checks::default();
    let mut random = Random(17);
    for (name, domain) in [("box", unit_box()), ("box with mixed conditions", mixed_box::<D>())] {
        let counts = std::array::from_fn(|k| n + k);
        all_linear(&mut checks, name, &Mesh::kuhn_box(&domain, counts).unwrap(), 1e-12);
        let moved = Raw::jittered(&domain, n, 0.4, &mut random).shuffled(&mut random);
        all_linear(&mut checks, &format!("{name}, moved"), &moved.mesh(), 1e-12);
    }
    checks.finish();
}

#[test]
fn linears_are_exact_on_intervals() {
    on_boxes::<1>(12);
}

#[test]
fn linears_are_exact_on_squares() {
    on_boxes::<2>(7);
}

#[test]
fn linears_are_exact_on_cubes() {
    on_boxes::<3>(3);
}

#[test]
fn linears_are_exact_on_small_gmsh_meshes() {
    let mut checks = Checks::default();
    all_linear(&mut checks, "plate.msh", &small_mesh::<2>("plate.msh"), 1e-12);
    all_linear(&mut checks, "cube.msh", &small_mesh::<3>("cube.msh"), 1e-12);
    let refined = small_mesh::<3>("cube.msh").refine().unwrap().0;
    all_linear(&mut checks, "cube.msh, refined", &refined, 1e-12);
    for name in ["unstructured_square.msh", "unstructured_half_square.msh"] {
        all_linear(&mut checks, name, &small_mesh::<2>(name), 1e-11);
    }
    for name in ["unstructured_cube.msh", "unstructured_half_cube.msh"] {
        all_linear(&mut checks, name, &small_mesh::<3>(name), 1e-11);
    }
    checks.finish();
}

mod needs_meshes {
    use super::*;

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn linears_are_exact_on_gmsh_meshes() {
        fn on<const D: usize>(checks: &mut Checks, name: &str) {
            let mesh = mesh_of_folder::<D>(name);
            // the first three: boundary data, coefficient, reaction
            for (what, problem) in linear_problems().into_iter().take(3) {
                let contact = mesh.has_condition(BoundaryCondition::Contact);
                let problem = if contact { problem.signorini(linear) } else { problem };
                reproduces(checks, &format!("{name}, {what}"), &problem, &mesh, 1e-11);
            }
        }
        let mut checks = Checks::default();
        for name in ["disc.msh", "half_square_graded.msh", "plate_with_holes.msh", "lshape.msh"] {
            on::<2>(&mut checks, name);
        }
        for name in ["ball.msh", "block.msh"] {
            on::<3>(&mut checks, name);
        }
        checks.finish();
    }
}

/// A gap that stays open: the contact boundary is then a Neumann boundary without flux.
#[test]
fn linears_are_exact_above_an_open_gap() {
    fn on<const D: usize>(checks: &mut Checks, name: &str, mesh: &Mesh<D>) {
        let along = |x: &Point<D>| x[0];
        let direction = |_: &Point<D>| Point::from_fn(|k, _| f64::from(u8::from(k == 0)));
        let problem = Problem::new().exact(along, direction).signorini(move |x| along(x) - 0.01);
        reproduces(checks, name, &problem, mesh, 1e-12);
    }
    let mut checks = Checks::default();
    on(&mut checks, "square", &Mesh::kuhn_box(&mixed_box::<2>(), [5, 4]).unwrap());
    on(&mut checks, "cube", &Mesh::kuhn_box(&mixed_box::<3>(), [3, 3, 2]).unwrap());
    on(&mut checks, "plate.msh", &small_mesh::<2>("plate.msh"));
    on(&mut checks, "cube.msh", &small_mesh::<3>("cube.msh"));
    checks.finish();
}

/// A Dirichlet value and a bound that are equal but for rounding: `sin(pi x)` at one is not zero.
#[test]
fn data_equal_but_for_rounding_do_not_contradict() {
    let sine = |x: &Point<1>| (std::f64::consts::PI * x[0]).sin();
    let mesh = Mesh::<1>::kuhn_box(&unit_box(), [4]).unwrap();
    let problem = Problem::new().dirichlet(|_| 0.0).obstacle_below(sine);
    let solved = solve(&ConformingP1, &problem, &mesh);
    assert_eq!(solved.outcome.name(), "converged");
}

/// The same of a gap and an obstacle from above.
#[test]
fn bounds_equal_but_for_rounding_do_not_contradict() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [3, 3]).unwrap();
    let problem = Problem::new().obstacle_above(|x| x[1]).signorini(|_| 1e-19);
    let solved = solve(&ConformingP1, &problem, &mesh);
    assert_eq!(solved.outcome.name(), "converged");
}

/// The coefficient jumps across `x = 1/2`, a union of facets; the solution is linear on either
/// side, its flux through the interface is continuous, its slope along it is the same.
fn layered<const D: usize>(contrast: f64) -> Problem<D> {
    let alpha = move |x: &Point<D>| if x[0] < 0.5 { 1.0 } else { contrast };
    let across = move |x: &Point<D>| 1.0 / alpha(x);
    let value = move |x: &Point<D>| {
        let rest: f64 = (1..D).map(|k| 1.0 - k as f64 * x[k]).sum();
        (x[0] - 0.5) * across(x) + rest
    };
    let gradient =
        move |x: &Point<D>| Point::from_fn(|k, _| if k == 0 { across(x) } else { -(k as f64) });
    Problem::new().coefficient(alpha).exact(value, gradient).signorini(value)
}

#[test]
fn layers_of_different_coefficient_are_exact() {
    fn on<const D: usize>(checks: &mut Checks, name: &str, mesh: &Mesh<D>) {
        for contrast in [1e-4, 0.2, 7.0, 1e4] {
            // conditioning grows with the contrast, the solution with its reciprocal
            let spread = f64::max(contrast, 1.0 / contrast);
            let what = format!("{name}, contrast {contrast}");
            reproduces(checks, &what, &layered(contrast), mesh, 1e-13 * spread.max(10.0));
        }
    }
    let mut checks = Checks::default();
    on(&mut checks, "interval", &Mesh::kuhn_box(&mixed_box::<1>(), [6]).unwrap());
    on(&mut checks, "square", &Mesh::kuhn_box(&mixed_box::<2>(), [6, 5]).unwrap());
    on(&mut checks, "cube", &Mesh::kuhn_box(&mixed_box::<3>(), [4, 3, 3]).unwrap());
    on(&mut checks, "plate.msh", &small_mesh::<2>("plate.msh"));
    checks.finish();
}
