//! Guaranteed bounds on the error of quadratics: fluxes, effectivity, orders, perturbed pairs.

use crate::error_bounds::{bounded, change_flux, mismatch_of_sides, on_boundary, placed, ratio};
use crate::runs::{own_scene, small_mesh};
use crate::support::checks::Checks;
use crate::support::meshes::Random;
use unilateral::error_bound::{Flux, Unproven};
use unilateral::mesh::Neighbours;
use unilateral::prelude::*;
use unilateral::problem::Exact;
use unilateral::scenes::Scene;

/// Every scheme on quadratics, placements and variants of forms with lifts among them.
const SCHEMES: &str = "p2 p2:midpoints sipg-p2 nipg-p2 iipg-p2 ldg-p2 br2-p2 bmmpr-p2 wopsip-p2 \
    wopsip-p2:midpoints p2:bernstein sipg-p2:bernstein wopsip-p2:bernstein";

/// On a mesh of a scene, every scheme: fluxes are single-valued and balance the load, and the bound is one to
/// three times the error.
fn check<const D: usize>(scene: Scene<D>, mesh: &Mesh<D>, schemes: &str) {
    let mut checks = Checks::default();
    for name in schemes.split_whitespace() {
        let (scene, scheme) = placed(&scene, name);
        let label = format!("{}, {name}", scene.name);
        let (pair, bound, error) = bounded(&scene, mesh, &*scheme);
        let sides = mismatch_of_sides(mesh, &pair.flux);
        checks.that(sides < 1e-12, || format!("{label}: sides differ by {sides:.1e}"));
        let terms = bound.terms;
        checks.that(terms.algebra.abs() < 1e-5, || format!("{label}: {:.1e}", terms.algebra));
        let effectivity = bound.total / error;
        println!("{label}: effectivity {effectivity:.3}, {terms:?}");
        checks.that((1.0..3.0).contains(&effectivity), || format!("{label}: {effectivity}"));
    }
    checks.finish();
}

/// The same on the mesh of a level.
fn check_level<const D: usize>(scene: Scene<D>, level: usize, schemes: &str) {
    let mesh = scene.domain.mesh(level).unwrap();
    check(scene, &mesh, schemes);
}

#[test]
fn quadratics_under_obstacles() {
    check_level(scenes::radial::<2>(1.0), 16, SCHEMES);
    let on_the_line: Vec<&str> =
        SCHEMES.split_whitespace().filter(|s| !s.contains("cell")).collect();
    check_level(scenes::radial::<1>(1.0), 32, &on_the_line.join(" "));
}

#[test]
fn quadratics_under_signorini_conditions() {
    check_level(
        scenes::signorini_harmonic::<2>(),
        16,
        "p2 sipg-p2 nipg-p2 ldg-p2 br2-p2 wopsip-p2",
    );
    let half = small_mesh::<2>("unstructured_half_square.msh");
    check(scenes::signorini_harmonic::<2>(), &half, "p2 sipg-p2 br2-p2 wopsip-p2");
}

#[test]
fn quadratics_in_space_and_on_unstructured_meshes() {
    let few = "p2 sipg-p2 br2-p2 wopsip-p2";
    check_level(scenes::radial::<3>(1.0), 4, few);
    check_level(scenes::signorini_harmonic::<3>(), 2, few);
    let square = small_mesh::<2>("unstructured_square.msh");
    check(scenes::radial::<2>(1.0), &square, SCHEMES);
    let cube = small_mesh::<3>("unstructured_cube.msh");
    check(scenes::radial::<3>(1.0), &cube, "p2 sipg-p2 wopsip-p2");
}

#[test]
fn quadratics_with_a_reaction_and_two_obstacles() {
    check_level(scenes::signorini_reaction_1d(), 16, "p2 sipg-p2 ldg-p2 wopsip-p2");
    check_level(scenes::bilateral_1d(), 32, "p2 sipg-p2 nipg-p2 wopsip-p2");
}

/// An equation with a coefficient, a reaction and Neumann data on one side: `u = exp(x) cos(y)`.
fn equation() -> Scene<2> {
    let value = |x: &Point<2>| x[0].exp() * x[1].cos();
    let gradient =
        |x: &Point<2>| Point::<2>::new(x[0].exp() * x[1].cos(), -x[0].exp() * x[1].sin());
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let problem = Problem::new()
        .coefficient(|x: &Point<2>| 1.0 + 0.5 * x[0])
        .reaction(1.0)
        .source(move |x| 0.5 * value(x))
        .dirichlet(value)
        .solved_by(Exact::new(value, gradient));
    own_scene("equation", square.side(0, 1, BoundaryCondition::Neumann), problem)
}

/// The bound of smooth solutions has order two, that under an obstacle three halves.
#[test]
fn orders_of_the_bound() {
    let mut checks = Checks::default();
    for name in SCHEMES.split_whitespace().filter(|name| !name.contains(':')) {
        for (scene, order) in [(equation(), 2.0), (scenes::radial::<2>(1.0), 1.5)] {
            let (scene, scheme) = placed(&scene, name);
            let totals = [8, 16, 32].map(|n| {
                let mesh = scene.domain.mesh(n).unwrap();
                let (_, bound, error) = bounded(&scene, &mesh, &*scheme);
                let effectivity = bound.total / error;
                checks.that((1.0..3.0).contains(&effectivity), || {
                    format!("{}, {name}, {n}: {effectivity}", scene.name)
                });
                bound.total
            });
            let measured = (totals[0] / totals[2]).log2() / 2.0;
            println!("{}, {name}: order {measured:.2}", scene.name);
            checks.that((measured - order).abs() < 0.25, || format!("{name}: {measured:.2}"));
        }
    }
    checks.finish();
}

