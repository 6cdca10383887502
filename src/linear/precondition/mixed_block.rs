//! The mixed block: the block of the matrix of an over-penalised element on the cells with free and fixed vertex
//! values and on the sides opposite to these cells.

use super::facet_mean_form::facet_mean_function;
use crate::algebra::{RectangularMatrix, SparseMatrix, galerkin_product};
use crate::linear::direct::{FactorError, Factors, minimum_degree_of_groups};
use crate::parallel::vectors::for_each_chunk;
use crate::real::Real;

/// The mixed block, with its solver.
pub(super) struct MixedBlock<'a, T> {
    /// The free vertex values of cells with free and fixed unknowns.
    pub vertex_values: Vec<u32>,
    /// The sides of cells without fixed unknowns that are opposite to cells with free and fixed unknowns.
    pub sides: Vec<u32>,
    solver: Box<dyn BlockSolver<T> + 'a>,
    /// Workspace: residual and correction.
    vector: Vec<T>,
}

/// The solver of a block of the matrix on few unknowns.
pub(crate) trait BlockSolver<T>: Send + Sync {
    /// Factors the matrix of a block. `unknowns[k]` is an unknown of the whole matrix that belongs to function `k` of
    /// the block and to no other.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor(&mut self, block: &SparseMatrix<T>, unknowns: &[u32]) -> Result<(), FactorError>;
    /// Replaces a right-hand side by the solution.
    fn solve(&mut self, vector: &mut [T]);
}

/// Factors of a block.
pub(super) struct BlockFactors<T> {
    /// Number of unknowns of a cell.
    cell_size: usize,
    /// `None` for a block without functions, and before the first block.
    factors: Option<Factors<T>>,
}

impl<T> BlockFactors<T> {
    /// No factors yet; consecutive groups of `cell_size` unknowns of the whole matrix belong to a cell.
    pub fn new(cell_size: usize) -> Self {
        Self { cell_size, factors: None }
    }
}

impl<T: Real> BlockSolver<T> for BlockFactors<T> {
    fn factor(&mut self, block: &SparseMatrix<T>, unknowns: &[u32]) -> Result<(), FactorError> {
        // the memory of the old factors is released before the new ones are computed
        self.factors = None;
        if !unknowns.is_empty() {
            // the functions of a cell stand one after the other, and are coupled to nearly the same functions
            let cell = |k: usize| unknowns[k] as usize / self.cell_size;
            let is_first = |k: &usize| *k == 0 || cell(*k) != cell(k - 1);
            let firsts = (0..unknowns.len()).filter(is_first).chain([unknowns.len()]);
            let starts: Vec<u32> = firsts.map(|k| k as u32).collect();
            let order = minimum_degree_of_groups(block, &starts)?;
            self.factors = Some(Factors::of_block(block, order)?);
        }
        Ok(())
    }

    fn solve(&mut self, x: &mut [T]) {
        if let Some(factors) = &self.factors {
            factors.solve_in_place(x, 1);
        }
    }
}

impl<'a, T: Real> MixedBlock<'a, T> {
    /// The empty block, with a solver.
    pub fn new(solver: Box<dyn BlockSolver<T> + 'a>) -> Self {
        Self { vertex_values: Vec::new(), sides: Vec::new(), solver, vector: Vec::new() }
    }
}

impl<T: Real> MixedBlock<'_, T> {
    /// Factors `P^T A P`, where the columns of `P` are the basis functions of the vertex values and
    /// the facet mean functions of the sides.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(
        &mut self,
        matrix: &SparseMatrix<T>,
        cell_size: usize,
    ) -> Result<(), FactorError> {
        let unknowns = [&self.vertex_values[..], &self.sides].concat();
        let n = unknowns.len();
        if n == 0 {
            let (columns, values) = (Vec::new(), Vec::new());
            return self.solver.factor(&SparseMatrix { row_starts: vec![0], columns, values }, &[]);
        }
        let mut entries: Vec<(u32, u32, T)> = Vec::new();
        for (k, &i) in self.vertex_values.iter().enumerate() {
            entries.push((i, k as u32, T::lit(1.0)));
        }
        for (k, &s) in (self.vertex_values.len()..).zip(&self.sides) {
            let (cell, facet) = (s as usize / cell_size, s as usize % cell_size);
            let at_vertex = |i: usize| {
                ((cell * cell_size + i) as u32, k as u32, facet_mean_function(cell_size, i, facet))
            };
            entries.extend((0..cell_size).map(at_vertex));
        }
        entries.sort_unstable_by_key(|&(i, k, _)| (i, k));
        let mut starts = vec![0; matrix.size() + 1];
        for_each_chunk(&mut starts, |range, starts| {
            let mut end = entries.partition_point(|entry| (entry.0 as usize) < range.start);
            for (i, start) in range.zip(starts) {
                let is_before = |entry: &(u32, u32, T)| (entry.0 as usize) < i;
                end += entries[end..].iter().take_while(|entry| is_before(entry)).count();
                *start = end as u32;
            }
        });
        let rows = RectangularMatrix {
            starts,
            columns: entries.iter().map(|entry| entry.1).collect(),
            values: entries.iter().map(|entry| entry.2).collect(),
        };
        let form = galerkin_product(matrix, &rows, n);
        self.solver.factor(&form, &unknowns)
    }

    /// Solves the block for the residual with the entries `r` for vertex values and `g` for facet mean functions. Sets
    /// the entries of `z` at the vertex values of the block to the solution, and adds the solution at the sides of the
    /// block to the entries of `means`.
    pub fn solve(&mut self, r: &[T], g: &[T], means: &mut [T], z: &mut [T]) {
        self.vector.clear();
        self.vector.extend(self.vertex_values.iter().map(|&i| r[i as usize]));
        self.vector.extend(self.sides.iter().map(|&s| g[s as usize]));
        self.solver.solve(&mut self.vector);
        let (values, side_means) = self.vector.split_at(self.vertex_values.len());
        for (&i, &value) in self.vertex_values.iter().zip(values) {
            z[i as usize] = value;
        }
        for (&s, &mean) in self.sides.iter().zip(side_means) {
            means[s as usize] += mean;
        }
    }
}
