//! Prolongations from coarse to fine functions, and their transposes.

use crate::algebra::{DofLocation, SparseMatrix, sort_by_column};
use crate::parallel::vectors::{all, for_each_chunk, zeros};
use crate::real::Real;

/// A prolongation `P`: a sparse matrix whose columns are the coarse basis functions in the fine basis.
///
/// The *children* of a coarse unknown are the fine unknowns with entries in its column, the *parents* of a fine
/// unknown are the coarse unknowns with entries in its row. Weights are single precision numbers: those of nested
/// meshes are powers of two, and others only make preconditioners.
#[derive(Clone, Debug)]
pub struct Prolongation {
    /// `P` by rows.
    fine: SparseMatrix<f32>,
    /// Its transpose by rows.
    coarse: SparseMatrix<f32>,
}

impl Prolongation {
    /// The prolongation with the rows `fine`.
    pub(crate) fn new(fine: SparseMatrix<f32>, n_coarse: usize) -> Self {
        let coarse = fine.transpose(n_coarse);
        Self { fine, coarse }
    }

    /// The prolongation of conforming linear functions to a uniform refinement: fine vertex `i` is the midpoint of the
    /// coarse vertices `parents[i]`, which are equal for a vertex of the coarse mesh. Every coarse vertex must be a
    /// fine vertex.
    ///
    /// # Panics
    /// If a parent is not less than `n_coarse`.
    #[must_use]
    pub fn midpoints(parents: &[[u32; 2]], n_coarse: usize) -> Self {
        let add = |i: usize, columns: &mut Vec<u32>, weights: &mut Vec<f32>| match parents[i] {
            [a, b] if a == b => {
                columns.push(a);
                weights.push(1.0);
            }
            [a, b] => {
                columns.extend([a.min(b), a.max(b)]);
                weights.extend([0.5; 2]);
            }
        };
        let rows = |range| SparseMatrix::by_rows(range, add);
        Self::new(SparseMatrix::by_groups(parents.len(), &rows), n_coarse)
    }

    /// The prolongation of conforming linear functions to a mesh that results from bisections. The first `n_coarse`
    /// vertices of this mesh are those of the coarse mesh; `parents` has for each further vertex the two preceding
    /// vertices of which it is the midpoint.
    ///
    /// # Panics
    /// If a parent does not come before its child.
    #[must_use]
    pub fn bisections(parents: impl IntoIterator<Item = [u32; 2]>, n_coarse: usize) -> Self {
        let mut fine = SparseMatrix {
            row_starts: (0..=n_coarse as u32).collect(),
            columns: (0..n_coarse as u32).collect(),
            values: vec![1.0; n_coarse],
        };
        // a vertex lies in one coarse cell: its row has at most as many entries as the cell has vertices
        let mut row: Vec<(u32, f32)> = Vec::new();
        for pair in parents {
            row.clear();
            for parent in pair {
                let (columns, values) = fine.row(parent as usize);
                for (&column, &value) in columns.iter().zip(values) {
                    match row.iter_mut().find(|(known, _)| *known == column) {
                        Some((_, sum)) => *sum += 0.5 * value,
                        None => row.push((column, 0.5 * value)),
                    }
                }
            }
            append(&mut row, &mut fine.columns, &mut fine.values);
            fine.row_starts.push(fine.columns.len() as u32);
        }
        Self::new(fine, n_coarse)
    }

    /// The prolongation of conforming linear functions to the unknowns of another element, each of which
    /// is the mean of the values at the vertices of its location; `None` if a location is empty or has a
    /// vertex that is not less than `n_vertices`.
    pub(crate) fn to_element(locations: &[DofLocation], n_vertices: usize) -> Option<Self> {
        let is_inside = |i: usize| {
            let vertices = locations[i].vertices();
            !vertices.is_empty() && vertices.iter().all(|&v| (v as usize) < n_vertices)
        };
        let rows = |range| {
            SparseMatrix::by_rows(range, |i, columns, weights| {
                let vertices = locations[i].vertices();
                columns.extend(vertices);
                weights.extend(vertices.iter().map(|_| 1.0 / vertices.len() as f32));
            })
        };
        all(locations.len(), is_inside)
            .then(|| Self::new(SparseMatrix::by_groups(locations.len(), &rows), n_vertices))
    }

