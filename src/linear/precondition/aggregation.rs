//! CoarseLevel functions from a matrix alone: smoothed aggregation.
//!
//! Source: P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996), 179-196.

use super::prolongation::{Prolongation, RectangularMatrix};
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// Marks an unknown in no aggregate.
const NONE: u32 = u32::MAX;

/// Neighbours count as strongly coupled above this share of the mean of their diagonals.
const STRONG: f64 = 0.05;

/// Weights up to this are left away.
const NEGLIGIBLE: f64 = 1e-4;

/// The damping of the smoothed functions, over the largest eigenvalue of the scaled matrix.
const DAMPING: f64 = 4.0 / 3.0;

/// CoarseLevel functions and the form on them; `None` if there would be hardly fewer.
pub(crate) fn aggregate<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
) -> Option<(Prolongation<T>, SparseMatrix<T>)> {
    let diagonal: Vec<f64> = matrix.diagonal().iter().map(|d| d.to_f64()).collect();
    let strong = |i: usize, j: usize, a: T| {
        i != j && !fixed[j] && a.to_f64().powi(2) > STRONG * STRONG * diagonal[i] * diagonal[j]
    };
    let (owner, n_coarse) = aggregates(matrix, fixed, &strong);
    if n_coarse == 0 || 2 * n_coarse > matrix.size() {
        return None;
    }
    let functions = smoothed(matrix, fixed, &diagonal, &owner);
    let coarse = galerkin(matrix, &functions, n_coarse);
    Some((Prolongation::weights(functions, n_coarse), coarse))
}

/// The aggregate of every unknown, and how many there are: neighbourhoods that do not overlap, and
/// what remains joined to one beside it.
fn aggregates<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
    strong: &dyn Fn(usize, usize, T) -> bool,
) -> (Vec<u32>, usize) {
    let n = matrix.size();
    let mut owner = vec![NONE; n];
    let mut count = 0;
    let neighbours = |i: usize| {
        let (columns, values) = matrix.row(i);
        columns.iter().zip(values).filter(move |(j, a)| strong(i, **j as usize, **a))
    };
    for i in 0..n {
        let is_free = !fixed[i] && owner[i] == NONE;
        if is_free && neighbours(i).all(|(&j, _)| owner[j as usize] == NONE) {
            if neighbours(i).next().is_none() {
                continue;
            }
            owner[i] = count;
            neighbours(i).for_each(|(&j, _)| owner[j as usize] = count);
            count += 1;
        }
    }
    let first = owner.clone();
    for i in (0..n).filter(|&i| !fixed[i] && first[i] == NONE) {
        let size = |a: &T| a.to_f64().abs();
        let best = neighbours(i)
            .filter(|(j, _)| first[**j as usize] != NONE)
            .max_by(|x, y| size(x.1).total_cmp(&size(y.1)));
        if let Some((&j, _)) = best {
            owner[i] = first[j as usize];
        }
    }
    for i in 0..n {
        if !fixed[i] && owner[i] == NONE && neighbours(i).next().is_some() {
            owner[i] = count;
            for (&j, _) in neighbours(i) {
                if owner[j as usize] == NONE {
                    owner[j as usize] = count;
                }
            }
            count += 1;
        }
    }
    (owner, count as usize)
}

/// The indicators of the aggregates after one damped Jacobi step.
fn smoothed<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
    diagonal: &[f64],
    owner: &[u32],
) -> RectangularMatrix<T> {
    let n = matrix.size();
    // the largest row sum bounds the largest eigenvalue
    let row_sum = |i: usize| {
        let sum: f64 = matrix.row(i).1.iter().map(|a| a.to_f64().abs()).sum();
        sum / diagonal[i].max(f64::MIN_POSITIVE)
    };
    let largest = (0..n).filter(|&i| !fixed[i]).map(row_sum).fold(1.0, f64::max);
    let damping = DAMPING / largest;
    let mut rows = RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
    let mut row: Vec<(u32, f64)> = Vec::new();
    for i in 0..n {
        row.clear();
        if !fixed[i] && diagonal[i] > 0.0 {
            let (columns, values) = matrix.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                let target = owner[j as usize];
                if target == NONE {
                    continue;
                }
                let identity = if j as usize == i { 1.0 } else { 0.0 };
                let weight = identity - damping * a.to_f64() / diagonal[i];
                match row.iter_mut().find(|(column, _)| *column == target) {
                    Some((_, sum)) => *sum += weight,
                    None => row.push((target, weight)),
                }
            }
            // what is left of entries that are zero but for rounding
            row.retain(|(_, weight)| weight.abs() > NEGLIGIBLE);
            row.sort_unstable_by_key(|&(column, _)| column);
        }
        rows.columns.extend(row.iter().map(|&(column, _)| column));
        rows.values.extend(row.iter().map(|&(_, weight)| T::lit(weight)));
        rows.starts.push(rows.columns.len() as u32);
    }
    rows
}

/// `P^T A P`.
pub(crate) fn galerkin<T: Real>(
    matrix: &SparseMatrix<T>,
    functions: &RectangularMatrix<T>,
    n_coarse: usize,
) -> SparseMatrix<T> {
    let transpose = functions.transpose(n_coarse);
    let zero = T::lit(0.0);
    let mut position = vec![NONE; n_coarse];
    let mut sums: Vec<(u32, T)> = Vec::new();
    let mut coarse =
        SparseMatrix { row_starts: vec![0_u32], columns: Vec::new(), values: Vec::new() };
    for row in 0..n_coarse {
        sums.clear();
        let (fine, weights) = transpose.row(row);
        for (&i, &weight) in fine.iter().zip(weights) {
            let (columns, values) = matrix.row(i as usize);
            for (&j, &a) in columns.iter().zip(values) {
                let a = weight * a;
                if a == zero {
                    continue;
                }
                let (targets, others) = functions.row(j as usize);
                for (&target, &other) in targets.iter().zip(others) {
                    let at = &mut position[target as usize];
                    if *at == NONE {
                        *at = sums.len() as u32;
                        sums.push((target, zero));
                    }
                    sums[*at as usize].1 += a * other;
                }
            }
        }
        sums.iter().for_each(|&(target, _)| position[target as usize] = NONE);
        sums.sort_unstable_by_key(|&(target, _)| target);
        coarse.columns.extend(sums.iter().map(|s| s.0));
        coarse.values.extend(sums.iter().map(|s| s.1));
        coarse.row_starts.push(coarse.columns.len() as u32);
    }
    coarse
}
