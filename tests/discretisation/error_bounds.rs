//! Guaranteed bounds on the error: the identity, effectivity, fluxes, perturbed pairs.

use std::sync::Arc;

use crate::elements::ConformingP3;
use crate::runs::small_mesh;
use crate::support::checks::Checks;
use crate::support::meshes::{Random, Raw};
use unilateral::error_bound::{ErrorBound, Flux, NoBound, PrimalDualPair, Unproven};
use unilateral::mesh::{Neighbour, Neighbours, TaggedFacet};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::scenes::Scene;

/// Every scheme on linears, two placements and variants of forms with lifts among them.
const SCHEMES: &str = "p1 cr sipg nipg iipg ldg br2 bmmpr wopsip wopsip:facet-means \
    sipg:facet-means ldg-switch br2@lifts=full ldg@lifts=full wopsip@eta=1e4";

/// The right side of the identity: half of the squared errors of function and flux, and the
/// complementarity of each multiplier with the other function.
fn right_side<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    pair: &PrimalDualPair<D>,
) -> f64 {
    let exact = problem.exact.as_ref().unwrap();
    let density = exact.multiplier.as_ref().unwrap();
    let degree = if D < 3 { 13 } else { 7 };
    let rule = Rule::new(D, degree);
    let source = |x: &Point<D>| problem.source.everywhere.as_ref().map_or(0.0, |f| f.at(x));
    let mut sum = 0.0;
    for cell in 0..mesh.n_cells() {
        let geometry = mesh.geometry(cell);
        let corners: Vec<_> = mesh.cell(cell).iter().map(|&v| v as usize).collect();
        let flux: Vec<f64> = (0..=D).map(|facet| pair.flux.through(cell, facet)).collect();
        let mut points = Vec::new();
        for (point, weight) in rule.iter() {
            let x: Point<D> =
                corners.iter().zip(point).map(|(&v, &b)| mesh.vertices()[v] * b).sum();
            points.push((x, point, weight * geometry.volume));
        }
        let load: f64 = points.iter().map(|(x, _, w)| w * source(x)).sum::<f64>() / geometry.volume;
        let multiplier = -flux.iter().sum::<f64>() / geometry.volume - load;
        for (x, point, weight) in &points {
            let mut v: f64 = corners.iter().zip(*point).map(|(&v, b)| b * pair.function[v]).sum();
            let mut gradient: Point<D> =
                (0..=D).map(|k| *geometry.gradient(k) * pair.function[corners[k]]).sum();
            let q: Point<D> = (0..=D)
                .map(|k| {
                    (x - mesh.vertices()[corners[k]]) * (flux[k] / (D as f64 * geometry.volume))
                })
                .sum();
            let u = exact.value.at(x);
            let alpha = problem.coefficient.everywhere.as_ref().map_or(1.0, |f| f.at(x));
            for (psi, sign) in [(&problem.lower, 1.0), (&problem.upper, -1.0)] {
                let Some(psi) = &psi.everywhere else { continue };
                if sign * (psi.at(x) - v) > 0.0 {
                    v = psi.at(x);
                    gradient = Point::from_fn(|k, _| {
                        let mut step = Point::<D>::zeros();
                        step[k] = 1e-6;
                        (psi.at(&(x + step)) - psi.at(&(x - step))) / 2e-6
                    });
                }
                if sign * multiplier > 0.0 {
                    sum += weight * multiplier * (u - psi.at(x));
                }
                if sign * density(x) > 0.0 {
                    sum += weight * density(x) * (v - psi.at(x));
                }
            }
            let slope = (exact.gradient)(x);
            sum += 0.5 * weight * alpha * (slope - gradient).norm_squared();
            sum += 0.5 * weight * (slope * alpha - q).norm_squared() / alpha;
        }
    }
    let rule = Rule::new(D - 1, degree);
    for f in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
        let (cell, local) = (f.cell as usize, f.local as usize);
        let gap = problem.gap.everywhere.as_ref().unwrap();
        let measure = mesh.geometry(cell).facet_measure(local);
        let force = pair.flux.through(cell, local) / measure;
        let corners: Vec<usize> = mesh.facet_vertices(cell, local).map(|v| v as usize).collect();
        for (point, weight) in rule.iter() {
            let at = |k: usize| mesh.vertices()[corners[k]] * point[k];
            let x: Point<D> = (0..D).map(at).sum();
            let interpolated: f64 = (0..D).map(|k| pair.function[corners[k]] * point[k]).sum();
            let v = interpolated.max(gap.at(&x));
            let weight = weight * measure;
            sum += weight * force * (exact.value.at(&x) - gap.at(&x));
            sum += weight * density(&x) * (v - gap.at(&x));
        }
    }
    sum
}

