//! Basis functions tabulated once per assembly: the small arrays that hot loops read.

use crate::element::{Element, MAX_BASIS};
use crate::mesh::HalfFacet;
use crate::quadrature::{OrthonormalPolynomials, Rule, facet_to_cell};
use crate::real::Point;

/// Derivatives of all basis functions along barycentric coordinates.
pub(crate) type Derivatives = [[f64; 4]; MAX_BASIS];

/// Values and derivatives of all basis functions at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BasisAt {
    /// The number of basis functions: there is room for those of the largest element.
    n: usize,
    pub values: [f64; MAX_BASIS],
    pub derivatives: Derivatives,
}

impl BasisAt {
    /// The basis of an element at a point of the cell.
    pub fn new<const D: usize>(element: &dyn Element<D>, point: &[f64; 4]) -> Self {
        let n = element.per_cell();
        let mut basis = Self::zero(n);
        element.values(&point[..=D], &mut basis.values[..n]);
        element.derivatives(&point[..=D], &mut basis.derivatives[..n]);
        basis
    }
    /// The function with these coefficients.
    #[inline(always)]
    pub fn value(&self, coefficients: &[f64; MAX_BASIS]) -> f64 {
        coefficients.iter().zip(&self.values[..self.n]).map(|(c, v)| c * v).sum()
    }
    /// The gradient of the function with these coefficients, from the gradients of the barycentric coordinates.
    #[inline(always)]
    pub fn gradient<const D: usize>(
        &self,
        coefficients: &[f64],
        of_coordinates: &[Point<D>; 4],
    ) -> Point<D> {
        let mut gradient = Point::zeros();
        for (k, of_coordinate) in of_coordinates.iter().enumerate().take(D + 1) {
            let terms = coefficients.iter().zip(&self.derivatives[..self.n]);
            let slope: f64 = terms.map(|(c, d)| c * d[k]).sum();
            gradient += of_coordinate * slope;
        }
        gradient
    }
    fn zero(n: usize) -> Self {
        Self { n, values: [0.0; MAX_BASIS], derivatives: [[0.0; 4]; MAX_BASIS] }
    }
    fn add(&mut self, weight: f64, other: &Self) {
        for i in 0..MAX_BASIS {
            self.values[i] += weight * other.values[i];
            for k in 0..4 {
                self.derivatives[i][k] += weight * other.derivatives[i][k];
            }
        }
    }
}

/// A cell rule with the basis at its points.
pub(crate) struct CellTable {
    pub points: Vec<[f64; 4]>,
    pub weights: Vec<f64>,
    pub basis: Vec<BasisAt>,
}

impl CellTable {
    /// The table of the basis of an element.
    pub fn new<const D: usize>(rule: Rule, element: &dyn Element<D>) -> Self {
        let Rule { points, weights } = rule;
        let basis = points.iter().map(|point| BasisAt::new(element, point)).collect();
        Self { points, weights, basis }
    }
}

/// Moments of the basis on each facet of a cell, against orthonormal polynomials on the facet.
pub(crate) struct FacetTable {
    /// Degree of each moment, ascending.
    pub degrees: Vec<usize>,
    /// By facet, then by moment.
    basis: Vec<BasisAt>,
}

impl FacetTable {
    /// Moments of the basis of an element, up to a degree.
    pub fn new<const D: usize>(element: &dyn Element<D>, degree: usize) -> Self {
        let basis_degree = element.basis_degree();
        let polynomials = OrthonormalPolynomials::new(D - 1, degree);
        let rule = Rule::new(D - 1, degree + basis_degree);
        let moment = |local: usize, k: usize| {
            let mut moment = BasisAt::zero(element.per_cell());
            for (point, w) in rule.iter() {
                let basis = BasisAt::new(element, &facet_to_cell(point, local));
                moment.add(w * polynomials.value(k, point), &basis);
            }
            // derivatives have no moments of the element's own degree: what is left is rounding
            if polynomials.degree(k) >= basis_degree {
                moment.derivatives = [[0.0; 4]; MAX_BASIS];
            }
            moment
        };
        let n = polynomials.len();
        Self {
            degrees: (0..n).map(|k| polynomials.degree(k)).collect(),
            basis: (0..(D + 1) * n).map(|i| moment(i / n, i % n)).collect(),
        }
    }
    /// The moments on facet `local`.
    #[inline(always)]
    pub fn on(&self, local: usize) -> &[BasisAt] {
        let n = self.degrees.len();
        &self.basis[local * n..(local + 1) * n]
    }
}

/// A facet on which the form imposes data.
pub(crate) struct FacetDatum {
    pub facet: HalfFacet,
    /// The moments of the datum on the facet.
    pub moments: Vec<f64>,
}
