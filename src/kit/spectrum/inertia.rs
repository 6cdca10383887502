//! The negative eigenvalues of symmetric matrices that need not be definite.

use super::{CholeskyMatrix, Diagonal, Lanczos, SpectrumError};
use crate::algebra::SparseMatrix;

/// The number of negative eigenvalues of a symmetric matrix: the negative pivots of the factorisation `L D L^T` without
/// exchanges, of which by Sylvester's law there are as many; none if a pivot is zero or not finite. The factors are
/// stored densely: `n^2 / 2` numbers. Small pivots may make the number wrong, as without exchanges rounding grows with
/// them.
pub fn negative_eigenvalues(matrix: &SparseMatrix<f64>) -> Option<usize> {
    let n = matrix.size();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row = vec![0.0; i + 1];
            let (columns, values) = matrix.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                if j as usize <= i {
                    row[j as usize] = a;
                }
            }
            row
        })
        .collect();
    let mut negative = 0;
    for k in 0..n {
        let pivot = rows[k][k];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        negative += usize::from(pivot < 0.0);
        let column: Vec<f64> = (k + 1..n).map(|i| rows[i][k]).collect();
        for i in k + 1..n {
            let factor = column[i - k - 1] / pivot;
            if factor == 0.0 {
                continue;
            }
            let row = &mut rows[i][k + 1..=i];
            row.iter_mut().zip(&column).for_each(|(a, c)| *a -= factor * c);
        }
    }
    Some(negative)
}

/// The smallest eigenvalue of a symmetric matrix. Lanczos' method needs a definite matrix: the diagonal is shifted by
/// zero or, where that does not do, by `2^-20`, `2^-19` and so on up to one times the norm, the largest row sum of
/// absolute values.
///
/// # Errors
/// [`SpectrumError`].
pub fn smallest_eigenvalue(matrix: &SparseMatrix<f64>) -> Result<f64, SpectrumError> {
    let sum = |i: usize| matrix.row(i).1.iter().map(|a| a.abs()).sum::<f64>();
    let norm = (0..matrix.size()).map(sum).fold(0.0, f64::max);
    let mut shift = 0.0;
    for attempt in -20..=1 {
        let mut shifted = matrix.clone();
        for i in 0..matrix.size() {
            let row = matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize;
            for k in row.filter(|&k| matrix.columns[k] as usize == i) {
                shifted.values[k] += shift;
            }
        }
        if let Ok(a) = CholeskyMatrix::new(&shifted) {
            let lanczos = Lanczos::default().with_tolerance(1e-6);
            let found = lanczos.smallest(&a, &Diagonal::identity(matrix.size()))?;
            return Ok(found - shift);
        }
        shift = norm * 2.0_f64.powi(attempt);
    }
    // no row is dominated by its diagonal entry then: an entry is not finite
    Err(SpectrumError::NotPositive(0))
}
