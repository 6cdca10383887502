//! Elements made outside the crate: cubics, continuous and broken.

use std::sync::Arc;

use crate::runs::own_scene;
use crate::support::checks::Checks;
use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::element::{Entity, Layout, Node};
use unilateral::facet::LocalFluxes;
use unilateral::inequality::{ActiveSet, InequalitySolver};
use unilateral::kit::{Law, check_scheme};
use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::prelude::*;

/// Continuous cubics: values at the vertices, at the thirds of edges and at the barycentres of
/// triangles.
#[derive(Clone, Copy, Debug)]
pub struct P3;

const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

/// The linear factors of a basis function: a vertex `i` and a number `m` stand for `3 l_i - m`.
/// Their product over the values at the node is the function.
fn factors(dimension: usize, i: usize) -> [(usize, f64); 3] {
    let edges = dimension * (dimension + 1) / 2;
    let inside = |i: usize| -> [usize; 3] {
        match (dimension, i) {
            (2, _) | (_, 3) => [0, 1, 2],
            (_, 0) => [1, 2, 3],
            (_, 1) => [0, 2, 3],
            _ => [0, 1, 3],
        }
    };
    match i.checked_sub(dimension + 1) {
        None => [(i, 0.0), (i, 1.0), (i, 2.0)],
        Some(k) if k < 2 * edges => {
            let [a, b] = EDGES[k / 2];
            // the first third is the node nearer to the first vertex
            let (near, far) = if k % 2 == 0 { (a, b) } else { (b, a) };
            [(near, 0.0), (near, 1.0), (far, 0.0)]
        }
        Some(k) => inside(k - 2 * edges).map(|v| (v, 0.0)),
    }
}

/// The product of the factors at the node of a function.
fn at_node(dimension: usize, i: usize) -> f64 {
    let vertices = dimension + 1;
    match i {
        _ if i < vertices => 6.0,
        _ if i < vertices + dimension * vertices => 2.0,
        _ => 1.0,
    }
}

impl<const D: usize> Element<D> for P3 {
    fn degree(&self) -> usize {
        3
    }
    fn layout(&self) -> Layout {
        Layout {
            vertex: 1,
            edge: 2,
            facet: if D == 3 { 1 } else { 0 },
            cell: if D == 2 { 1 } else { 0 },
        }
    }

    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        for (i, value) in out.iter_mut().enumerate() {
            let factor = |(v, m): (usize, f64)| 3.0 * lambda[v] - m;
            let [a, b, c] = factors(D, i).map(factor);
            *value = a * b * c / at_node(D, i);
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        for (i, row) in out.iter_mut().enumerate() {
            let of = factors(D, i);
            let [a, b, c] = of.map(|(v, m)| 3.0 * lambda[v] - m);
            *row = [0.0; 4];
            for ((v, _), others) in of.into_iter().zip([b * c, a * c, a * b]) {
                row[v] += (3.0 / at_node(D, i)) * others;
            }
        }
    }
    fn node(&self, i: usize) -> Node {
        let edges = D * (D + 1) / 2;
        match i.checked_sub(D + 1) {
            None => Node::vertex(i),
            Some(k) if k < 2 * edges => Node::on_edge(k / 2, (1 + k % 2) as f64 / 3.0),
            Some(k) => {
                let mut point = [0.0; 4];
                factors(D, i).iter().for_each(|&(v, _)| point[v] = 1.0 / 3.0);
                let entity = if D == 2 { Entity::Cell } else { Entity::Facet(k - 2 * edges) };
                Node::value(entity, point)
            }
        }
    }
}

pub struct ConformingP3;

impl<const D: usize> Scheme<D> for ConformingP3 {
    fn name(&self) -> &str {
        "p3"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(P3)
    }
}

/// Equations with the solution `exp(a . x)` on the unit box.
fn equation<const D: usize>() -> scenes::Scene<D> {
    let along = || Point::<D>::from_fn(|k, _| [0.9, -0.6, 0.5][k]);
    let value = move |x: &Point<D>| along().dot(x).exp();
    let problem = Problem::new()
        .exact(value, move |x| along() * value(x))
        .source(move |x| -along().norm_squared() * value(x));
    own_scene("exponential", BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), problem)
}

/// Orders of broken and continuous cubics on an equation: four in L2, three in H1.
fn orders<const D: usize>(levels: [usize; 2]) {
    let study = Study::<D>::new(equation()).scheme(Sipg::default().on(P3)).scheme(ConformingP3);
    let rows = study.levels(levels).run().unwrap().rows;
    let mut checks = Checks::default();
    let finest: Vec<_> = rows.iter().filter(|row| row.level == levels[1]).collect();
    assert_eq!(finest.len(), 2);
    for row in finest {
        let [l2, h1] = [row.order.l2, row.order.h1].map(|order| order.unwrap_or(f64::NAN));
        let holds = (l2 - 4.0).abs() < 0.15 && (h1 - 3.0).abs() < 0.15;
        checks.that(holds, || format!("{} in {D}d: L2 {l2:.3}, H1 {h1:.3}", row.scheme));
        checks.certified(row, 1e-9);
    }
    checks.finish();
}

#[test]
fn cubics_have_orders_four_and_three() {
    orders::<1>([8, 16]);
    orders::<2>([8, 16]);
    orders::<3>([2, 4]);
}

