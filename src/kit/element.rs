//! The laws of a reference element.

use super::error::KitError;
use super::report::ElementReport;
use crate::element::{Layout, MAX_BASIS, Node, ReferenceElement};
use crate::mesh::edge_vertices;
use crate::quadrature::{Rule, insert};
use crate::real::Real;

/// Rounding units that values and derivatives may be off.
const UNITS: f64 = 256.0;

/// Step of differences; with five points they are exact for polynomials of degree four, and a
/// power of two adds no rounding of its own.
const STEP: f64 = 0.125;

/// An element without its type.
struct Probe {
    dimension: usize,
    functions: usize,
    degree: usize,
    layout: Layout,
    nodes: Vec<Node>,
    values: fn(&[f64; 4]) -> [f64; MAX_BASIS],
    derivatives: fn(&[f64; 4]) -> [[f64; 4]; MAX_BASIS],
}

/// Checks the element on its own: as many unknowns as the layout owns, nodes dual to basis
/// functions, partition of unity, polynomials of its degree in its span, derivatives those of the
/// values. Derivatives are compared along the simplex only, all that enters a gradient.
///
/// # Errors
/// [`KitError::LayoutCount`], [`KitError::NotDual`], [`KitError::NotPartitionOfUnity`],
/// [`KitError::PolynomialMissing`], [`KitError::WrongDerivative`].
pub fn check_element<T: Real, const D: usize, E: ReferenceElement<T, D>>()
-> Result<ElementReport, KitError> {
    if E::N > MAX_BASIS {
        let owned = owned(E::LAYOUT, D);
        return Err(KitError::LayoutCount { owned, functions: E::N, limit: MAX_BASIS });
    }
    let probe = Probe {
        dimension: D,
        functions: E::N,
        degree: E::DEGREE,
        layout: E::LAYOUT,
        nodes: (0..E::N).map(E::node).collect(),
        values: values::<T, D, E>,
        derivatives: derivatives::<T, D, E>,
    };
    probe.check(UNITS * T::EPSILON)
}

fn values<T: Real, const D: usize, E: ReferenceElement<T, D>>(
    point: &[f64; 4],
) -> [f64; MAX_BASIS] {
    let mut out = [T::lit(0.0); MAX_BASIS];
    E::values(&point.map(T::lit)[..=D], &mut out);
    out.map(T::to_f64)
}

fn derivatives<T: Real, const D: usize, E: ReferenceElement<T, D>>(
    point: &[f64; 4],
) -> [[f64; 4]; MAX_BASIS] {
    let mut out = [[T::lit(0.0); 4]; MAX_BASIS];
    E::derivatives(&point.map(T::lit)[..=D], &mut out);
    out.map(|row| row.map(T::to_f64))
}

/// The unknowns of a cell, its own and those it shares.
fn owned(layout: Layout, dimension: usize) -> usize {
    // taken apart, so that an owner that is added later cannot be forgotten here
    let Layout { vertex, edge, facet, cell } = layout;
    (dimension + 1) * (vertex + facet) + dimension * (dimension + 1) / 2 * edge + cell
}

/// A node as what it is: a functional.
fn apply(node: Node, dimension: usize, degree: usize, f: &dyn Fn(&[f64; 4]) -> f64) -> f64 {
    match node {
        Node::Vertex(k) => {
            let mut point = [0.0; 4];
            point[k] = 1.0;
            f(&point)
        }
        Node::Edge(k) => {
            let mut point = [0.0; 4];
            edge_vertices(dimension)[k].iter().for_each(|&v| point[v] = 0.5);
            f(&point)
        }
        Node::CellMean => {
            Rule::of_degree(dimension, degree).iter().map(|(point, weight)| weight * f(point)).sum()
        }
        Node::FacetMean(k) => {
            let rule = Rule::of_degree(dimension - 1, degree);
            rule.iter().map(|(point, weight)| weight * f(&insert(point, k))).sum()
        }
    }
}

/// A polynomial of some degree on the simplex that no symmetry favours.
fn polynomial(degree: usize, point: &[f64; 4]) -> f64 {
    let [a, b, c, d] = point;
    (0.9 * a - 0.7 * b + 0.4 * c - 1.1 * d).powi(degree as i32)
}

