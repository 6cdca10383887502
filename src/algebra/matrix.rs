//! Compressed sparse rows.

use rayon::prelude::*;

use crate::real::Real;

/// A square sparse matrix by rows: columns ascending in each row, no column twice.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix<T> {
    /// Start of each row in `columns` and `values`, and the number of stored entries at the end.
    pub row_starts: Vec<u32>,
    /// Column of each entry.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<T>,
}

impl<T: Real> SparseMatrix<T> {
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.row_starts.len().saturating_sub(1)
    }
    /// Whether the rows are what the type promises: starts that do not fall, columns ascending
    /// and inside the matrix, a value for every entry.
    pub fn is_well_formed(&self) -> bool {
        let n = self.size();
        self.row_starts.first() == Some(&0)
            && self.row_starts.windows(2).all(|w| w[0] <= w[1])
            && self.row_starts[n] as usize == self.columns.len()
            && self.columns.len() == self.values.len()
            && (0..n).all(|i| {
                let columns = self.row(i).0;
                columns.windows(2).all(|w| w[0] < w[1])
                    && columns.last().is_none_or(|&j| (j as usize) < n)
            })
    }
    /// Number of stored entries.
    pub fn nonzeros(&self) -> usize {
        self.columns.len()
    }
    /// Columns and values of a row.
    #[inline]
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.row_starts[i] as usize..self.row_starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }
    /// The entry at (i, j), zero where none is stored.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (columns, values) = self.row(i);
        columns.binary_search(&(j as u32)).map_or_else(|_| T::lit(0.0), |k| values[k])
    }
    /// The diagonal.
    pub fn diagonal(&self) -> Vec<T> {
        (0..self.size()).into_par_iter().with_min_len(4096).map(|i| self.get(i, i)).collect()
    }
    /// Row `i` times a vector.
    #[inline]
    pub fn row_dot(&self, i: usize, x: &[T]) -> T {
        let (columns, values) = self.row(i);
        columns.iter().zip(values).fold(T::lit(0.0), |s, (&j, &a)| s + a * x[j as usize])
    }
    /// Row `i` times a vector, every product and the sum in `f64`.
    #[inline]
    pub fn row_dot_f64(&self, i: usize, x: &[T]) -> f64 {
        let (columns, values) = self.row(i);
        columns.iter().zip(values).fold(0.0, |s, (&j, &a)| s + a.to_f64() * x[j as usize].to_f64())
    }
    /// `r = b - A x`, accumulated and kept in `f64` whatever the scalar.
    ///
    /// For `f32` the products are exact, so that the residual is that of the rounded unknowns and
    /// not of the summation.
    pub fn residual_f64(&self, b: &[T], x: &[T], r: &mut [f64]) {
        r.par_iter_mut()
            .with_min_len(4096)
            .enumerate()
            .for_each(|(i, r)| *r = b[i].to_f64() - self.row_dot_f64(i, x));
    }
    /// The same of an `x` that is not stored in the scalar.
    pub fn residual_of(&self, b: &[T], x: &(dyn Fn(usize) -> f64 + Sync), r: &mut [f64]) {
        r.par_iter_mut().with_min_len(4096).enumerate().for_each(|(i, r)| {
            let (columns, values) = self.row(i);
            let product = |s: f64, (&j, a): (&u32, &T)| s + a.to_f64() * x(j as usize);
            *r = b[i].to_f64() - columns.iter().zip(values).fold(0.0, product);
        });
    }
    /// `b - A x`.
    pub fn residual(&self, b: &[T], x: &[T]) -> Vec<T> {
        let mut r = vec![T::lit(0.0); b.len()];
        r.par_iter_mut()
            .with_min_len(4096)
            .enumerate()
            .for_each(|(i, r)| *r = b[i] - self.row_dot(i, x));
        r
    }
}
