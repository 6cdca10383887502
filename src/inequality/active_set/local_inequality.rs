//! The inequality near unknowns whose contact states change in turn, and its solution.

use super::iterate::Iterate;
use super::settings::ActiveSet;
use crate::algebra::{Bound, Inequality, SparseMatrix, Start};
use crate::inequality::{InequalitySolver, Outcome};
use crate::linear::LinearMethod;
use crate::real::Real;

/// Largest distance, in couplings of the matrix, of the unknowns of a local inequality from those whose states change.
/// The values of different tetrahedra at one vertex, which are coupled from cell to cell, are at most half a dozen
/// couplings apart: three reach half way around (radial-3d, `wopsip`, 32).
const MAX_DISTANCE: usize = 3;

/// Largest number of unknowns of a local inequality, which is solved with factors, divided by the number of all
/// unknowns: pyramid-full-2d, `wopsip`, 64.
const MAX_SHARE: f64 = 0.5;

/// Solves the inequality for the unknowns near `changed`, with the values of all other unknowns held, and stores values
/// and contact states in the iterate if the solve converges. Returns the outcome; `None` if the local inequality
/// has too many unknowns.
///
/// If the matrix is no M-matrix, the active set may cycle because unknowns, in groups on a few cells, change their states
/// in turn. The exact solution near all groups ends the cycle: the active set method with factors and the interior point
/// method find this solution. With a symmetric matrix its energy is not above that of the iterate.
pub(super) fn solve_locally<T: Real>(
    iterate: &mut Iterate<'_, T>,
    settings: &ActiveSet,
    changed: &[u32],
) -> Option<Outcome> {
    if !iterate.residual_is_current {
        iterate.compute_residual();
    }
    let Iterate { inequality, values, states, residual, .. } = &*iterate;
    let unknowns = unknowns_around(&inequality.matrix, changed);
    if unknowns.len() as f64 > MAX_SHARE * values.len() as f64 {
        return None;
    }
    let matrix = inequality.matrix.submatrix(&unknowns);
    // the unknowns of the local inequality are corrections of values: its load is the residual
    let load = unknowns.iter().map(|&i| T::lit(residual[i as usize])).collect();
    let bounds =
        unknowns.iter().map(|&i| shifted(&inequality.bounds[i as usize], values[i as usize]));
    let mut local = Inequality::new(matrix, inequality.symmetric, load, bounds.collect());
    local.start = Start::Contact(unknowns.iter().map(|&i| states[i as usize]).collect());
    local.is_definite = true;
    let solution = settings.clone().linear(LinearMethod::Direct).solve(&local);
    if solution.outcome != Outcome::Converged {
        return Some(solution.outcome);
    }
    let (mut values, mut states) = (values.clone(), states.clone());
    for (k, &i) in unknowns.iter().enumerate() {
        values[i as usize] += solution.values[k];
        states[i as usize] = solution.contact[k];
    }
    iterate.replace(values, Vec::new(), states);
    Some(Outcome::Converged)
}

/// The unknowns within [`MAX_DISTANCE`] of the unknowns `changed`, these included, ascending.
fn unknowns_around<T: Real>(matrix: &SparseMatrix<T>, changed: &[u32]) -> Vec<u32> {
    let mut is_local = vec![false; matrix.size()];
    let mut all: Vec<u32> = Vec::new();
    let add = |i: u32, is_local: &mut [bool], all: &mut Vec<u32>| {
        if !std::mem::replace(&mut is_local[i as usize], true) {
            all.push(i);
        }
    };
    changed.iter().for_each(|&i| add(i, &mut is_local, &mut all));
    let mut begin = 0;
    for _ in 0..MAX_DISTANCE {
        let end = all.len();
        for k in begin..end {
            for &j in matrix.row(all[k] as usize).0 {
                add(j, &mut is_local, &mut all);
            }
        }
        begin = end;
    }
    all.sort_unstable();
    all
}

/// The bound on the correction of a value.
fn shifted<T: Real>(bound: &Bound<T>, value: T) -> Bound<T> {
    match *bound {
        Bound::Free => Bound::Free,
        Bound::Fixed(_) => Bound::Fixed(T::lit(0.0)),
        Bound::Lower(lower) => Bound::Lower(lower - value),
        Bound::Upper(upper) => Bound::Upper(upper - value),
        Bound::Both(lower, upper) => Bound::Both(lower - value, upper - value),
    }
}