fn kit<const D: usize>() {
    let report = check_scheme::<D>(&Sipg::default().on(P3)).unwrap_or_else(|e| panic!("{e}"));
    let functions = report.figure(Law::Element, "functions");
    assert_eq!((&report.scheme[..], functions), ("sipg-p3", Some([4.0, 10.0, 20.0][D - 1])));
    check_scheme::<D>(&ConformingP3).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn cubics_pass_the_kit() {
    kit::<1>();
    kit::<2>();
    kit::<3>();
}

/// The penalty by lifts of single facets knows every degree.
#[test]
fn lifts_of_cubics_pass_the_kit() {
    check_scheme::<2>(&Br2::default().on(P3)).unwrap_or_else(|e| panic!("{e}"));
}

/// With a constant obstacle above zero load, bounds at nodes hold at the nodes, and multipliers and
/// contact are those of linears up to the size of a cell.
#[test]
fn cubics_run_beside_linears_on_an_obstacle() {
    let scene = scenes::radial::<2>(1.0);
    let study = Study::<2>::new(scene).scheme(ConformingP1).scheme(ConformingP3);
    let rows = study.scheme(Sipg::default().on(P3)).levels([16]).run().unwrap().rows;
    let linear = rows[0].error.h1.unwrap();
    for row in &rows[1..] {
        assert_eq!(row.constraint, "nodes");
        assert!(row.certificate.largest() < 1e-9, "{row:?}");
        assert!(row.error.h1.unwrap() < 0.5 * linear, "{}: {:?} {linear}", row.scheme, row.error);
    }
}

#[test]
fn multipliers_of_cubics_balance_the_load() {
    // a load that presses everything but a layer at the boundary onto the obstacle
    let problem = Problem::<2>::new().constant_source(-40.0).obstacle_below(|_| -0.1);
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [8, 8]).unwrap();
    let space =
        Discretisation::new(&ConformingP3, &problem, &mesh, DataQuadrature::default()).unwrap();
    let inequality = space.inequality().unwrap();
    let solution = ActiveSet::default().solve(&inequality);
    let in_contact = solution.contact.iter().filter(|&&c| c == Contact::Lower).count();
    assert!(in_contact > inequality.size() / 3, "{in_contact} of {}", inequality.size());
    for (k, location) in inequality.locations.iter().enumerate() {
        // an unknown at a third of an edge counts the nearer end twice
        let vertices = location.vertices();
        let sum = vertices.iter().map(|&v| mesh.vertices()[v as usize]).sum::<Point<2>>();
        let node = sum / vertices.len() as f64;
        assert!([1, 3].contains(&vertices.len()), "unknown {k} at {node}: {vertices:?}");
    }
    let density = space.fields(&inequality, &solution).multiplier;
    // tested with the hat functions the multiplier is the load where there is contact all around
    let is_middle = |cell: &usize| (mesh.barycentre(*cell) - Point::repeat(0.5)).norm() < 0.1;
    let amid: Vec<f64> = (0..mesh.n_cells()).filter(is_middle).map(|cell| density[cell]).collect();
    assert!(!amid.is_empty() && amid.iter().all(|d| (d - 40.0).abs() < 1e-6), "{amid:?}");
}

/// Beside a gap of one half that stays open.
#[test]
fn fields_of_contact_have_the_gap_that_is_left() {
    let mut square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    square.sides[0] = [BoundaryCondition::Neumann; 2];
    square.sides[1][0] = BoundaryCondition::Contact;
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let fields = |gap: f64| {
        let problem = Problem::<2>::new().dirichlet(|_| 1.0).signorini(move |_| gap);
        solve(&problem, &mesh, &ConformingP1).unwrap().fields().unwrap()
    };
    // the membrane is flat: it stays half a unit above the gap
    let open = fields(0.5);
    assert_eq!(open.gap.len(), 4);
    assert!(open.gap.iter().all(|gap| (gap - 0.5).abs() < 1e-12), "{:?}", open.gap);
    assert!(open.discrete_contact.facets.is_empty());
    // a gap above it lifts it
    let lifted = fields(1.5);
    assert!(lifted.gap.iter().all(|gap| *gap <= 1e-12) && !lifted.pressure.is_empty());
}

/// The most functions in a cell, all zero, with the form that couples most cells.
#[derive(Clone, Copy, Debug)]
struct Most;

impl Element<3> for Most {
    fn degree(&self) -> usize {
        2
    }
    fn layout(&self) -> Layout {
        Layout::in_cells(20)
    }
    fn node(&self, i: usize) -> Node {
        Node::vertex(i % 4)
    }
    fn values(&self, _: &[f64], _: &mut [f64]) {}
    fn derivatives(&self, _: &[f64], _: &mut [[f64; 4]]) {}
}

impl Scheme<3> for Most {
    fn name(&self) -> &str {
        "most"
    }
    fn element(&self) -> Arc<dyn Element<3>> {
        Arc::new(*self)
    }
    fn form(&self, _: &Mesh<3>) -> Box<dyn FacetForm<3>> {
        Box::new(LocalFluxes { eta: 1.0, switch: false, lifts: Lifts::default() })
    }
}

/// Twenty unknowns in each of seventeen cells.
#[test]
fn matrices_that_32_bit_numbers_do_not_count_are_refused_before_they_are_made() {
    let unit = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let refused = |cubes: [usize; 3]| {
        let mesh = Mesh::<3>::kuhn_box(&unit, cubes).unwrap();
        let problem = Problem::new();
        Discretisation::new(&Most, &problem, &mesh, DataQuadrature::default()).err()
    };
    let error = refused([52, 45, 45]).unwrap().to_string();
    assert!(error.starts_with("entries of the matrix = 4296240000: at most 4294967295"), "{error}");
    assert!(refused([52, 46, 44]).is_none());
}
