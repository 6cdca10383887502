//! Basis functions tabulated once per assembly: the small arrays that hot loops read.

use crate::element::{MAX_BASIS, ReferenceElement};
use crate::quadrature::{OrthonormalPolynomials, Rule, insert};
use crate::real::Real;

/// Values and derivatives of all basis functions at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BasisAt<T> {
    pub values: [T; MAX_BASIS],
    pub derivatives: [[T; 4]; MAX_BASIS],
}

impl<T: Real> BasisAt<T> {
    pub fn new<E: ReferenceElement<T, D>, const D: usize>(point: &[f64; 4]) -> Self {
        let lambda = point.map(T::lit);
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

impl<T: Real> CellTable<T> {
    pub fn new<E: ReferenceElement<T, D>, const D: usize>(degree: usize) -> Self {
        let rule = Rule::of_degree(D, degree);
        Self {
            points: rule.points.iter().map(|p| p.map(T::lit)).collect(),
            weights: rule.weights.iter().map(|&w| T::lit(w)).collect(),
            basis: rule.points.iter().map(BasisAt::new::<E, D>).collect(),
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
    /// Moments up to a degree.
    pub fn new<E: ReferenceElement<T, D>, const D: usize>(degree: usize) -> Self {
        let polynomials = OrthonormalPolynomials::new(D - 1, degree);
        let rule = Rule::of_degree(D - 1, degree + E::DEGREE);
        let moment = |local: usize, k: usize| {
            let mut moment = BasisAt::zero();
            for (point, w) in rule.iter() {
                let basis = BasisAt::<T>::new::<E, D>(&insert(point, local));
                moment.add(T::lit(w * polynomials.value(k, point)), &basis);
            }
            // derivatives have no moments of the element's own degree: what is left is rounding
            if polynomials.degree(k) >= E::DEGREE {
                moment.derivatives = BasisAt::zero().derivatives;
            }
            moment
        };
        let all = 0..polynomials.len();
        Self {
            degrees: all.clone().map(|k| polynomials.degree(k)).collect(),
            basis: (0..=D)
                .flat_map(|local| all.clone().map(move |k| (local, k)))
                .map(|(local, k)| moment(local, k))
                .collect(),
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
            values: basis.values.map(T::to_f64),
            derivatives: basis.derivatives.map(|row| row.map(T::to_f64)),
        }
    }
}
