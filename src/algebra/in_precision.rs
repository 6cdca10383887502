//! An algebraic inequality rounded to another precision, entry by entry.

use super::bound::Bound;
use super::inequality::Inequality;
use super::kink::Kink;
use super::matrix::SparseMatrix;
use super::penalised_matrix::PenalisedMatrix;
use crate::memory::in_large_pages;
use crate::parallel::vectors::collect;
use crate::real::Real;

/// The numbers, each rounded to the nearest one of another scalar.
pub(crate) fn rounded<T: Real>(values: &[f64]) -> Vec<T> {
    in_large_pages(collect(values.len(), |k| T::lit(values[k])))
}

impl SparseMatrix<f64> {
    /// The matrix with every entry rounded once.
    #[must_use]
    pub fn in_precision<T: Real>(&self) -> SparseMatrix<T> {
        SparseMatrix {
            row_starts: self.row_starts.clone(),
            columns: self.columns.clone(),
            values: rounded(&self.values),
        }
    }
}

impl Bound<f64> {
    /// The set with its bounds rounded, which keeps their order.
    #[must_use]
    pub fn in_precision<T: Real>(&self) -> Bound<T> {
        match *self {
            Self::Free => Bound::Free,
            Self::Fixed(x) => Bound::Fixed(T::lit(x)),
            Self::Lower(x) => Bound::Lower(T::lit(x)),
            Self::Upper(x) => Bound::Upper(T::lit(x)),
            Self::Both(lower, upper) => Bound::Both(T::lit(lower), T::lit(upper)),
        }
    }
}

impl PenalisedMatrix<f64> {
    /// The sum with stiffness, jumps, weights and Dirichlet data rounded each for itself.
    #[must_use]
    pub fn in_precision<T: Real>(&self) -> PenalisedMatrix<T> {
        PenalisedMatrix {
            blocks: rounded(&self.blocks),
            jumps: self.jumps.in_precision(),
            weights: rounded(&self.weights),
            jump_data: rounded(&self.jump_data),
            mean_jumps: self.mean_jumps.clone(),
        }
    }
}

impl Inequality<f64> {
    /// The inequality with matrix, load, bounds, penalised matrix and kernel rounded once, entry by entry.
    ///
    /// Bounds that differ by less than the rounding coincide then. The resultants of bodies stay those of the data.
    #[must_use]
    pub fn in_precision<T: Real>(&self) -> Inequality<T> {
        let kernel_vector =
            |w: &Vec<(u32, f64)>| w.iter().map(|&(i, value)| (i, T::lit(value))).collect();
        let kink = |of: &Kink<f64>| Kink {
            unknown: of.unknown,
            slope: T::lit(of.slope),
            place: T::lit(of.place),
            is_above: of.is_above,
            own: of.own.in_precision(),
        };
        let mut rounded = Inequality {
            matrix: self.matrix.in_precision(),
            symmetric: self.symmetric,
            load: rounded(&self.load),
            bounds: self.bounds.iter().map(Bound::in_precision).collect(),
            locations: self.locations.clone(),
            conforming_linear: self.conforming_linear,
            start: self.start.clone(),
            penalised: self.penalised.as_ref().map(PenalisedMatrix::in_precision),
            dirichlet_energy: self.dirichlet_energy.clone(),
            kernel: self.kernel.iter().map(kernel_vector).collect(),
            kinks: self.kinks.iter().map(kink).collect(),
            bodies: self.bodies.clone(),
            is_definite: self.is_definite,
            distribution: self.distribution.clone(),
        };
        // rounding of the load is no load that was added
        let added = |k: usize| rounded.load_along(k) - self.load_along(k);
        let added: Vec<f64> =
            self.bodies.iter().map(|body| body.kernel.map_or(0.0, added)).collect();
        rounded.bodies.iter_mut().zip(added).for_each(|(body, added)| body.assembled += added);
        rounded
    }
    /// Whether the range of another precision holds the data: no diagonal entry and no factor of a penalty loses its
    /// digits by rounding, and neither does the largest entry of the matrix, the load, the bounds and the Dirichlet
    /// data, nor the largest quotient of load and diagonal. `false` for sizes that do not match.
    pub(crate) fn is_in_range_of<T: Real>(&self) -> bool {
        let is_held = |x: f64| {
            x == 0.0 || !x.is_finite() || (T::lit(x).to_f64() / x - 1.0).abs() <= T::EPSILON
        };
        let are_held = |values: &[f64]| values.iter().all(|&x| is_held(x));
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let of_bounds = |most: f64, bound: &Bound<f64>| {
            let of = [bound.lower(), bound.upper(), bound.fixed_value()];
            of.into_iter().flatten().fold(most, |most, x| most.max(x.abs()))
        };
        let diagonal = self.matrix.diagonal();
        let of_load = |most: f64, (b, d): (&f64, &f64)| {
            if *d > 0.0 { most.max(b.abs() / d) } else { most }
        };
        diagonal.len() == self.size()
            && are_held(&diagonal)
            && is_held(largest(&self.matrix.values))
            && is_held(largest(&self.load))
            && is_held(self.load.iter().zip(&diagonal).fold(0.0, of_load))
            && is_held(self.bounds.iter().fold(0.0, of_bounds))
            && self.penalised.as_ref().is_none_or(|penalised| {
                are_held(&penalised.weights)
                    && penalised.jumps.terms().iter().all(|term| is_held(term.weight))
                    && is_held(largest(&penalised.jump_data))
                    && (0..penalised.size()).all(|i| is_held(penalised.stiffness_diagonal(i)))
            })
    }
    /// The number of unknowns with two bounds that differ, but not in another precision.
    pub(crate) fn n_bounds_made_equal<T: Real>(&self) -> usize {
        let is_made_equal = |bound: &&Bound<f64>| {
            bound.is_inequality()
                && bound.fixed_value().is_none()
                && bound.in_precision::<T>().fixed_value().is_some()
        };
        self.bounds.iter().filter(is_made_equal).count()
    }
}
