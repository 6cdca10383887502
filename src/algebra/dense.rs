//! Inverse and rank of small dense matrices, stored by rows.

/// Inverts an `n` by `n` matrix in place by Gauss-Jordan elimination with partial pivoting. Returns
/// whether the determinant is positive, `None` if the matrix is singular or an entry is not finite.
pub(crate) fn invert_in_place(a: &mut [f64], n: usize) -> Option<bool> {
    let mut is_positive = true;
    let mut exchanges = Vec::with_capacity(n);
    for k in 0..n {
        let size = |i: &usize| a[i * n + k].abs();
        let pivot = (k..n).max_by(|i, j| size(i).total_cmp(&size(j)))?;
        let value = a[pivot * n + k];
        if !(value.is_finite() && value != 0.0) {
            return None;
        }
        is_positive ^= value < 0.0;
        if pivot != k {
            is_positive ^= true;
            for j in 0..n {
                a.swap(pivot * n + j, k * n + j);
            }
        }
        exchanges.push(pivot);
        a[k * n + k] = 1.0;
        for j in 0..n {
            a[k * n + j] /= value;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = a[i * n + k];
            a[i * n + k] = 0.0;
            for j in 0..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
        }
    }
    for (k, &pivot) in exchanges.iter().enumerate().rev() {
        if pivot != k {
            for i in 0..n {
                a.swap(i * n + pivot, i * n + k);
            }
        }
    }
    Some(is_positive)
}

/// The rank of a matrix by Gaussian elimination with partial pivoting; pivots of absolute value up to
/// `tolerance` are zero.
pub(crate) fn rank(mut rows: Vec<Vec<f64>>, tolerance: f64) -> usize {
    let mut rank = 0;
    for column in 0..rows.first().map_or(0, Vec::len) {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (rank..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(pivot) = pivot.filter(|row| size(row) > tolerance) else { continue };
        rows.swap(rank, pivot);
        let (done, rest) = rows.split_at_mut(rank + 1);
        for row in rest {
            let factor = row[column] / done[rank][column];
            row.iter_mut().zip(&done[rank]).for_each(|(a, b)| *a -= factor * b);
        }
        rank += 1;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_rows_do_not_count() {
        let rows = vec![vec![0.0, 1.0, 1.0], vec![1.0, 0.0, 1.0], vec![1.0, -1.0, 1e-12]];
        assert_eq!(rank(rows.clone(), 1e-8), 2);
        assert_eq!(rank(rows, 1e-14), 3);
        assert_eq!(rank(vec![vec![0.0; 3]; 2], 0.0), 0);
        assert_eq!(rank(Vec::new(), 0.0), 0);
    }

    #[test]
    fn inverses_and_signs() {
        let mut a = vec![0.0, 2.0, 4.0, 0.0];
        assert_eq!(invert_in_place(&mut a, 2), Some(false));
        assert_eq!(a, [0.0, 0.25, 0.5, 0.0]);
        assert_eq!(invert_in_place(&mut [1.0, 2.0, 2.0, 4.0], 2), None);
    }
}
