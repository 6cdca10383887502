//! The product `P^T A P`.

use super::NO_INDEX;
use super::matrix::{SparseMatrix, sort_by_column};
use crate::real::Real;

/// The Galerkin product `P^T A P` with a prolongation `P` of `n_coarse` columns, as `P^T (A P)`: each row of `A P` is
/// computed once, however many coarse functions do not vanish there.
pub(crate) fn galerkin_product<T: Real, W: Real>(
    matrix: &SparseMatrix<T>,
    prolongation: &SparseMatrix<W>,
    n_coarse: usize,
) -> SparseMatrix<T> {
    let image = SparseMatrix::by_groups(matrix.size(), &|range| {
        let mut sum = SparseSum::new(n_coarse);
        SparseMatrix::by_rows(range, |i, columns, values| {
            if prolongation.row(i).0.is_empty() {
                // no row of P^T reads this row of A P
                return;
            }
            let (neighbours, entries) = matrix.row(i);
            for (&j, &a) in neighbours.iter().zip(entries) {
                if a != T::lit(0.0) {
                    sum.add(a, prolongation.row(j as usize));
                }
            }
            sum.move_to(columns, values);
        })
    });
    let transpose = prolongation.transpose(n_coarse);
    SparseMatrix::by_groups(n_coarse, &|range| {
        let mut sum = SparseSum::new(n_coarse);
        SparseMatrix::by_rows(range, |row, columns, values| {
            let (fine, weights) = transpose.row(row);
            for (&i, &weight) in fine.iter().zip(weights) {
                sum.add(T::lit(weight.to_f64()), image.row(i as usize));
            }
            sort_by_column(&mut sum.terms);
            sum.move_to(columns, values);
        })
    })
}

/// A sum of multiples of sparse rows.
pub(crate) struct SparseSum<T> {
    /// Columns with their entries, in the order in which they were added.
    terms: Vec<(u32, T)>,
    /// The index in `terms` of each column; [`NO_INDEX`] for a column without a term.
    places: Vec<u32>,
}

impl<T: Real> SparseSum<T> {
    /// The empty sum of rows with this number of columns.
    pub fn new(n_columns: usize) -> Self {
        Self { terms: Vec::new(), places: vec![NO_INDEX; n_columns] }
    }

    /// Adds a multiple of a row.
    #[inline(always)]
    pub fn add<W: Real>(&mut self, factor: T, (columns, values): (&[u32], &[W])) {
        for (&column, &value) in columns.iter().zip(values) {
            let place = &mut self.places[column as usize];
            if *place == NO_INDEX {
                *place = self.terms.len() as u32;
                self.terms.push((column, T::lit(0.0)));
            }
            self.terms[*place as usize].1 += factor * T::lit(value.to_f64());
        }
    }

    /// Appends the terms to a list of columns and one of values, and leaves the empty sum.
    pub fn move_to(&mut self, columns: &mut Vec<u32>, values: &mut Vec<T>) {
        for &(column, value) in &self.terms {
            self.places[column as usize] = NO_INDEX;
            columns.push(column);
            values.push(value);
        }
        self.terms.clear();
    }
}