/// A scene with the placement of a scheme, and the scheme.
pub fn placed<const D: usize>(scene: &Scene<D>, name: &str) -> (Scene<D>, Box<dyn Scheme<D>>) {
    let named: NamedScheme = name.parse().unwrap();
    let mut scene = scene.clone();
    scene.problem.constraint_set = named.constraint_set();
    (scene, named.make())
}

/// The pair of a scheme, its bound and the true error of the admissible function.
pub fn bounded<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<D>,
    scheme: &dyn Scheme<D>,
) -> (PrimalDualPair<D>, ErrorBound, f64) {
    let solved = solve(&scene.problem, mesh, scheme).unwrap();
    assert!(solved.converged(), "{} {}", scene.name, scheme.name());
    let pair = solved.primal_dual_pair().unwrap();
    let error = solved.discretisation().error_of_pair(&pair).unwrap();
    (pair, solved.bound().unwrap(), error)
}

/// The largest difference of the normal fluxes from the two sides of a facet at a vertex, over the largest.
pub fn mismatch_of_sides<const D: usize>(mesh: &Mesh<D>, flux: &Flux<D>) -> f64 {
    let neighbours = Neighbours::new(mesh);
    let (mut difference, mut largest) = (0.0_f64, 0.0_f64);
    for (cell, facet) in (0..mesh.n_cells()).flat_map(|c| (0..=D).map(move |facet| (c, facet))) {
        let vertices = |facet: usize| (0..=D).filter(move |&j| j != facet);
        for (p, j) in vertices(facet).enumerate() {
            let here = flux.density(cell, facet, j);
            largest = largest.max(here.abs());
            if let Neighbour::Cell { cell: other, local } = neighbours.across(cell, facet) {
                let (other, local) = (other as usize, usize::from(local));
                let across = vertices(local).nth(p).unwrap();
                difference = difference.max((here + flux.density(other, local, across)).abs());
            }
        }
    }
    difference / largest
}

/// On a mesh of a scene, every scheme: fluxes are single-valued and balance the load, the identity holds to a
/// share, and the bound is one to three times the error.
fn check<const D: usize>(scene: Scene<D>, mesh: &Mesh<D>, schemes: &str, share: f64) {
    let mut checks = Checks::default();
    for name in schemes.split_whitespace() {
        let (scene, scheme) = placed(&scene, name);
        let label = format!("{}, {name}", scene.name);
        let (pair, bound, error) = bounded(&scene, mesh, &*scheme);
        let sides = mismatch_of_sides(mesh, &pair.flux);
        checks.that(sides < 1e-12, || format!("{label}: sides differ by {sides:.1e}"));
        let algebra = bound.terms.algebra;
        checks.that(algebra.abs() < 1e-5, || format!("{label}: unbalanced {algebra:.1e}"));
        let terms = bound.terms;
        let sum = terms.mismatch + terms.obstacle + terms.contact + terms.oscillation + algebra;
        checks.that((sum - 1.0).abs() < 1e-12, || format!("{label}: shares add to {sum}"));
        let sum = bound.cells.iter().sum::<f64>() + algebra;
        checks.that((sum - 1.0).abs() < 1e-10, || format!("{label}: cells add to {sum}"));
        let effectivity = bound.total / error;
        checks.that((1.0..3.0).contains(&effectivity), || format!("{label}: {effectivity}"));
        // the oscillation is no part of the identity
        let left = 0.5 * bound.total.powi(2) * (1.0 - terms.oscillation);
        let identity = left / right_side(&scene.problem, mesh, &pair);
        println!("{label}: identity {identity:.4}, effectivity {effectivity:.3}");
        checks.that((identity - 1.0).abs() < share, || format!("{label}: identity {identity:.4}"));
    }
    checks.finish();
}

