//! Basis functions tabulated once per assembly: the small arrays that hot loops read.

use crate::element::{MAX_BASIS, ReferenceElement};
use crate::facet::Sampling;
use crate::quadrature::{Rule, insert};
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

/// Samples of the basis on each facet of a cell: at the points of a rule, or their means.
pub(crate) struct FacetTable<T> {
    pub weights: Vec<T>,
    /// By facet, then by sample.
    basis: Vec<BasisAt<T>>,
}

impl<T: Real> FacetTable<T> {
    pub fn new<E: ReferenceElement<T, D>, const D: usize>(sampling: Sampling) -> Self {
        let degree = match sampling {
            Sampling::Points(degree) => degree,
            Sampling::Means => E::DEGREE,
        };
        let rule = Rule::of_degree(D - 1, degree);
        let at =
            |local: usize| rule.points.iter().map(move |p| BasisAt::new::<E, D>(&insert(p, local)));
        match sampling {
            Sampling::Points(_) => Self {
                weights: rule.weights.iter().map(|&w| T::lit(w)).collect(),
                basis: (0..=D).flat_map(at).collect(),
            },
            Sampling::Means => {
                let mean = |local| {
                    let mut mean = BasisAt::zero();
                    for (basis, &w) in at(local).zip(&rule.weights) {
                        mean.add(T::lit(w), &basis);
                    }
                    mean
                };
                Self { weights: vec![T::lit(1.0)], basis: (0..=D).map(mean).collect() }
            }
        }
    }
    /// The samples on facet `local`.
    #[inline(always)]
    pub fn on(&self, local: usize) -> &[BasisAt<T>] {
        let n = self.weights.len();
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
