//! Condensation of an inequality on the few unknowns of a cycle, by a Schur complement; `dense_lcp`
//! solves the small problem.

mod dense_lcp;

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::algebra::{Contact, Inequality};
use crate::linear::direct::{FactorError, Factors};
use crate::real::Real;
use dense_lcp::DenseLcp;

/// Number of right-hand sides solved at once: enough for the blocked kernels, few enough that they need
/// little memory compared with the factors.
const BLOCK: usize = 32;

/// Tolerances for violations within rounding.
pub(crate) struct Tolerances<'a> {
    /// For the violation of a bound.
    pub bound: f64,
    /// For a multiplier of the wrong sign, as a function of its unknown.
    pub multiplier: &'a dyn Fn(usize) -> f64,
}

/// Solves for the contact states of the unknowns `F` in `members` (ascending), with the states of all
/// others as given; returns the states in the order of `members`, `None` if no solution of the small
/// problem is found.
///
/// With the inactive unknowns `I` outside `F`, the small problem has the Schur complement
/// `A_FF - A_FI inv(A_II) A_IF` as matrix: one factorisation, and one right-hand side for each member.
/// Of `values` only those of fixed unknowns and of active unknowns outside `F` are used.
///
/// # Errors
/// If `A_II` has no factors.
pub(crate) fn solve<T: Real>(
    inequality: &Inequality<T>,
    values: &[T],
    states: &[Contact],
    members: &[u32],
    tolerances: &Tolerances<'_>,
) -> Result<Option<Vec<Contact>>, FactorError> {
    let Inequality { matrix, bounds, .. } = inequality;
    let partition = Partition::new(inequality, states, members);
    let factors = Factors::new(matrix, inequality.symmetric, &partition.inactive)?;
    let constant = partition.constant(&factors, values);
    let matrix = partition.schur_complement(&factors);
    let bound = |absent: f64, of: &dyn Fn(usize) -> Option<T>| -> Vec<f64> {
        members.iter().map(|&i| of(i as usize).map_or(absent, T::to_f64)).collect()
    };
    let multiplier_tolerances = members.iter().map(|&i| (tolerances.multiplier)(i as usize));
    let problem = DenseLcp {
        matrix,
        constant,
        lower: bound(f64::NEG_INFINITY, &|i| bounds[i].lower()),
        upper: bound(f64::INFINITY, &|i| bounds[i].upper()),
        bound_tolerance: tolerances.bound,
        multiplier_tolerances: multiplier_tolerances.collect(),
    };
    Ok(problem.solve(members.iter().map(|&i| states[i as usize]).collect()))
}

/// The class of an unknown, with its position in the class.
#[derive(Clone, Copy, PartialEq)]
enum IndexClass {
    /// In `F`.
    Member(u32),
    /// In `I`.
    Inactive(u32),
    /// Fixed, or active outside `F`.
    Prescribed,
}

/// The partition of all unknowns into members, inactive and prescribed ones.
struct Partition<'a, T> {
    inequality: &'a Inequality<T>,
    members: &'a [u32],
    inactive: Vec<u32>,
    classes: Vec<IndexClass>,
}

impl<'a, T: Real> Partition<'a, T> {
    fn new(inequality: &'a Inequality<T>, states: &[Contact], members: &'a [u32]) -> Self {
        let mut classes = vec![IndexClass::Prescribed; inequality.size()];
        for (k, &i) in members.iter().enumerate() {
            classes[i as usize] = IndexClass::Member(k as u32);
        }
        let mut inactive = Vec::new();
        for (i, class) in classes.iter_mut().enumerate() {
            let is_inactive =
                states[i] == Contact::Inactive && inequality.bounds[i].fixed_value().is_none();
            if is_inactive && *class == IndexClass::Prescribed {
                *class = IndexClass::Inactive(inactive.len() as u32);
                inactive.push(i as u32);
            }
        }
        Self { inequality, members, inactive, classes }
    }

    /// The constant of the small problem: `A u - b` on `F` with `u_F = 0` and `u_I` in equilibrium.
    fn constant(&self, factors: &Factors<T>, values: &[T]) -> DVector<f64> {
        let Inequality { matrix, load, .. } = self.inequality;
        let mut values = values.to_vec();
        for (value, class) in values.iter_mut().zip(&self.classes) {
            if *class != IndexClass::Prescribed {
                *value = T::lit(0.0);
            }
        }
        let mut residual = vec![0.0; values.len()];
        self.inequality.residual_f64(&values, &mut residual);
        let mut x: Vec<T> = self.inactive.iter().map(|&i| T::lit(residual[i as usize])).collect();
        factors.solve_in_place(&mut x, 1);
        for (&i, &x) in self.inactive.iter().zip(&x) {
            values[i as usize] = x;
        }
        DVector::from_iterator(
            self.members.len(),
            self.members.iter().map(|&i| {
                let i = i as usize;
                matrix.row_dot_f64(i, &values) - load[i].to_f64()
            }),
        )
    }

    /// `A_FF - A_FI inv(A_II) A_IF`, by blocks of columns.
    fn schur_complement(&self, factors: &Factors<T>) -> DMatrix<f64> {
        let n = self.members.len();
        let mut schur = DMatrix::zeros(n, n);
        for first in (0..n).step_by(BLOCK) {
            let columns = first..n.min(first + BLOCK);
            let mut coupling = self.coupling(&columns);
            factors.solve_in_place(&mut coupling, columns.len());
            self.add_columns(&mut schur, &columns, &coupling);
        }
        schur
    }

    /// The columns of `A_IF` for a range of members, one column after the other.
    fn coupling(&self, columns: &Range<usize>) -> Vec<T> {
        let mut coupling = vec![T::lit(0.0); self.inactive.len() * columns.len()];
        for (row, &i) in self.inactive.iter().enumerate() {
            let (js, entries) = self.inequality.matrix.row(i as usize);
            for (&j, &a) in js.iter().zip(entries) {
                if let IndexClass::Member(k) = self.classes[j as usize]
                    && columns.contains(&(k as usize))
                {
                    coupling[(k as usize - columns.start) * self.inactive.len() + row] = a;
                }
            }
        }
        coupling
    }

    /// Adds a range of columns of `A_FF - A_FI X` to the Schur complement, where `X` are the given
    /// solutions `inv(A_II) A_IF` for these columns.
    fn add_columns(&self, schur: &mut DMatrix<f64>, columns: &Range<usize>, solutions: &[T]) {
        for (row, &i) in self.members.iter().enumerate() {
            let (js, entries) = self.inequality.matrix.row(i as usize);
            for (&j, &a) in js.iter().zip(entries) {
                let a = a.to_f64();
                match self.classes[j as usize] {
                    IndexClass::Member(k) if columns.contains(&(k as usize)) => {
                        schur[(row, k as usize)] += a;
                    }
                    IndexClass::Inactive(k) => {
                        for column in columns.clone() {
                            let offset = (column - columns.start) * self.inactive.len();
                            let x = solutions[offset + k as usize];
                            schur[(row, column)] -= a * x.to_f64();
                        }
                    }
                    _ => {}
                }
            }
        }
    }
}
