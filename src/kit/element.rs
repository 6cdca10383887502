//! The laws of a reference element.

use super::error::{Fault, KitError, KitErrorKind, Law};
use super::report::LawReport;
use crate::element::{Element, Entity, Layout, MAX_BASIS, Node};
use crate::mesh::edge_vertices;
use crate::quadrature::Rule;

/// Largest deviation of values and derivatives.
const TOLERANCE: f64 = 256.0 * f64::EPSILON;

/// Step of differences, a power of two, so that the step itself is not rounded.
const STEP: f64 = 0.125;

/// A functional as barycentric points with weights.
type Terms = Vec<([f64; 4], f64)>;

/// An element and the points at which its laws are tested.
struct Tested<'e, const D: usize> {
    element: &'e dyn Element<D>,
    functions: usize,
    nodes: Vec<Node>,
    /// By node, its functional, exact for the basis.
    terms: Vec<Terms>,
    points: Vec<[f64; 4]>,
}

/// Tests [`Law::Element`]. Derivatives are compared along the simplex, as they enter gradients.
///
/// # Errors
/// [`KitErrorKind::TooManyFunctions`], [`KitErrorKind::NotANumber`], [`KitErrorKind::NotDual`],
/// [`KitErrorKind::NodeElsewhere`], [`KitErrorKind::NotPartitionOfUnity`], [`KitErrorKind::PolynomialMissing`],
/// [`KitErrorKind::DegreeExceeded`], [`KitErrorKind::WrongDerivative`].
pub fn check_element<const D: usize>(element: &dyn Element<D>) -> Result<LawReport, KitError> {
    Law::Element.named(check(element))
}

pub(super) fn check<const D: usize>(element: &dyn Element<D>) -> Result<LawReport, Fault> {
    let functions = element.per_cell();
    if functions > MAX_BASIS {
        let message = format!(
            "the layout owns {functions} unknowns of a cell, at most {MAX_BASIS} are allowed"
        );
        return Err(Fault::new(KitErrorKind::TooManyFunctions, message));
    }
    Tested::new(element).check()
}

/// A functional, as points with weights, at a function.
fn apply(terms: &Terms, f: &dyn Fn(&[f64; 4]) -> f64) -> f64 {
    terms.iter().map(|(point, weight)| weight * f(point)).sum()
}

/// A polynomial of this degree without symmetries of the simplex.
fn polynomial(degree: usize, point: &[f64; 4]) -> f64 {
    let [a, b, c, d] = point;
    (0.9 * a - 0.7 * b + 0.4 * c - 1.1 * d).powi(degree as i32)
}

impl<'e, const D: usize> Tested<'e, D> {
    fn new(element: &'e dyn Element<D>) -> Self {
        let (nodes, points) = (element.nodes(), Rule::new(D, 5).points);
        let facet_rule = Rule::new(D - 1, element.basis_degree());
        let terms = nodes.iter().map(|node| node.terms(&facet_rule)).collect();
        Self { element, functions: nodes.len(), nodes, terms, points }
    }

    // not numbers at first, so that an entry left unwritten is no zero that happens to be right

    fn values_at(&self, point: &[f64; 4]) -> [f64; MAX_BASIS] {
        let mut out = [f64::NAN; MAX_BASIS];
        self.element.values(&point[..=D], &mut out[..self.functions]);
        out
    }

    fn derivatives_at(&self, point: &[f64; 4]) -> [[f64; 4]; MAX_BASIS] {
        let mut out = [[0.0; 4]; MAX_BASIS];
        out.iter_mut().for_each(|row| row[..=D].fill(f64::NAN));
        self.element.derivatives(&point[..=D], &mut out[..self.functions]);
        out
    }

    fn check(&self) -> Result<LawReport, Fault> {
        self.numbers()?;
        // means of basis functions are taken by rules for the degree of the basis
        self.basis_degree()?;
        let duality = self.duality()?;
        self.owners()?;
        let interpolation = self.interpolation()?;
        let derivatives = self.derivatives()?;
        let (functions, degree) = (self.functions, self.element.degree());
        let sentence = format!(
            "{functions} functions of degree {degree}, duality {duality:.1e}, interpolation {interpolation:.1e}, derivatives {derivatives:.1e}"
        );
        let figures = [
            ("functions", functions as f64),
            ("degree", degree as f64),
            ("duality", duality),
            ("interpolation", interpolation),
            ("derivatives", derivatives),
        ];
        Ok(LawReport::new(Law::Element, sentence, &figures))
    }

    /// Every function that the layout has an unknown for is written.
    fn numbers(&self) -> Result<(), Fault> {
        for point in &self.points {
            let values = self.values_at(point);
            if let Some(function) = values[..self.functions].iter().position(|v| v.is_nan()) {
                let at = self.describe(point);
                let message = format!("basis function {function} is not a number at {at}");
                return Err(Fault::new(KitErrorKind::NotANumber, message));
            }
        }
        Ok(())
    }

    fn duality(&self) -> Result<f64, Fault> {
        let mut largest: f64 = 0.0;
        for (i, terms) in self.terms.iter().enumerate() {
            for j in 0..self.functions {
                let function = |point: &[f64; 4]| self.values_at(point)[j];
                let found = apply(terms, &function);
                let expected = f64::from(u8::from(i == j));
                let difference = (found - expected).abs();
                if !within(difference, TOLERANCE) {
                    let message =
                        format!("node {i} of basis function {j} is {found:.6}, not {expected}");
                    return Err(Fault::new(KitErrorKind::NotDual, message));
                }
                largest = largest.max(difference);
            }
        }
        Ok(largest)
    }

