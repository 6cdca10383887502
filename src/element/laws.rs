//! The laws of [`ReferenceElement`], held against every element in every dimension.

use super::{
    Broken, CrouzeixRaviart, MAX_BASIS, Node, P1, P2, QuadraticCellMean, ReferenceElement,
};
use crate::mesh::edge_vertices;
use crate::quadrature::{Rule, insert};

/// Points in and around the reference simplex; the coordinates sum to one.
fn points<const D: usize>() -> Vec<[f64; 4]> {
    let mut points = Rule::of_degree(D, 7).points;
    points.extend((0..=D).map(|k| std::array::from_fn(|i| f64::from(i == k))));
    // and one outside
    let mut outside = [1.75, -0.5, 0.25, -0.75];
    outside[D] = 1.0 - outside[..D].iter().sum::<f64>();
    points.push(outside);
    points.iter_mut().for_each(|p| p[D + 1..].fill(0.0));
    points
}

/// A function at a node.
fn at_node<const D: usize>(node: Node, f: &dyn Fn(&[f64; 4]) -> f64) -> f64 {
    let mut point = [0.0; 4];
    match node {
        Node::Vertex(k) => {
            point[k] = 1.0;
            f(&point)
        }
        Node::Edge(k) => {
            edge_vertices(D)[k].iter().for_each(|&v| point[v] = 0.5);
            f(&point)
        }
        Node::FacetMean(k) => {
            let rule = Rule::of_degree(D - 1, 4);
            rule.iter().map(|(point, weight)| weight * f(&insert(point, k))).sum()
        }
        Node::CellMean => Rule::of_degree(D, 4).iter().map(|(point, w)| w * f(point)).sum(),
    }
}

fn values<E: ReferenceElement<f64, D>, const D: usize>(point: &[f64; 4]) -> [f64; MAX_BASIS] {
    let mut values = [0.0; MAX_BASIS];
    E::values(&point[..=D], &mut values);
    values
}

fn check<E: ReferenceElement<f64, D>, const D: usize>() {
    assert_eq!(E::LAYOUT.per_cell(D), E::N, "as many functions as the layout owns");
    let nodes: Vec<Node> = (0..E::N).map(E::node).collect();
    // dual, hence unisolvent
    for (i, &node) in nodes.iter().enumerate() {
        for j in 0..E::N {
            let found = at_node::<D>(node, &|point| values::<E, D>(point)[j]);
            assert!((found - f64::from(i == j)).abs() < 1e-14, "{node:?} of function {j}: {found}");
        }
    }
    // all polynomials of the degree are reproduced, constants among them: a partition of unity
    for a in 0..=D {
        for b in 0..=D {
            let power = E::DEGREE as i32 - 1;
            let polynomial = |p: &[f64; 4]| if a == b { 1.0 } else { p[a] * p[b].powi(power) };
            let at_nodes: Vec<f64> =
                nodes.iter().map(|&node| at_node::<D>(node, &polynomial)).collect();
            for point in points::<D>() {
                let basis = values::<E, D>(&point);
                let sum: f64 = at_nodes.iter().zip(&basis).map(|(c, v)| c * v).sum();
                assert!((sum - polynomial(&point)).abs() < 1e-13, "{a} {b} at {point:?}: {sum}");
            }
        }
    }
    // differences about the middle are exact for quadratics, but for rounding
    let step = 0.25;
    for point in points::<D>() {
        let mut slopes = [[f64::NAN; 4]; MAX_BASIS];
        E::derivatives(&point[..=D], &mut slopes);
        for k in 0..=D {
            let moved = |by: f64| {
                let mut moved = point;
                moved[k] += by;
                values::<E, D>(&moved)
            };
            let (after, before) = (moved(step), moved(-step));
            for i in 0..E::N {
                let slope = (after[i] - before[i]) / (2.0 * step);
                assert!((slope - slopes[i][k]).abs() < 1e-13, "function {i}, coordinate {k}");
            }
        }
    }
}

fn check_all<const D: usize>() {
    check::<P1, D>();
    check::<P2, D>();
    check::<CrouzeixRaviart, D>();
    check::<QuadraticCellMean, D>();
    check::<Broken<P1>, D>();
    check::<Broken<P2>, D>();
    check::<Broken<CrouzeixRaviart>, D>();
}

#[test]
fn elements_obey_the_laws() {
    check_all::<1>();
    check_all::<2>();
    check_all::<3>();
}

#[test]
fn no_element_is_larger_than_the_largest() {
    assert_eq!(<P2 as ReferenceElement<f64, 3>>::N, MAX_BASIS);
    assert_eq!(<QuadraticCellMean as ReferenceElement<f64, 3>>::N, MAX_BASIS);
}