impl Probe {
    fn check(&self, tolerance: f64) -> Result<ElementReport, KitError> {
        let &Self { dimension, functions, degree, layout, .. } = self;
        let owned = owned(layout, dimension);
        if owned != functions {
            return Err(KitError::LayoutCount { owned, functions, limit: MAX_BASIS });
        }
        Ok(ElementReport {
            functions,
            degree,
            duality: self.duality(tolerance)?,
            interpolation: self.interpolation(tolerance)?,
            derivatives: self.derivatives(tolerance)?,
        })
    }

    fn duality(&self, tolerance: f64) -> Result<f64, KitError> {
        let mut largest: f64 = 0.0;
        for (i, &node) in self.nodes.iter().enumerate() {
            for j in 0..self.functions {
                let function = |point: &[f64; 4]| (self.values)(point)[j];
                let found = apply(node, self.dimension, self.degree, &function);
                let expected = f64::from(u8::from(i == j));
                let difference = (found - expected).abs();
                if !within(difference, tolerance) {
                    return Err(KitError::NotDual { node: i, function: j, found, expected });
                }
                largest = largest.max(difference);
            }
        }
        Ok(largest)
    }

    /// Partition of unity is the case of degree zero, and has an error of its own.
    fn interpolation(&self, tolerance: f64) -> Result<f64, KitError> {
        let mut largest: f64 = 0.0;
        for point in &self.points() {
            let values = (self.values)(point);
            let sum: f64 = values[..self.functions].iter().sum();
            if !within(sum - 1.0, tolerance) {
                return Err(KitError::NotPartitionOfUnity { at: self.describe(point), sum });
            }
            for degree in 0..=self.degree {
                let f = |point: &[f64; 4]| polynomial(degree, point);
                let nodes = self.nodes.iter().zip(&values);
                let interpolant: f64 = nodes
                    .map(|(&node, value)| value * apply(node, self.dimension, self.degree, &f))
                    .sum();
                let difference = interpolant - f(point);
                if !within(difference, tolerance) {
                    let (stated, at) = (self.degree, self.describe(point));
                    return Err(KitError::PolynomialMissing { degree, stated, at, difference });
                }
                largest = largest.max(difference.abs());
            }
        }
        Ok(largest)
    }

    fn derivatives(&self, tolerance: f64) -> Result<f64, KitError> {
        let mut largest: f64 = 0.0;
        for point in &self.points() {
            let rows = (self.derivatives)(point);
            for from in 0..=self.dimension {
                for to in 0..from {
                    let along = self.difference(point, from, to);
                    for (function, row) in rows[..self.functions].iter().enumerate() {
                        let (stated, difference) = (row[to] - row[from], along[function]);
                        if !within(stated - difference, tolerance / STEP) {
                            let at = self.describe(point);
                            return Err(KitError::WrongDerivative {
                                function,
                                at,
                                from,
                                to,
                                stated,
                                difference,
                            });
                        }
                        largest = largest.max((stated - difference).abs());
                    }
                }
            }
        }
        Ok(largest)
    }

    /// Differences of all functions from one vertex towards another.
    fn difference(&self, point: &[f64; 4], from: usize, to: usize) -> [f64; MAX_BASIS] {
        let at = |steps: f64| {
            let mut moved = *point;
            moved[from] -= steps * STEP;
            moved[to] += steps * STEP;
            (self.values)(&moved)
        };
        let [far_back, back, ahead, far_ahead] = [-2.0, -1.0, 1.0, 2.0].map(at);
        std::array::from_fn(|i| {
            (8.0 * (ahead[i] - back[i]) - (far_ahead[i] - far_back[i])) / (12.0 * STEP)
        })
    }

    /// The points at which functions are looked at.
    fn points(&self) -> Vec<[f64; 4]> {
        Rule::of_degree(self.dimension, 5).points
    }

    fn describe(&self, point: &[f64; 4]) -> String {
        let coordinates: Vec<String> =
            point[..=self.dimension].iter().map(|b| format!("{b:.3}")).collect();
        format!("({})", coordinates.join(", "))
    }
}

/// Written so that a number that is not finite is not within anything.
fn within(difference: f64, tolerance: f64) -> bool {
    difference.abs() <= tolerance
}
