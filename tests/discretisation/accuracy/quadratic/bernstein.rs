//! Bounds on Bernstein coefficients hold at every point.

use super::{broken, without_contact};
use crate::runs::solve;
use crate::support::checks::Checks;
use crate::support::meshes::{Random, Raw, mixed_box};
use crate::support::scheme_lists::entry;
use crate::support::schemes::Entry;
use unilateral::algebra::Bound;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::Outcome;
use unilateral::measure::Fields;
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh};
use unilateral::prelude::*;
use unilateral::problem::Datum;

/// Quadratics of every kind with bounds on Bernstein coefficients.
fn schemes<const D: usize>() -> [Entry<D>; 4] {
    [
        entry(ConformingP2, Bernstein),
        entry(broken(), Bernstein),
        entry(Nipg::default().on(P2), Bernstein),
        entry(Wopsip::default().on(P2), Bernstein),
    ]
}

/// A datum of degree two, curved in every direction.
fn datum<const D: usize>(x: &Point<D>) -> f64 {
    0.3 * x[0] * x[D - 1] - 0.4 * x.norm_squared() + (0..D).map(|k| 0.1 * x[k]).sum::<f64>()
}

/// How far a function lies below the datum at most at random points of cells, or of these facets.
fn depth<const D: usize>(
    fields: &Fields,
    mesh: &Mesh<D>,
    facets: &[(usize, Option<usize>)],
) -> f64 {
    let (random, n_edges) = (&mut Random(11), D * (D + 1) / 2);
    let mut deepest = f64::NEG_INFINITY;
    for &(cell, local) in facets {
        let at_vertices = &fields.u[cell * (D + 1)..][..D + 1];
        let values = [at_vertices, &fields.midpoints[cell * n_edges..][..n_edges]].concat();
        for _ in 0..200 {
            let mut point = [0.0; 4];
            (0..=D).for_each(|k| point[k] = random.unit().powi(3));
            local.iter().for_each(|&local| point[local] = 0.0);
            let sum: f64 = point.iter().sum();
            let point = point.map(|l| l / sum);
            let mut basis = [0.0; 10];
            Element::<D>::values(&P2, &point[..=D], &mut basis);
            let value: f64 = values.iter().zip(&basis).map(|(u, b)| u * b).sum();
            deepest = deepest.max(datum(&mesh.point(cell, &point[..=D])) - value);
        }
    }
    deepest
}

/// Whatever the shape, the numbers and the order of vertices of the cells. With bounds at nodes the solution lies
/// below the same obstacle between them, in the plane by 9e-3 and in space by 2e-2.
#[test]
fn a_quadratic_obstacle_is_respected_at_every_point() {
    fn check<const D: usize>(checks: &mut Checks, n: usize) {
        let raw = Raw::<D>::jittered(&mixed_box(), n, 0.4, &mut Random(7));
        let mesh = without_contact(raw.shuffled(&mut Random(8)).mesh());
        let bend = if D == 1 { 0.2 } else { 0.8 * D as f64 };
        let problem = Problem::new()
            .source(move |x: &Point<D>| bend + 4.0 - 15.0 * x[0])
            .dirichlet(|x| datum(x) + 0.05)
            .obstacle_below(datum);
        let cells: Vec<_> = (0..mesh.n_cells()).map(|cell| (cell, None)).collect();
        for scheme in schemes::<D>() {
            let solved = solve(&*scheme, &scheme.constrain(&problem), &mesh);
            let what = format!("{D}d, {}", scheme.name());
            checks.that(solved.outcome == Outcome::Converged, || what.clone());
            let depth = depth(&solved.fields.unwrap(), &mesh, &cells);
            println!("{what}: {depth:e}");
            checks.that(depth.abs() < 1e-12, || format!("{what}: {depth:e}"));
        }
        let at_nodes = solve(&ConformingP2, &problem, &mesh).fields.unwrap();
        let depth = depth(&at_nodes, &mesh, &cells);
        println!("{D}d, p2 at nodes: {depth:e}");
        checks.that(D == 1 || depth > 1e-3, || format!("{D}d: bounds at nodes hold everywhere"));
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, 9);
    check::<2>(&mut checks, 5);
    check::<3>(&mut checks, 3);
    checks.finish();
}

#[test]
fn a_quadratic_gap_is_respected_at_every_point_of_the_contact_boundary() {
    fn check<const D: usize>(checks: &mut Checks, n: usize) {
        let domain = BoxDomain::above_contact();
        let raw = Raw::<D>::jittered(&domain, n, 0.4, &mut Random(9));
        let mesh = raw.shuffled(&mut Random(10)).mesh();
        let problem = Problem::new()
            .source(|x: &Point<D>| 20.0 * (x[0] - 0.6))
            .dirichlet(|x| datum(x) + 0.1)
            .signorini(datum);
        let contact = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact);
        let facets: Vec<_> = contact.map(|f| (f.cell as usize, Some(f.local as usize))).collect();
        for scheme in schemes::<D>() {
            let solved = solve(&*scheme, &scheme.constrain(&problem), &mesh);
            let what = format!("{D}d, {}", scheme.name());
            checks.that(solved.outcome == Outcome::Converged, || what.clone());
            let depth = depth(&solved.fields.unwrap(), &mesh, &facets);
            println!("{what}: {depth:e}");
            checks.that(depth.abs() < 1e-12, || format!("{what}: {depth:e}"));
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, 5);
    check::<2>(&mut checks, 6);
    check::<3>(&mut checks, 3);
    checks.finish();
}

/// The coefficient of `x^2` on an edge is the product of the coordinates of its ends. Dirichlet values that touch the
/// obstacle in the middle of an edge lie below it in a coefficient: it is fixed, and the problem has a solution.
#[test]
fn bounds_are_coefficients() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [3, 3]).unwrap();
    let problem = Problem::new()
        .obstacle_below(|x| x[0] * x[0] - 2.0)
        .obstacle_above(|x| x[0] * x[0] + 2.0)
        .dirichlet(|x| (x[1] - 0.5).powi(2));
    let problem = problem.on(Bernstein);
    let discretisation =
        Discretisation::new(&broken::<2>(), &problem, &mesh, DataQuadrature::default()).unwrap();
    let bounds = discretisation.bounds().unwrap();
    for (bound, place) in bounds.iter().zip(discretisation.locations()) {
        let ends: Vec<f64> =
            place.vertices().iter().map(|&v| mesh.vertices()[v as usize][0]).collect();
        let coefficient = ends[0] * ends[ends.len() - 1];
        let [lower, upper] = [bound.lower().unwrap() + 2.0, bound.upper().unwrap() - 2.0];
        assert!((lower - coefficient).abs() < 1e-14, "{ends:?}: {bound:?}");
        assert!((upper - coefficient).abs() < 1e-14, "{ends:?}: {bound:?}");
    }
    let mut touching = problem;
    [touching.lower, touching.upper] = [0.0, 1.0].map(|bound| Datum::from(bound).into());
    let discretisation =
        Discretisation::new(&ConformingP2, &touching, &mesh, DataQuadrature::default()).unwrap();
    let fixed = discretisation.bounds().unwrap().into_iter().filter_map(|bound| match bound {
        Bound::Fixed(value) => Some(value),
        _ => None,
    });
    let least = fixed.fold(f64::INFINITY, f64::min);
    assert!((least + 1.0 / 36.0).abs() < 1e-14, "{least}");
}