/// Two squares that share one vertex: the cells around it form two fans, and the vertex has one equation. Under loads of
/// opposite signs neither fan balances alone.
#[test]
fn a_vertex_with_two_fans_has_balanced_fluxes() {
    let n = 3;
    let side = |k: usize, sign: f64| sign * k as f64 / n as f64;
    let (mut vertices, mut cells, mut boundary) = (Vec::new(), Vec::new(), Vec::new());
    for (square, sign) in [1.0, -1.0].into_iter().enumerate() {
        // the first vertex of both is the origin
        let number = |i: usize, j: usize| match i + j {
            0 => 0,
            _ => (square * ((n + 1) * (n + 1) - 1) + j * (n + 1) + i) as u32,
        };
        for (i, j) in (0..(n + 1) * (n + 1)).map(|k| (k % (n + 1), k / (n + 1))) {
            if square == 0 || i + j > 0 {
                vertices.push(Point::from([side(i, sign), side(j, sign)]));
            }
        }
        for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
            let [a, b] = [number(i, j), number(i + 1, j + 1)];
            cells.extend([a, number(i + 1, j), b, a, number(i, j + 1), b]);
        }
        for k in 0..n {
            let mut add =
                |vertices: [u32; 2], condition| boundary.push(TaggedFacet { vertices, condition });
            for transposed in [false, true] {
                let number = |i, j| if transposed { number(j, i) } else { number(i, j) };
                add([number(k, 0), number(k + 1, 0)], BoundaryCondition::Neumann);
                add([number(k, n), number(k + 1, n)], BoundaryCondition::Dirichlet);
            }
        }
    }
    let mesh = Mesh::<2>::new(vertices, cells, &boundary).unwrap();
    // loads of opposite signs: what one fan has too much the other one lacks
    let problem = Problem::new().source(|x: &Point<2>| x[0].signum()).polynomial_data(0);
    let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
    let origin = mesh.vertices().iter().position(|x| x.norm() == 0.0).unwrap();
    assert!(solved.values()[origin].abs() < 1e-12, "by symmetry");
    let sides = mismatch_of_sides(&mesh, &solved.primal_dual_pair().unwrap().flux);
    assert!(sides < 1e-12, "{sides:e}");
    // a vertex alone ties no functions of finite energy together: the error is that of two squares. In the energy of one
    // there is no less than in that of a finer function
    let alone = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(1, 0, BoundaryCondition::Neumann);
    let alone = Mesh::<2>::kuhn_box(&alone, [48, 48]).unwrap();
    let of_one = Problem::new().constant_source(1.0);
    let of_one = solve(&of_one, &alone, &ConformingP1).unwrap().objective().unwrap();
    let square = 2.0 * (solved.objective().unwrap() - 2.0 * of_one);
    let bound = solved.bound().unwrap();
    assert!(bound.is_guaranteed() && square > 0.0);
    assert!(bound.total.powi(2) >= square, "{} {square}", bound.total.powi(2));
    assert!(bound.terms.algebra > 0.5, "what the vertex alone balances counts: {:?}", bound.terms);
}

