//! The negative eigenvalues of symmetric matrices that need not be definite.

use super::{CholeskyMatrix, Diagonal, Lanczos};
use crate::algebra::SparseMatrix;

/// The number of negative eigenvalues of a symmetric matrix: the negative pivots of the factorisation `L D L^T` without
/// exchanges, of which by Sylvester's law there are as many. The factors are stored densely: `n^2 / 2` numbers.
pub fn negative_eigenvalues(matrix: &SparseMatrix<f64>) -> usize {
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
    negative
}

/// The smallest eigenvalue of a symmetric matrix, by the method of Lanczos for the matrix shifted until it is definite;
/// none if no shift to `2^11` makes it so.
pub fn smallest_eigenvalue(matrix: &SparseMatrix<f64>) -> Option<f64> {
    let mut shift = 0.0;
    for attempt in 0..20 {
        let mut shifted = matrix.clone();
        for i in 0..matrix.size() {
            let row = matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize;
            for k in row.filter(|&k| matrix.columns[k] as usize == i) {
                shifted.values[k] += shift;
            }
        }
        if let Ok(a) = CholeskyMatrix::new(&shifted) {
            let lanczos = Lanczos::default().with_tolerance(1e-6);
            let found = lanczos.smallest(&a, &Diagonal::identity(matrix.size())).ok()?;
            return Some(found - shift);
        }
        shift = 2.0_f64.powi(attempt - 8);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{negative_eigenvalues, smallest_eigenvalue};
    use crate::algebra::SparseMatrix;

    #[test]
    fn a_matrix_with_known_eigenvalues() {
        // eigenvalues 3 and -1, and 2
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 4, 5],
            columns: vec![0, 1, 0, 1, 2],
            values: vec![1.0, 2.0, 2.0, 1.0, 2.0],
        };
        assert_eq!(negative_eigenvalues(&matrix), 1);
        assert!((smallest_eigenvalue(&matrix).unwrap() + 1.0).abs() < 1e-6);
    }
}