/// Random admissible functions and fluxes give bounds: ten for each scheme.
fn random_pairs<const D: usize>(scene: &Scene<D>, level: usize, schemes: &str) {
    let mesh = scene.domain.mesh(level).unwrap();
    let neighbours = Neighbours::new(&mesh);
    let (n, n_vertices) = (D + 1, mesh.vertices().len());
    let on_boundary = on_boundary(&mesh);
    let ends = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];
    let (mut random, mut least) = (Random(level as u64), f64::INFINITY);
    for name in schemes.split_whitespace() {
        let (scene, scheme) = placed(scene, name);
        let solved = solve(&scene.problem, &mesh, &*scheme).unwrap();
        let exact = solved.primal_dual_pair().unwrap();
        let n_edges = exact.edges.len() / mesh.n_cells();
        for _ in 0..10 {
            let mut pair = exact.clone();
            let size = 10_f64.powf(-4.0 * random.unit());
            let raised: Vec<f64> = (0..n_vertices)
                .map(|v| if on_boundary[v] { 0.0 } else { size * random.unit() })
                .collect();
            pair.function.iter_mut().zip(&raised).for_each(|(value, raised)| *value += raised);
            let mut is_done = vec![false; pair.function.len() - n_vertices];
            for (k, &edge) in exact.edges.iter().enumerate() {
                let [a, b] = ends[k % n_edges].map(|i| mesh.cell(k / n_edges)[i] as usize);
                if std::mem::replace(&mut is_done[edge as usize], true) {
                    continue;
                }
                let own = if on_boundary[a] || on_boundary[b] { 0.0 } else { random.unit() };
                pair.function[n_vertices + edge as usize] +=
                    0.5 * (raised[a] + raised[b]) + size * own;
            }
            for cell in 0..mesh.n_cells() {
                for local in 0..n {
                    pair.flux.add_inner(cell, local, size * (random.unit() - 0.5));
                    for p in 0..D {
                        let add = |flux: &mut Flux<D>, (cell, facet), change| {
                            flux.add_density(cell, facet, p + usize::from(p >= facet), change);
                        };
                        let change = size * (random.unit() - 0.5);
                        change_flux(&mut pair.flux, &neighbours, (cell, local), change, add);
                    }
                }
            }
            least = least.min(ratio(&solved, &pair));
        }
    }
    println!("{}: least ratio {least}", scene.name);
    assert!(least >= 1.0, "{}: {least}", scene.name);
}

#[test]
fn any_admissible_quadratic_and_any_flux_give_a_bound() {
    random_pairs(&scenes::radial::<2>(1.0), 6, SCHEMES);
    random_pairs(&scenes::radial::<3>(1.0), 2, "p2 sipg-p2");
    random_pairs(&scenes::contrast::<1>(100.0), 8, SCHEMES);
    random_pairs(&scenes::signorini_reaction_1d(), 8, "p2 sipg-p2 nipg-p2 br2-p2 wopsip-p2");
}

#[test]
fn what_is_proven_for_quadratics() {
    let mesh = scenes::radial::<2>(1.0).domain.mesh(4).unwrap();
    let unproven = |problem: &Problem<2>, scheme: &dyn Scheme<2>| {
        solve(problem, &mesh, scheme).unwrap().bound().unwrap().unproven
    };
    let problem = Problem::new()
        .constant_source(-2.0)
        .obstacle_below(|x| -0.1 - 0.02 * x[0] - 0.01 * x[1] * x[1])
        .dirichlet(|x| 0.01 * x[0] * x[1]);
    let all = [Unproven::Quadrature, Unproven::Boundary, Unproven::Obstacle];
    assert_eq!(unproven(&problem, &ConformingP2), all);
    let stated = problem.polynomial_data(2);
    assert_eq!(unproven(&stated, &ConformingP2), []);
    let sipg: NamedScheme = "sipg-p2".parse().unwrap();
    assert_eq!(unproven(&stated, &*sipg.make()), []);
    assert_eq!(unproven(&stated, &ConformingP1), [Unproven::Boundary, Unproven::Obstacle]);
    let cubic = stated.polynomial_data(3);
    assert_eq!(unproven(&cubic, &ConformingP2), [Unproven::Boundary, Unproven::Obstacle]);
}

/// On the line data on facets are numbers: where data are constant the bound is guaranteed.
#[test]
fn a_scene_with_constant_data_has_a_guaranteed_bound_for_quadratics() {
    let mut checks = Checks::default();
    for scene in [scenes::signorini_open_1d(), scenes::signorini_closed_1d()] {
        for name in "p2 sipg-p2 nipg-p2 ldg-p2 br2-p2 bmmpr-p2 wopsip-p2".split_whitespace() {
            let (scene, scheme) = placed(&scene, name);
            let (_, bound, error) = bounded(&scene, &scene.domain.mesh(8).unwrap(), &*scheme);
            let label = format!("{}, {name}: {:e} of {error:e}", scene.name, bound.total);
            checks.that(bound.is_guaranteed(), || label.clone());
            // the solutions are quadratics in the cells: what is left is rounding
            checks.that(bound.total >= error * (1.0 - 1e-9) || bound.total < 1e-9, || label);
        }
    }
    checks.finish();
}