/// The same on the mesh of a level.
fn check_level<const D: usize>(scene: Scene<D>, level: usize, schemes: &str, share: f64) {
    let mesh = scene.domain.mesh(level).unwrap();
    check(scene, &mesh, schemes, share);
}

#[test]
fn nothing_is_lost_under_obstacles() {
    check_level(scenes::radial::<1>(1.0), 64, SCHEMES, 0.01);
    check_level(scenes::radial::<2>(1.0), 32, SCHEMES, 0.01);
    check_level(scenes::radial_quarter_2d(), 16, "p1 cr sipg ldg wopsip", 0.01);
}

#[test]
fn nothing_is_lost_with_two_materials() {
    check_level(scenes::contrast::<2>(1e4), 32, "p1 cr sipg ldg br2 bmmpr wopsip", 0.01);
    check_level(scenes::contrast::<2>(1e-4), 32, "p1 cr sipg ldg br2 bmmpr wopsip", 0.01);
}

#[test]
fn nothing_is_lost_under_signorini_conditions() {
    check_level(scenes::signorini_harmonic::<2>(), 16, SCHEMES, 0.01);
    check_level(scenes::signorini_2d(), 16, "p1 cr nipg ldg wopsip", 0.01);
    check_level(scenes::hertz_2d(), 16, "p1 cr sipg wopsip", 0.03);
}

#[test]
fn nothing_is_lost_in_space() {
    check_level(scenes::signorini_harmonic::<3>(), 4, "p1 cr sipg br2 wopsip", 0.03);
    // rules of low degree across the free boundary on a coarse mesh
    check_level(scenes::radial::<3>(1.0), 6, "p1 cr sipg ldg wopsip:facet-means", 0.06);
}

#[test]
fn reaction_and_two_obstacles() {
    check_level(scenes::signorini_reaction_1d(), 32, "p1 cr sipg ldg wopsip", 0.02);
    check_level(scenes::bilateral_1d(), 64, "p1 cr sipg nipg wopsip", 0.03);
}

#[test]
fn unstructured_meshes() {
    let square = small_mesh::<2>("unstructured_square.msh");
    check(scenes::radial::<2>(1.0), &square, SCHEMES, 0.03);
    let half = small_mesh::<2>("unstructured_half_square.msh");
    check(scenes::signorini_harmonic::<2>(), &half, SCHEMES, 0.03);
    let cube = small_mesh::<3>("unstructured_cube.msh");
    check(scenes::radial::<3>(1.0), &cube, "p1 cr sipg wopsip", 0.1);
}

#[test]
fn the_factor_of_the_over_penalty_does_not_matter() {
    let scenes = [
        scenes::radial::<2>(1.0),
        scenes::signorini_harmonic::<2>(),
        scenes::ball_2d(),
        scenes::torsion_2d(5.0),
    ];
    for scene in scenes {
        let mesh = scene.domain.mesh(32).unwrap();
        let total = |name: &str| {
            let (scene, scheme) = placed(&scene, name);
            solve(&scene.problem, &mesh, &*scheme).unwrap().bound().unwrap().total
        };
        let ratio = total("wopsip@eta=10") / total("wopsip@eta=1e4");
        assert!((ratio - 1.0).abs() < 0.01, "{}: {ratio}", scene.name);
    }
}

/// Whether each vertex is on the boundary.
pub fn on_boundary<const D: usize>(mesh: &Mesh<D>) -> Vec<bool> {
    let mut on_boundary = vec![false; mesh.vertices().len()];
    for f in mesh.boundary() {
        let vertices = mesh.facet_vertices(f.cell as usize, f.local as usize);
        vertices.for_each(|v| on_boundary[v as usize] = true);
    }
    on_boundary
}

