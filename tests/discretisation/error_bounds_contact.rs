//! Error bounds where contact decides the flux: beside Dirichlet facets, at the ends of contact, deep inside.

use crate::error_bounds::{bounded, placed};
use crate::support::checks::Checks;
use rayon::ThreadPoolBuilder;
use unilateral::algebra::Contact;
use unilateral::error_bound::NoBound;
use unilateral::prelude::*;

/// Where an obstacle binds the unknowns beside Dirichlet facets, its multiplier is exchanged for flux: the bound has
/// order one for every broken scheme, and that of WOPSIP is near those of the others.
#[test]
fn multipliers_beside_dirichlet_facets_carry_no_flux() {
    let mut checks = Checks::default();
    let scene = scenes::torsion_2d(5.0);
    let mut totals = Vec::new();
    for name in "p1 cr sipg ldg br2 wopsip wopsip:facet-means".split_whitespace() {
        let (scene, scheme) = placed(&scene, name);
        let of_level = |n: usize| {
            let mesh = scene.domain.mesh(n).unwrap();
            let solved = solve(&scene.problem, &mesh, &*scheme).unwrap();
            solved.bound().unwrap().total
        };
        let [coarse, fine] = [16, 32].map(of_level);
        println!("{name}: {coarse:.3e}, {fine:.3e}");
        checks.that(coarse / fine > 1.9, || format!("{name}: {coarse:e} {fine:e}"));
        totals.push(fine);
    }
    let least = totals.iter().copied().fold(f64::INFINITY, f64::min);
    for total in totals {
        checks.that(total < 1.3 * least, || format!("{total:e} {least:e}"));
    }
    checks.finish();
}

/// Deep in contact the multipliers of neighbouring cells may carry the flux between them: without an exchange the bounds
/// of WOPSIP and of minimal-dissipation LDG are eight times the error where all cells are in contact.
#[test]
fn multipliers_in_contact_carry_no_flux() {
    let mut checks = Checks::default();
    let mut check = |label: String, effectivity: f64, most: f64| {
        println!("{label}: {effectivity:.3}");
        checks.that((1.0..most).contains(&effectivity), || format!("{label}: {effectivity}"));
    };
    let effectivity = |scene: &scenes::Scene<1>, name: &str, n: usize| {
        let (scene, scheme) = placed(scene, name);
        let (_, bound, error) = bounded(&scene, &scene.domain.mesh(n).unwrap(), &*scheme);
        bound.total / error
    };
    for name in "p1 cr sipg nipg ldg-switch br2 wopsip wopsip:facet-means".split_whitespace() {
        let of_parabola = effectivity(&scenes::parabola_1d(), name, 32);
        check(format!("parabola-1d, {name}"), of_parabola, 2.0);
    }
    for name in "p2 sipg-p2 nipg-p2 br2-p2 wopsip-p2".split_whitespace() {
        let of_parabola = effectivity(&scenes::parabola_1d(), name, 16);
        check(format!("parabola-1d, {name}"), of_parabola, 2.3);
        let of_two_obstacles = effectivity(&scenes::bilateral_1d(), name, 16);
        check(format!("bilateral-1d, {name}"), of_two_obstacles, 3.0);
    }
    let ball = scenes::ball_2d();
    for name in "p1 cr sipg ldg-switch br2 wopsip p2 sipg-p2 wopsip-p2".split_whitespace() {
        let (scene, scheme) = placed(&ball, name);
        let (_, bound, error) = bounded(&scene, &scene.domain.mesh(16).unwrap(), &*scheme);
        check(format!("ball-2d, {name}"), bound.total / error, 1.6);
    }
    checks.finish();
}

/// An exchange visits its cells in chunks: over several chunks the flux has the same bits for any number of threads, and
/// the bound has the size that it has over one chunk on a coarser mesh.
#[test]
fn exchanges_over_several_chunks_of_cells_lose_nothing() {
    let mut checks = Checks::default();
    // most cells are in contact
    let scene = scenes::torsion_2d(20.0);
    for (name, levels) in [("p1", [40, 80]), ("wopsip", [32, 64]), ("sipg-p2", [28, 56])] {
        let (scene, scheme) = placed(&scene, name);
        let [coarse, fine] = levels.map(|n| {
            let mesh = scene.domain.mesh(n).unwrap();
            let solved = solve(&scene.problem, &mesh, &*scheme).unwrap();
            let contact = solved.solution().contact.iter();
            let n_active = contact.filter(|state| **state != Contact::Inactive).count();
            checks.that(3 * n_active > solved.values().len(), || format!("{name}: {n_active}"));
            let pair = |threads: usize| {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let of = solved.discretisation();
                pool.install(|| of.primal_dual_pair(solved.inequality(), solved.solution()))
            };
            checks.that(pair(1).unwrap() == pair(3).unwrap(), || format!("{name}, {n}: bits"));
            let bound = solved.bound().unwrap();
            checks.that(bound.terms.algebra < 1e-6, || format!("{name}: {:?}", bound.terms));
            bound.total
        });
        println!("{name}: {coarse:.3e}, {fine:.3e}");
        checks.that(coarse / fine > 1.9, || format!("{name}: {coarse:e} {fine:e}"));
    }
    checks.finish();
}