    /// Nodes of shared unknowns are tied to the vertex, edge or facet that owns the unknown.
    fn owners(&self) -> Result<(), Fault> {
        let Layout { vertex, edge, facet, .. } = self.element.layout();
        let d = D;
        let repeat = |n: usize, of: fn(usize) -> Entity, each: usize| {
            (0..n).flat_map(move |k| std::iter::repeat_n(of(k), each))
        };
        let owners = repeat(d + 1, Entity::Vertex, vertex)
            .chain(repeat(edge_vertices(d).len(), Entity::Edge, edge))
            .chain(repeat(d + 1, Entity::Facet, facet));
        let vertices = |entity: Entity| (0..=d).map(move |k| entity.contains(d, k));
        for (node, (tied, owner)) in self.nodes.iter().zip(owners).enumerate() {
            let entity = tied.entity();
            if !vertices(entity).eq(vertices(owner)) {
                let message =
                    format!("node {node} is tied to {entity:?}, its unknown belongs to {owner:?}");
                return Err(Fault::new(KitErrorKind::NodeElsewhere, message));
            }
        }
        Ok(())
    }

    /// Rules that integrate products of polynomials of the stated degree are exact for the squares
    /// of basis functions.
    fn basis_degree(&self) -> Result<(), Fault> {
        let stated = self.element.basis_degree();
        let [rule, finer] = [2 * stated, 2 * stated + 6].map(|k| Rule::new(D, k));
        for function in 0..self.functions {
            let square = |point: &[f64; 4]| self.values_at(point)[function].powi(2);
            let mean = |rule: &Rule| rule.iter().map(|(p, w)| w * square(p)).sum::<f64>();
            let (found, expected) = (mean(&rule), mean(&finer));
            if !within(found - expected, TOLERANCE) {
                let message = format!(
                    "a rule for basis functions of degree {stated} gives {found:.6e} for the mean of the square of function {function}, which is {expected:.6e}: state the degree of the basis as `basis_degree`"
                );
                return Err(Fault::new(KitErrorKind::DegreeExceeded, message));
            }
        }
        Ok(())
    }

    /// Partition of unity is the case of degree zero, with an error of its own kind.
    fn interpolation(&self) -> Result<f64, Fault> {
        let mut largest: f64 = 0.0;
        for point in &self.points {
            let values = self.values_at(point);
            let sum: f64 = values[..self.functions].iter().sum();
            if !within(sum - 1.0, TOLERANCE) {
                let at = self.describe(point);
                let message = format!("at {at} the basis functions sum to {sum:.6}, not to one");
                return Err(Fault::new(KitErrorKind::NotPartitionOfUnity, message));
            }
            for degree in 0..=self.element.degree() {
                let f = |point: &[f64; 4]| polynomial(degree, point);
                let of_node = |(terms, value): (&Terms, &f64)| value * apply(terms, &f);
                let interpolant: f64 = self.terms.iter().zip(&values).map(of_node).sum();
                let difference = interpolant - f(point);
                if !within(difference, TOLERANCE) {
                    let (stated, at) = (self.element.degree(), self.describe(point));
                    let message = format!(
                        "a polynomial of degree {degree} differs by {difference:.3e} from its interpolant at {at}, although the element is said to be of degree {stated}"
                    );
                    return Err(Fault::new(KitErrorKind::PolynomialMissing, message));
                }
                largest = largest.max(difference.abs());
            }
        }
        Ok(largest)
    }

    fn derivatives(&self) -> Result<f64, Fault> {
        let mut largest: f64 = 0.0;
        for point in &self.points {
            let rows = self.derivatives_at(point);
            for from in 0..=D {
                for to in 0..from {
                    let along = self.difference(point, from, to);
                    for (function, row) in rows[..self.functions].iter().enumerate() {
                        let (stated, difference) = (row[to] - row[from], along[function]);
                        if !within(stated - difference, TOLERANCE / STEP) {
                            let at = self.describe(point);
                            let message = format!(
                                "basis function {function} has derivative {stated:.6} at {at} from vertex {from} to vertex {to}, differences give {difference:.6}"
                            );
                            return Err(Fault::new(KitErrorKind::WrongDerivative, message));
                        }
                        largest = largest.max((stated - difference).abs());
                    }
                }
            }
        }
        Ok(largest)
    }

    /// Differences of all functions from one vertex towards another, of an order that is exact for the
    /// degree of the basis.
    fn difference(&self, point: &[f64; 4], from: usize, to: usize) -> [f64; MAX_BASIS] {
        let at = |steps: f64| {
            let mut moved = *point;
            moved[from] -= steps * STEP;
            moved[to] += steps * STEP;
            self.values_at(&moved)
        };
        let n = self.element.basis_degree().div_ceil(2).max(2);
        let mut sum = [0.0; MAX_BASIS];
        // the weights of central differences with 2 n + 1 points
        let mut weight = 1.0;
        for k in 1..=n {
            weight *= -((n + 1 - k) as f64) / (n + k) as f64;
            let (ahead, back) = (at(k as f64), at(-(k as f64)));
            for i in 0..self.functions {
                sum[i] -= weight * (ahead[i] - back[i]) / (k as f64 * STEP);
            }
        }
        sum
    }

    fn describe(&self, point: &[f64; 4]) -> String {
        let coordinates: Vec<String> = point[..=D].iter().map(|b| format!("{b:.3}")).collect();
        format!("({})", coordinates.join(", "))
    }
}

/// Whether a difference is at most the tolerance; false for one that is not a number.
fn within(difference: f64, tolerance: f64) -> bool {
    difference.abs() <= tolerance
}
