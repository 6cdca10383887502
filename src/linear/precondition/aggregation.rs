//! Smoothed aggregation: a coarse space from a matrix alone.
//!
//! Source: P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996), 179-196.

use super::prolongation::Prolongation;
use crate::algebra::{NO_INDEX, SparseMatrix, galerkin_product, sort_by_column};
use crate::real::Real;

/// Unknowns `i` and `j` are strongly coupled if `a_ij^2 > STRENGTH^2 a_ii a_jj`.
const STRENGTH: f64 = 0.05;

/// Entries of the prolongation up to this absolute value are set to zero: most of them are rounding
/// errors.
const NEGLIGIBLE: f64 = 1e-4;

/// The damping of the Jacobi step times the bound on the largest eigenvalue of `D^-1 A`, `D` the
/// diagonal.
const DAMPING: f64 = 4.0 / 3.0;

/// The prolongation `P` and the coarse matrix `P^T A P`; `None` if the coarse space has no unknown, or
/// more than half as many unknowns as the matrix has rows.
pub(crate) fn aggregate<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
) -> Option<(Prolongation, SparseMatrix<T>)> {
    let diagonal: Vec<f64> = matrix.diagonal().iter().map(|d| d.to_f64()).collect();
    let is_strong = |i: usize, j: usize, a: T| {
        i != j && !fixed[j] && a.to_f64().powi(2) > STRENGTH * STRENGTH * diagonal[i] * diagonal[j]
    };
    let (aggregate_of, n_coarse) = aggregates(matrix, fixed, &is_strong);
    if n_coarse == 0 || 2 * n_coarse > matrix.size() {
        return None;
    }
    let rows = smoothed_prolongation(matrix, fixed, &diagonal, &aggregate_of);
    let coarse = galerkin_product(matrix, &rows, n_coarse);
    Some((Prolongation::new(rows, n_coarse), coarse))
}

/// The aggregate of each unknown, [`NO_INDEX`] for none, and the number of aggregates.
///
/// The first aggregates are disjoint sets of an unknown and all its strongly coupled neighbours. An unknown in none of
/// these sets joins the aggregate of its most strongly coupled neighbour that is in one of them; the remaining unknowns
/// form further aggregates with those neighbours that have no aggregate. Fixed unknowns, and unknowns without strong
/// couplings, have no aggregate.
fn aggregates<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
    is_strong: &dyn Fn(usize, usize, T) -> bool,
) -> (Vec<u32>, usize) {
    let n = matrix.size();
    let mut aggregate_of = vec![NO_INDEX; n];
    let mut count = 0;
    let neighbours = |i: usize| {
        let (columns, values) = matrix.row(i);
        columns.iter().zip(values).filter(move |(j, a)| is_strong(i, **j as usize, **a))
    };
    for i in 0..n {
        let is_candidate = !fixed[i] && aggregate_of[i] == NO_INDEX;
        if is_candidate && neighbours(i).all(|(&j, _)| aggregate_of[j as usize] == NO_INDEX) {
            if neighbours(i).next().is_none() {
                continue;
            }
            aggregate_of[i] = count;
            neighbours(i).for_each(|(&j, _)| aggregate_of[j as usize] = count);
            count += 1;
        }
    }
    let disjoint = aggregate_of.clone();
    for i in (0..n).filter(|&i| !fixed[i] && disjoint[i] == NO_INDEX) {
        let size = |a: &T| a.to_f64().abs();
        let strongest = neighbours(i)
            .filter(|(j, _)| disjoint[**j as usize] != NO_INDEX)
            .max_by(|x, y| size(x.1).total_cmp(&size(y.1)));
        if let Some((&j, _)) = strongest {
            aggregate_of[i] = disjoint[j as usize];
        }
    }
    for i in 0..n {
        if !fixed[i] && aggregate_of[i] == NO_INDEX && neighbours(i).next().is_some() {
            aggregate_of[i] = count;
            for (&j, _) in neighbours(i) {
                if aggregate_of[j as usize] == NO_INDEX {
                    aggregate_of[j as usize] = count;
                }
            }
            count += 1;
        }
    }
    (aggregate_of, count as usize)
}

/// The prolongation `(I - omega D^-1 A) P_0`, where the columns of `P_0` are the indicator functions of aggregates.
/// Rows of fixed unknowns are empty.
fn smoothed_prolongation<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
    diagonal: &[f64],
    aggregate_of: &[u32],
) -> SparseMatrix<f32> {
    let n = matrix.size();
    // The largest absolute row sum bounds the largest eigenvalue of D^-1 A.
    let row_sum = |i: usize| {
        let sum: f64 = matrix.row(i).1.iter().map(|a| a.to_f64().abs()).sum();
        sum / diagonal[i].max(f64::MIN_POSITIVE)
    };
    let largest = (0..n).filter(|&i| !fixed[i]).map(row_sum).fold(1.0, f64::max);
    let omega = DAMPING / largest;
    SparseMatrix::by_groups(n, &|range| {
        let mut row: Vec<(u32, f64)> = Vec::new();
        SparseMatrix::by_rows(range, |i, of_row, weights| {
            row.clear();
            if !fixed[i] && diagonal[i] > 0.0 {
                let (columns, values) = matrix.row(i);
                for (&j, &a) in columns.iter().zip(values) {
                    let aggregate = aggregate_of[j as usize];
                    if aggregate == NO_INDEX {
                        continue;
                    }
                    let identity = if j as usize == i { 1.0 } else { 0.0 };
                    let weight = identity - omega * a.to_f64() / diagonal[i];
                    match row.iter_mut().find(|(column, _)| *column == aggregate) {
                        Some((_, sum)) => *sum += weight,
                        None => row.push((aggregate, weight)),
                    }
                }
                row.retain(|(_, weight)| weight.abs() > NEGLIGIBLE);
                sort_by_column(&mut row);
            }
            of_row.extend(row.iter().map(|&(column, _)| column));
            weights.extend(row.iter().map(|&(_, weight)| weight as f32));
        })
    })
}