/// Copies of a node of WOPSIP on quadratics share one multiplier beside Dirichlet facets and interfaces too.
#[test]
fn copies_of_a_node_share_their_multipliers() {
    let scene = scenes::torsion_2d(5.0);
    let total = |name: &str| {
        let (scene, scheme) = placed(&scene, name);
        let mesh = scene.domain.mesh(16).unwrap();
        solve(&scene.problem, &mesh, &*scheme).unwrap().bound().unwrap().total
    };
    let ratio = total("wopsip-p2") / total("sipg-p2");
    assert!(ratio < 1.7, "{ratio}");
}

/// Vertices of conforming quadratics deep in contact are inactive at random, and the flux there does not know it.
#[test]
fn quadratics_deep_in_contact() {
    let scene = scenes::ball_2d();
    let total = |name: &str| {
        let (scene, scheme) = placed(&scene, name);
        let (_, bound, error) = bounded(&scene, &scene.domain.mesh(16).unwrap(), &*scheme);
        assert!((1.0..2.0).contains(&(bound.total / error)), "{name}: {}", bound.total / error);
        bound.total
    };
    let ratio = total("p2") / total("p2:midpoints");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// A strip in contact along its lower side, pulled down with very different forces.
fn strip(gap: impl Fn(f64) -> f64 + Send + Sync + 'static) -> (Problem<2>, Mesh<2>) {
    let box_ = BoxDomain::dirichlet(Point::zeros(), Point::<2>::new(6.0, 1.0));
    let box_ = box_.side(1, 0, BoundaryCondition::Contact).side(1, 1, BoundaryCondition::Neumann);
    let forces = [-1.0, -10.0, -0.72, 0.114, -0.03, 0.0];
    let problem = Problem::new()
        .neumann(move |x, _| forces[(x[0] as usize).min(5)])
        .dirichlet(|x| 0.734 * x[0] / 6.0)
        .signorini(move |x| gap(x[0]));
    (problem, Mesh::kuhn_box(&box_, [6, 1]).unwrap())
}

/// No contact facet has a force that is negative in the mean, and the complementarity is not negative: else a bound may
/// lie below the error.
#[test]
fn forces_on_contact_facets_are_not_negative() {
    let (problem, mesh) =
        strip(|x| if (3.0..4.0).contains(&x) { -899.0 * (x - 3.0) * (4.0 - x) } else { 0.0 });
    let fine = mesh.refine().unwrap().0.refine().unwrap().0.refine().unwrap().0;
    let reference = solve(&problem, &fine, &ConformingP2).unwrap();
    let named: NamedScheme = "wopsip-p2".parse().unwrap();
    let scheme = named.make();
    let solved = solve(&problem, &mesh, &*scheme).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    let contact: Vec<(usize, usize)> = mesh
        .boundary()
        .iter()
        .filter(|f| f.condition == BoundaryCondition::Contact)
        .map(|f| (f.cell as usize, usize::from(f.local)))
        .collect();
    for &(cell, local) in &contact {
        let integral = pair.flux.through(cell, local);
        assert!(integral >= -1e-12, "{cell} {local}: {integral}");
    }
    let bound = solved.bound().unwrap();
    assert!(bound.terms.contact >= 0.0, "{:?}", bound.terms);
    // a lower bound on the error of the function: norms of both solutions differ by it at most
    let energy = |solved: &Solved<'_, 2>| solved.energy().unwrap().unwrap();
    let excess = energy(&solved) - energy(&reference);
    assert!(
        excess.is_finite() && 0.5 * (bound.total + bound.distance).powi(2) > excess,
        "{excess}"
    );
    // a pair with such a force gives no bound
    let (cell, local) = contact[1];
    let through = pair.flux.through(cell, local);
    pair.flux.add_through(cell, local, -1.0 - through);
    let refused = solved.discretisation().error_bound(&pair, &solved.solution().values);
    assert!(matches!(refused, Err(NoBound::NegativeForce)), "{refused:?}");
}

/// Where gaps of two boundary groups differ at a common vertex, the force of the vertex is on the facets whose gap binds
/// it: the bound does not grow with the other gap.
#[test]
fn the_force_of_a_vertex_is_where_its_gap_binds() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 1, BoundaryCondition::Contact)
        .side(1, 0, BoundaryCondition::Contact);
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let total = |depth: f64, name: &str| {
        let named: NamedScheme = name.parse().unwrap();
        let problem = Problem::new()
            .constant_source(-4.0)
            .dirichlet_on("left", 0.0)
            .dirichlet_on("top", 0.0)
            .signorini_on("bottom", 0.0)
            .signorini_on("right", -depth);
        let mesh = problem.bind_boundary(mesh.clone()).unwrap();
        let scheme = named.make();
        let bound = solve(&problem, &mesh, &*scheme).unwrap().bound().unwrap();
        assert!(bound.is_guaranteed(), "{name}: {:?}", bound.unproven);
        bound.total
    };
    for name in "p1 p2 sipg wopsip".split_whitespace() {
        let [shallow, deep] = [2.0, 2e4].map(|depth| total(depth, name));
        println!("{name}: {shallow:.3} {deep:.3}");
        assert!(deep < 1.01 * shallow, "{name}: {shallow} {deep}");
    }
}
