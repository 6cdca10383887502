//! The negative eigenvalues of symmetric matrices that need not be definite.

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
