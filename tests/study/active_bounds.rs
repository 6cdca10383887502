//! To which obstacle or gap a multiplier belongs, and how far a solution lies beyond these.

use unilateral::assemble::DataQuadrature;
use unilateral::measure::Fields;
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh};
use unilateral::prelude::*;

const SCHEMES: &str = "p1 p2 cr sipg wopsip wopsip:facet-means nipg ldg sipg-p2 wopsip-p2";

/// A square that a load presses onto an obstacle at -0.1, with a contact side below.
fn square(gap: f64, n: usize) -> (Problem<2>, Mesh<2>) {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let domain = domain.side(1, 0, BoundaryCondition::Contact);
    let problem = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.1);
    (problem.signorini(move |_| gap), Mesh::kuhn_box(&domain, [n, n]).unwrap())
}

/// The integrals of multiplier and pressure.
fn integrals(fields: &Fields, mesh: &Mesh<2>) -> [f64; 2] {
    let of_cell = |(cell, m): (usize, &f64)| m * mesh.geometry(cell).volume;
    let of_facet =
        |(&(cell, local), p): (&(usize, usize), &f64)| p * mesh.geometry(cell).facet_measure(local);
    let facets = fields.contact_boundary.iter().zip(&fields.pressure);
    [fields.multiplier.iter().enumerate().map(of_cell).sum(), facets.map(of_facet).sum()]
}

/// Where the obstacle gives the bound there is no pressure on the contact side, also where the gap is equal; where the
/// gap is above it, forces of both add up to the resultant.
#[test]
fn multipliers_belong_to_the_datum_of_the_bound() {
    for name in SCHEMES.split_whitespace() {
        let named: NamedScheme = name.parse().unwrap();
        let scheme = named.make();
        for (gap, has_pressure) in [(-0.3, false), (-0.1, false), (-0.05, true)] {
            let (mut problem, mesh) = square(gap, 8);
            problem.constraint_set = named.constraint_set();
            let solved = solve(&problem, &mesh, &*scheme).unwrap();
            assert!(solved.converged(), "{name}: {}", solved.outcome());
            let resultants = solved.resultants().unwrap();
            let total = solved.resultant().unwrap();
            let [lower, gap_force] = [resultants["lower"], resultants["bottom"]];
            assert_eq!(resultants.len(), 2, "{resultants:?}");
            assert!((lower + gap_force - total).abs() < 1e-10 * total, "{name}: {resultants:?}");
            let [multiplier, pressure] = integrals(&solved.fields().unwrap(), &mesh);
            assert!((multiplier - lower).abs() < 1e-10 * total, "{name}: {multiplier} {lower}");
            assert!((pressure - gap_force).abs() < 1e-10 * total, "{name}: {pressure}");
            match has_pressure {
                true => assert!(gap_force > 0.1 * total, "{name} {gap}: {resultants:?}"),
                false => assert_eq!([gap_force, pressure], [0.0; 2], "{name} {gap}"),
            }
        }
    }
}

/// A vertex of two groups with the same gap is divided by the measure of their facets; one of two gaps belongs to the
/// higher one.
#[test]
fn a_vertex_of_two_groups_is_divided_by_their_facets() {
    let corner = Point::<2>::new(1.0, 2.0);
    let sides = [(0, 0, BoundaryCondition::Contact), (1, 0, BoundaryCondition::Contact)];
    let others = [(0, 1, BoundaryCondition::Neumann), (1, 1, BoundaryCondition::Neumann)];
    let domain = BoxDomain::dirichlet(Point::zeros(), corner);
    let domain = sides.iter().chain(&others).fold(domain, |d, &(k, s, part)| d.side(k, s, part));
    let mesh = Mesh::<2>::kuhn_box(&domain, [1, 1]).unwrap();
    for (gap, share) in [(0.0, 1.0 / 3.0), (-0.2, 0.0)] {
        let problem = Problem::new().constant_source(-1.0);
        let problem = problem.signorini_on("left", 0.0).signorini_on("bottom", gap);
        let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.converged(), "{}", solved.outcome());
        let multiplier = solved.multiplier().unwrap();
        let at = |x: f64, y: f64| {
            let vertex = |p: &Point<2>| (p - Point::<2>::new(x, y)).norm() < 1e-12;
            multiplier[mesh.vertices().iter().position(vertex).unwrap()]
        };
        let resultants = solved.resultants().unwrap();
        let bottom = at(1.0, 0.0) + share * at(0.0, 0.0);
        let left = at(0.0, 2.0) + (1.0 - share) * at(0.0, 0.0);
        assert!((resultants["bottom"] - bottom).abs() < 1e-12, "{resultants:?} {bottom}");
        assert!((resultants["left"] - left).abs() < 1e-12, "{resultants:?} {left}");
        assert!((bottom + left - 2.0).abs() < 1e-12 && at(0.0, 0.0) > 0.1);
    }
}

/// A quadratic that touches a bound at all vertices of a unit box with one cell along each axis lies beyond it by a quarter
/// in the middle of edges, whatever bound it is; where a solution keeps away from it, that distance has the other sign.
#[test]
fn penetration_is_that_between_the_nodes() {
    fn check<const D: usize>() {
        let contact = (D - 1, 0, BoundaryCondition::Contact);
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let domain = domain.side(contact.0, contact.1, contact.2);
        let mesh = Mesh::<D>::kuhn_box(&domain, [1; D]).unwrap();
        let of = |problem: Problem<D>, scheme: &dyn Scheme<D>, u: fn(f64) -> f64| {
            let space = scheme.discretise(&problem, &mesh, DataQuadrature::default()).unwrap();
            // unknowns belong to vertices and to the middles of edges
            let node = |vertices: &[u32]| {
                let sum: f64 = vertices.iter().map(|&v| mesh.vertices()[v as usize][0]).sum();
                sum / vertices.len() as f64
            };
            let values: Vec<f64> =
                space.locations().iter().map(|location| u(node(location.vertices()))).collect();
            space.penetration(&values).unwrap().unwrap().largest()
        };
        let free = || Problem::<D>::new().constant_source(-1.0);
        let (p1, p2): (&dyn Scheme<D>, &dyn Scheme<D>) = (&ConformingP1, &ConformingP2);
        let close = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-14, "{found}");
        close(of(free().obstacle_below(|_| 0.0), p2, |x| x * x - x), 0.25);
        close(of(free().obstacle_above(|_| 0.0), p2, |x| x - x * x), 0.25);
        close(of(free().obstacle_below(|_| 0.0), p1, |_| 0.5), -0.5);
        // the chord of a concave parabola lies below it
        close(of(free().obstacle_below(|x| -x[0] * x[0]), p1, |x| -x), 0.25);
        if D > 1 {
            close(of(free().signorini(|_| 0.0), p2, |x| x * x - x), 0.25);
            close(of(free().signorini(|x| -x[0] * x[0]), p1, |x| -x), 0.25);
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}