/// Adds a change to the flux of a pair through a facet, with opposite signs on both sides; on the boundary where
/// data are Dirichlet's alone. The last argument adds a change to the flux of a cell through a facet.
pub fn change_flux<const D: usize>(
    flux: &mut Flux<D>,
    neighbours: &Neighbours,
    (cell, local): (usize, usize),
    change: f64,
    add: impl Fn(&mut Flux<D>, (usize, usize), f64),
) {
    match neighbours.across(cell, local) {
        Neighbour::Cell { cell: other, local: there } if cell < other as usize => {
            add(flux, (cell, local), change);
            add(flux, (other as usize, usize::from(there)), -change);
        }
        Neighbour::Boundary(BoundaryCondition::Dirichlet) => add(flux, (cell, local), change),
        _ => {}
    }
}

/// The bound that a pair gives, over the error of the function of the pair.
pub fn ratio<const D: usize>(solved: &Solved<'_, D>, pair: &PrimalDualPair<D>) -> f64 {
    let bound = solved.discretisation().error_bound(pair, &solved.solution().values).unwrap();
    bound.total / solved.discretisation().error_of_pair(pair).unwrap()
}

/// Random admissible functions and fluxes on meshes with moved vertices, those near an interface of the
/// coefficient put on it: ten for each mesh.
fn random_pairs<const D: usize>(scene: &Scene<D>, n: usize, cases: usize, interface: Option<f64>) {
    let unilateral::mesh::Domain::Box(domain) = &scene.domain else { panic!("a box") };
    let mut least = f64::INFINITY;
    let mut random = Random(n as u64);
    for case in 0..cases {
        let mut raw = Raw::jittered(domain, n, 0.4, &mut random);
        for x in &mut raw.vertices {
            x[0] = interface.filter(|at| (at - x[0]).abs() < 0.5 / n as f64).unwrap_or(x[0]);
        }
        let mesh: Mesh<D> = raw.mesh();
        let (scene, scheme) = placed(scene, ["p1", "sipg", "cr"][case % 3]);
        let solved = solve(&scene.problem, &mesh, &*scheme).unwrap();
        let exact = solved.primal_dual_pair().unwrap();
        let neighbours = Neighbours::new(&mesh);
        let on_boundary = on_boundary(&mesh);
        for _ in 0..10 {
            let mut pair = exact.clone();
            let size = 10_f64.powf(-4.0 * random.unit());
            for (v, value) in pair.function.iter_mut().enumerate() {
                *value += if on_boundary[v] { 0.0 } else { size * random.unit() };
            }
            for cell in 0..mesh.n_cells() {
                for local in 0..=D {
                    let change = size * (random.unit() - 0.5);
                    let add = |flux: &mut Flux<D>, (cell, facet), change| {
                        flux.add_through(cell, facet, change);
                    };
                    change_flux(&mut pair.flux, &neighbours, (cell, local), change, add);
                }
            }
            least = least.min(ratio(&solved, &pair));
        }
    }
    println!("{}: least ratio {least}", scene.name);
    assert!(least >= 1.0, "{}: {least}", scene.name);
}

#[test]
fn any_admissible_function_and_any_flux_give_a_bound() {
    random_pairs(&scenes::radial::<2>(1.0), 4, 30, None);
    random_pairs(&scenes::contrast::<1>(100.0), 8, 25, Some(0.5));
    random_pairs(&scenes::contrast::<2>(100.0), 4, 20, Some(0.5));
    random_pairs(&scenes::signorini_reaction_1d(), 8, 25, None);
}

/// The form of `examples/my_scheme.rs`, with its factor.
#[derive(Clone, Copy)]
pub struct Incomplete(pub f64);

impl<const D: usize> FacetForm<D> for Incomplete {
    fn is_symmetric(&self) -> bool {
        false
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        self.0 * facet.coefficient() / facet.diameter()
    }
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump
    }
}

/// The scheme of `examples/my_scheme.rs`.
struct Iipg {
    sigma: f64,
}

impl<const D: usize> Scheme<D> for Iipg {
    fn name(&self) -> &str {
        "iipg"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(Incomplete(self.sigma))
    }
}

