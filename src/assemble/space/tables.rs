//! Basis functions tabulated once per assembly: the small arrays that hot loops read.

use crate::arrays::map_entries;
use crate::element::{MAX_BASIS, ReferenceElement};
use crate::quadrature::{OrthonormalPolynomials, Rule, facet_to_cell};
use crate::real::Real;

/// Derivatives of all basis functions along barycentric coordinates.
pub(crate) type Derivatives<T> = [[T; 4]; MAX_BASIS];

/// Values and derivatives of all basis functions at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BasisAt<T> {
    pub values: [T; MAX_BASIS],
    pub derivatives: Derivatives<T>,
}

impl<T: Real> BasisAt<T> {
    pub fn new<E: ReferenceElement<T, D>, const D: usize>(point: &[f64; 4]) -> Self {
        let lambda = map_entries(*point, T::lit);
        let mut basis = Self::zero();
        E::values(&lambda[..=D], &mut basis.values);
        E::derivatives(&lambda[..=D], &mut basis.derivatives);
        basis
    }
    fn zero() -> Self {
        Self { values: [T::lit(0.0); MAX_BASIS], derivatives: [[T::lit(0.0); 4]; MAX_BASIS] }
    }
    fn add(&mut self, weight: T, other: &Self) {
        for i in 0..MAX_BASIS {
            self.values[i] += weight * other.values[i];
            for k in 0..4 {
                self.derivatives[i][k] += weight * other.derivatives[i][k];
            }
        }
    }
}

/// A cell rule with the basis at its points.
pub(crate) struct CellTable<T> {
    pub points: Vec<[T; 4]>,
    pub weights: Vec<T>,
    pub basis: Vec<BasisAt<T>>,
}

impl CellTable<f64> {
    /// The table of a basis.
    pub fn new(rule: Rule, basis: fn(&[f64; 4]) -> BasisAt<f64>) -> Self {
        let Rule { points, weights } = rule;
        Self { basis: points.iter().map(basis).collect(), points, weights }
    }
    /// The table, its numbers rounded to another scalar.
    pub fn rounded<T: Real>(&self) -> CellTable<T> {
        CellTable {
            points: self.points.iter().map(|p| map_entries(*p, T::lit)).collect(),
            weights: self.weights.iter().map(|&w| T::lit(w)).collect(),
            basis: self.basis.iter().map(BasisAt::rounded).collect(),
        }
    }
}

/// Moments of the basis on each facet of a cell, against orthonormal polynomials on the facet.
pub(crate) struct FacetTable<T> {
    /// Degree of each moment, ascending.
    pub degrees: Vec<usize>,
    /// By facet, then by moment.
    basis: Vec<BasisAt<T>>,
}

impl<T: Real> FacetTable<T> {
    /// Moments up to a degree of a basis of some degree.
    pub fn new(
        dimension: usize,
        basis_degree: usize,
        basis: fn(&[f64; 4]) -> BasisAt<f64>,
        degree: usize,
    ) -> Self {
        let polynomials = OrthonormalPolynomials::new(dimension - 1, degree);
        let rule = Rule::new(dimension - 1, degree + basis_degree);
        let moment = |local: usize, k: usize| {
            let mut moment = BasisAt::zero();
            for (point, w) in rule.iter() {
                moment.add(w * polynomials.value(k, point), &basis(&facet_to_cell(point, local)));
            }
            // derivatives have no moments of the element's own degree: what is left is rounding
            if polynomials.degree(k) >= basis_degree {
                moment.derivatives = BasisAt::zero().derivatives;
            }
            moment.rounded()
        };
        let n = polynomials.len();
        Self {
            degrees: (0..n).map(|k| polynomials.degree(k)).collect(),
            basis: (0..(dimension + 1) * n).map(|i| moment(i / n, i % n)).collect(),
        }
    }
    /// The moments on facet `local`.
    #[inline(always)]
    pub fn on(&self, local: usize) -> &[BasisAt<T>] {
        let n = self.degrees.len();
        &self.basis[local * n..(local + 1) * n]
    }
}

impl BasisAt<f64> {
    /// The values and derivatives, rounded to another scalar.
    pub fn rounded<T: Real>(&self) -> BasisAt<T> {
        BasisAt {
            values: map_entries(self.values, T::lit),
            derivatives: map_entries(self.derivatives, |row| map_entries(row, T::lit)),
        }
    }
    /// The function with these coefficients.
    #[inline(always)]
    pub fn value(&self, coefficients: &[f64; MAX_BASIS]) -> f64 {
        coefficients.iter().zip(&self.values).map(|(c, v)| c * v).sum()
    }
    /// The basis of an element over `T`, in `f64`.
    pub fn new_in_f64<T: Real, E: ReferenceElement<T, D>, const D: usize>(
        point: &[f64; 4],
    ) -> Self {
        let basis = BasisAt::<T>::new::<E, D>(point);
        Self {
            values: map_entries(basis.values, T::to_f64),
            derivatives: map_entries(basis.derivatives, |row| map_entries(row, T::to_f64)),
        }
    }
}