    /// The prolongation after a renumbering of the unknowns: `fine[i]` and `coarse[j]` are the new numbers of the fine
    /// unknown `i` and of the coarse unknown `j`.
    pub(crate) fn renumbered(&self, fine: &[u32], coarse: &[u32]) -> Self {
        let mut order = vec![0; fine.len()];
        (0..).zip(fine).for_each(|(old, &new): (u32, _)| order[new as usize] = old);
        let mut row: Vec<(u32, f32)> = Vec::new();
        let rows = SparseMatrix::by_rows(0..order.len(), |new, columns, weights| {
            row.clear();
            row.extend(self.parents(order[new] as usize).map(|(j, w)| (coarse[j], w)));
            append(&mut row, columns, weights);
        });
        Self::new(rows, self.n_coarse())
    }

    /// `P` by rows.
    pub(crate) fn rows(&self) -> &SparseMatrix<f32> {
        &self.fine
    }

    /// Number of coarse unknowns.
    pub fn n_coarse(&self) -> usize {
        self.coarse.size()
    }

    /// Number of fine unknowns.
    pub fn n_fine(&self) -> usize {
        self.fine.size()
    }

    /// Sets the coarse residual to `P^T r` for the fine residual `r`, computed in the scalar of the residuals.
    pub(crate) fn restrict<S: Real>(&self, fine_residual: &[S], coarse_residual: &mut [S]) {
        for_each_chunk(coarse_residual, |range, out| {
            for (row, out) in self.coarse.rows(range).zip(out) {
                *out = combination(row, fine_residual);
            }
        });
    }

    /// Adds the entries of `P v`, for the coarse values `v`, to the fine values for which `is_free` is true.
    pub(crate) fn add_prolongation<S: Real>(
        &self,
        coarse_values: &[S],
        is_free: impl Fn(usize) -> bool + Sync,
        fine_values: &mut [S],
    ) {
        for_each_chunk(fine_values, |range, out| {
            for ((i, row), x) in range.clone().zip(self.fine.rows(range)).zip(out) {
                if is_free(i) {
                    *x += combination(row, coarse_values);
                }
            }
        });
    }

    /// The fine values `P v` of coarse values `v`.
    ///
    /// # Panics
    /// If there are fewer values than coarse unknowns.
    pub fn prolongate<S: Real>(&self, coarse_values: &[S]) -> Vec<S> {
        let mut fine = zeros(self.n_fine());
        self.add_prolongation(coarse_values, |_| true, &mut fine);
        fine
    }

    /// Fixes every coarse unknown all of whose children are fixed; coarse unknowns that are fixed
    /// already stay fixed.
    pub(crate) fn fix_covered(&self, fine_fixed: &[bool], coarse_fixed: &mut [bool]) {
        for_each_chunk(coarse_fixed, |range, out| {
            for (j, fixed) in range.zip(out).filter(|(_, fixed)| !**fixed) {
                *fixed = self.children(j).all(|(i, _)| fine_fixed[i]);
            }
        });
    }

    /// The children of the coarse unknown `j` with their weights.
    #[inline(always)]
    pub(crate) fn children(&self, j: usize) -> impl Iterator<Item = (usize, f32)> {
        let (children, weights) = self.coarse.row(j);
        children.iter().map(|&i| i as usize).zip(weights.iter().copied())
    }

    /// The parents of the fine unknown `i` with their weights.
    #[inline(always)]
    pub(crate) fn parents(&self, i: usize) -> impl Iterator<Item = (usize, f32)> {
        let (parents, weights) = self.fine.row(i);
        parents.iter().map(|&j| j as usize).zip(weights.iter().copied())
    }
}

/// The combination of values with the indices and the weights of a row, in the scalar of the values.
#[inline(always)]
fn combination<S: Real>((indices, weights): (&[u32], &[f32]), values: &[S]) -> S {
    let term = |sum, (&k, &weight): (&u32, &f32)| sum + S::lit(weight.into()) * values[k as usize];
    indices.iter().zip(weights).fold(S::lit(0.0), term)
}

/// Appends the entries of a row in the order of their columns.
fn append(row: &mut [(u32, f32)], columns: &mut Vec<u32>, weights: &mut Vec<f32>) {
    sort_by_column(row);
    columns.extend(row.iter().map(|entry| entry.0));
    weights.extend(row.iter().map(|entry| entry.1));
}