#[test]
fn a_scheme_of_ones_own_has_its_bound() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(16).unwrap();
    let own = bounded(&scene, &mesh, &Iipg { sigma: 10.0 });
    let (_, known) = placed(&scene, "iipg@sigma=10");
    let known = bounded(&scene, &mesh, &*known);
    assert!((own.1.total / known.1.total - 1.0).abs() < 1e-9, "{} {}", own.1.total, known.1.total);
    assert!((1.0..3.0).contains(&(own.1.total / own.2)));
}

#[test]
fn what_is_proven_and_what_has_no_bound() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(4).unwrap();
    let unproven = |problem: &Problem<2>, scheme: &dyn Scheme<2>| {
        solve(problem, &mesh, scheme).unwrap().bound().map(|bound| bound.unproven)
    };
    let problem = Problem::new().constant_source(-2.0).obstacle_below(|x| -0.1 - 0.02 * x[0]);
    let all = [Unproven::Quadrature, Unproven::Obstacle];
    assert_eq!(unproven(&problem, &ConformingP1).unwrap(), all);
    let stated = problem.polynomial_data(1);
    assert_eq!(unproven(&stated, &ConformingP1).unwrap(), []);
    assert_eq!(unproven(&stated, &Wopsip::default()).unwrap(), []);
    let concave = |x: &Point<2>| -0.1 - 0.02 * x[0] * x[0];
    let curved = Problem::new().constant_source(-2.0).obstacle_below(concave);
    let stated = curved.dirichlet(|x| 0.01 * x[0] * x[1]).polynomial_data(2);
    let all = [Unproven::Boundary, Unproven::Obstacle];
    assert_eq!(unproven(&stated, &Sipg::default()).unwrap(), all);
    assert!(matches!(unproven(&stated, &ConformingP3), Err(NoBound::Element)));
    let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
    let refused = adapt(&stated, &meshes, &ConformingP3, Adaptivity::default()).err().unwrap();
    assert!(refused.to_string().contains("error bound of p3"), "{refused}");
    let negative = scene.problem.reaction(-1e-3);
    assert!(matches!(unproven(&negative, &ConformingP1), Err(NoBound::NegativeReaction)));
}

/// On the line data on facets are numbers: scenes that state constant data have guaranteed bounds. So do the scenes
/// whose data are polynomials, over the mesh or in its regions.
#[test]
fn a_scene_with_polynomial_data_has_a_guaranteed_bound() {
    fn check<const D: usize>(scene: Scene<D>) {
        let name = scene.name.clone();
        let study = Study::<D>::new(scene).scheme(ConformingP1).scheme(Sipg::default());
        for row in study.scheme(Wopsip::default()).levels([8]).run().unwrap().rows {
            assert_eq!(row.bound.guaranteed, Some(true), "{name} {}", row.label);
            let effectivity = row.bound.effectivity.unwrap();
            assert!(
                (1.0 - 1e-9..3.0).contains(&effectivity),
                "{name} {}: {effectivity}",
                row.label
            );
        }
    }
    check(scenes::signorini_open_1d());
    check(scenes::signorini_closed_1d());
    check(scenes::hill::<2>());
    check(scenes::signorini_halves_2d());
}

/// Dirichlet data of two groups that differ where the groups meet belong to no function of finite energy.
#[test]
fn dirichlet_data_that_disagree_are_not_guaranteed() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let unproven = |bottom: f64| {
        let problem = Problem::new()
            .constant_source(1.0)
            .dirichlet_on("bottom", bottom)
            .dirichlet_on("left", 0.0)
            .dirichlet_on("right", 0.0)
            .dirichlet_on("top", 0.0);
        let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
        let mesh = problem.bind_boundary(mesh).unwrap();
        solve(&problem, &mesh, &ConformingP1).unwrap().bound().unwrap().unproven
    };
    assert_eq!(unproven(0.0), []);
    assert_eq!(unproven(1.0), [Unproven::Boundary]);
}
