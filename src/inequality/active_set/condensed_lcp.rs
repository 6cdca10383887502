//! Condensing an inequality on the few unknowns whose contact state will not settle.

use nalgebra::{DMatrix, DVector};

use super::dense_lcp::SmallProblem;
use crate::algebra::{Contact, Inequality};
use crate::linear::{FactorError, Factors};
use crate::real::Real;

/// Right-hand sides solved at once: enough for the blocked kernels, few enough that they take
/// little memory beside the factors.
const BLOCK: usize = 32;

/// What is put down to rounding.
pub(crate) struct Noise<'a> {
    /// Violations of a bound up to this.
    pub gap: f64,
    /// Multipliers of wrong sign up to this, by unknown.
    pub force: &'a dyn Fn(usize) -> f64,
}

/// Solves for the contact states of `members` (ascending) exactly while those of all other
/// unknowns stay; `None` if the small problem has no solution that could be found.
///
/// With `F` the members and `I` all other unknowns off contact, the small problem has the matrix
/// `A_FF - A_FI inv(A_II) A_IF`: one factorisation, as many right-hand sides as members. `u` holds
/// the values of unknowns outside `F` and `I`.
///
/// # Errors
/// If `A_II` cannot be factored.
pub(crate) fn resolve<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    state: &[Contact],
    members: &[u32],
    noise: &Noise<'_>,
) -> Result<Option<Vec<Contact>>, FactorError> {
    let Inequality { matrix, bounds, .. } = inequality;
    let n = inequality.size();
    let zero = T::lit(0.0);
    let mut place = vec![Place::Elsewhere; n];
    for (k, &i) in members.iter().enumerate() {
        place[i as usize] = Place::Member(k as u32);
    }
    let mut inner = Vec::new();
    let mut values = u.to_vec();
    for i in 0..n {
        let open = state[i] == Contact::Inactive && bounds[i].fixed_value().is_none();
        if open && place[i] == Place::Elsewhere {
            place[i] = Place::Inner(inner.len() as u32);
            inner.push(i as u32);
        }
        if place[i] != Place::Elsewhere {
            values[i] = zero;
        }
    }
    let factors = Factors::new(matrix, inequality.symmetric, &inner)?;

    // The constant: the residual with the members at zero and the inner unknowns in balance.
    let mut deficit = vec![0.0; n];
    inequality.residual_f64(&values, &mut deficit);
    let mut x: Vec<T> = inner.iter().map(|&i| T::lit(deficit[i as usize])).collect();
    factors.solve_in_place(&mut x, 1);
    for (&i, &x) in inner.iter().zip(&x) {
        values[i as usize] = x;
    }
    let constant = DVector::from_iterator(
        members.len(),
        members.iter().map(|&i| {
            let i = i as usize;
            matrix.row_dot_f64(i, &values) - inequality.load[i].to_f64()
        }),
    );

    let mut condensed = DMatrix::zeros(members.len(), members.len());
    for first in (0..members.len()).step_by(BLOCK) {
        let columns = first..members.len().min(first + BLOCK);
        let mut coupling = vec![zero; inner.len() * columns.len()];
        for (row, &i) in inner.iter().enumerate() {
            let (js, entries) = matrix.row(i as usize);
            for (&j, &a) in js.iter().zip(entries) {
                if let Place::Member(k) = place[j as usize]
                    && columns.contains(&(k as usize))
                {
                    coupling[(k as usize - first) * inner.len() + row] = a;
                }
            }
        }
        factors.solve_in_place(&mut coupling, columns.len());
        for (row, &i) in members.iter().enumerate() {
            let (js, entries) = matrix.row(i as usize);
            for (&j, &a) in js.iter().zip(entries) {
                let a = a.to_f64();
                match place[j as usize] {
                    Place::Member(k) if columns.contains(&(k as usize)) => {
                        condensed[(row, k as usize)] += a;
                    }
                    Place::Inner(k) => {
                        for column in columns.clone() {
                            let x = coupling[(column - first) * inner.len() + k as usize];
                            condensed[(row, column)] -= a * x.to_f64();
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    let bound = |absent: f64, of: &dyn Fn(usize) -> Option<T>| -> Vec<f64> {
        members.iter().map(|&i| of(i as usize).map_or(absent, T::to_f64)).collect()
    };
    let problem = SmallProblem {
        matrix: condensed,
        constant,
        lower: bound(f64::NEG_INFINITY, &|i| bounds[i].lower()),
        upper: bound(f64::INFINITY, &|i| bounds[i].upper()),
        gap_noise: noise.gap,
        force_noise: members.iter().map(|&i| (noise.force)(i as usize)).collect(),
    };
    Ok(problem.solve(members.iter().map(|&i| state[i as usize]).collect()))
}

/// The part an unknown plays.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Member(u32),
    Inner(u32),
    Elsewhere,
}
