//! The mixed block of an over-penalised element: the free vertex values of cells with free and fixed values, and the means
//! over the sides opposite to these cells.
//!
//! The block has the entries of the matrix, but none between two means of one cell, so that an elimination of the means is
//! a formula for each of them. With the penalty `p` of a jump and the stiffness `k` of a facet mean function the
//! elimination leaves `p k / (k + p)` of the penalty: what remains is positive definite.

use crate::algebra::{NO_INDEX, SidePenalties, SparseMatrix};
use crate::linear::direct::{FactorError, Factors};
use crate::real::Real;

/// The mixed block, with its solver.
pub(super) struct MixedBlock<'a, T> {
    /// The free vertex values of cells with free and fixed unknowns.
    pub vertex_values: Vec<u32>,
    /// The sides of cells without fixed unknowns that are opposite to cells with free and fixed unknowns.
    pub sides: Vec<u32>,
    /// How the mean over each of these sides is coupled to vertex values of the block.
    couplings: Vec<SideCoupling<T>>,
    solver: Box<dyn BlockSolver<T> + 'a>,
    /// The residual at the vertex values, then the solution.
    vector: Vec<T>,
}

/// The solver of a linear system with few of the unknowns.
pub(crate) trait BlockSolver<T>: Send + Sync {
    /// Factors a symmetric matrix with a row for each of these unknowns, ascending. Over the parts of a mesh the rows of
    /// ghosts may be incomplete.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor(&mut self, block: &SparseMatrix<T>, unknowns: &[u32]) -> Result<(), FactorError>;
    /// Replaces a right-hand side by the solution; over the parts of a mesh also at ghosts, whose right-hand side is not
    /// read.
    fn solve(&mut self, vector: &mut [T]);
}

/// Factors of a block; `None` for a block without functions, and before the first block.
pub(super) struct BlockFactors<T>(pub Option<Factors<T>>);

impl<T: Real> BlockSolver<T> for BlockFactors<T> {
    fn factor(&mut self, block: &SparseMatrix<T>, unknowns: &[u32]) -> Result<(), FactorError> {
        self.0 = None;
        if !unknowns.is_empty() {
            self.0 = Some(Factors::of_block(block)?);
        }
        Ok(())
    }

    fn solve(&mut self, x: &mut [T]) {
        if let Some(factors) = &self.0 {
            factors.solve_in_place(x, 1);
        }
    }
}

impl<'a, T: Real> MixedBlock<'a, T> {
    /// The empty block, with a solver.
    pub fn new(solver: Box<dyn BlockSolver<T> + 'a>) -> Self {
        Self {
            vertex_values: Vec::new(),
            sides: Vec::new(),
            couplings: Vec::new(),
            solver,
            vector: Vec::new(),
        }
    }
}

impl<T: Real> MixedBlock<'_, T> {
    /// Eliminates the means over the sides from the block, and factors what remains on the vertex values. `inverse` has
    /// for each of the sides the reciprocal of the form of its facet mean function with itself.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(
        &mut self,
        matrix: &SparseMatrix<T>,
        penalties: &SidePenalties<T>,
        inverse: &[T],
    ) -> Result<(), FactorError> {
        let Self { vertex_values, sides, couplings, solver, .. } = self;
        let mut block = matrix.submatrix(vertex_values);
        couplings.clear();
        for &side in &*sides {
            let side = side as usize;
            let coupling = SideCoupling::new(side, vertex_values, penalties, inverse[side]);
            coupling.eliminate_from(&mut block);
            couplings.push(coupling);
        }
        solver.factor(&block, vertex_values)
    }

    /// Solves the block for the residual with the entries `r` for vertex values and `g` for facet mean functions.
    pub fn solve(&mut self, r: &[T], g: &[T]) {
        let Self { vertex_values, sides, couplings, solver, vector } = self;
        vector.clear();
        vector.extend(vertex_values.iter().map(|&i| r[i as usize]));
        for (&side, coupling) in sides.iter().zip(&*couplings) {
            let share = coupling.share * g[side as usize];
            coupling.values().for_each(|k| vector[k] += share);
        }
        solver.solve(vector);
    }

    /// Sets the entries of `z` at the vertex values of the block to the solution that [`MixedBlock::solve`] found. At
    /// the sides of the block the entries of `means` have what the diagonal alone gives; what the vertex values add to
    /// that is added.
    pub fn write_solution(&self, means: &mut [T], z: &mut [T]) {
        let Self { vertex_values, sides, couplings, vector, .. } = self;
        for (&side, coupling) in sides.iter().zip(couplings) {
            let sum = coupling.values().fold(T::lit(0.0), |sum, k| sum + vector[k]);
            means[side as usize] += coupling.share * sum;
        }
        for (&i, &value) in vertex_values.iter().zip(vector) {
            z[i as usize] = value;
        }
    }
}

/// The coupling of the mean over a side with the vertex values of the block in the opposite cell.
struct SideCoupling<T> {
    /// The positions in the block of the free vertex values on the facet, in the opposite cell; then [`NO_INDEX`].
    values: [u32; 3],
    /// Minus the entry of the block of the mean with each of these values.
    coupling: T,
    /// `coupling` over the entry of the block of the mean with itself.
    share: T,
}

impl<T: Real> SideCoupling<T> {
    /// The coupling of a side; `vertex_values` are those of the block, ascending.
    fn new(side: usize, vertex_values: &[u32], penalties: &SidePenalties<T>, inverse: T) -> Self {
        let (size, opposite) = (penalties.cell_size, penalties.opposite[side] as usize);
        let cell = opposite - opposite % size;
        let first = vertex_values.partition_point(|&i| (i as usize) < cell);
        let in_cell = (first..).zip(&vertex_values[first..]);
        let in_cell = in_cell.take_while(|(_, i)| (**i as usize) < cell + size);
        // facet `i` of a cell has all vertices but vertex `i`
        let on_facet = in_cell.filter(|(_, i)| **i as usize != opposite);
        let mut values = [NO_INDEX; 3];
        values.iter_mut().zip(on_facet).for_each(|(value, (k, _))| *value = k as u32);
        // the mean over a facet has the same share of each of its values
        let coupling = penalties.penalty[side] / T::lit((size - 1) as f64);
        Self { values, coupling, share: coupling * inverse }
    }

    fn values(&self) -> impl Iterator<Item = usize> {
        self.values.into_iter().filter(|&k| k != NO_INDEX).map(|k| k as usize)
    }

    /// Eliminates the mean from the block.
    fn eliminate_from(&self, block: &mut SparseMatrix<T>) {
        let change = self.coupling * self.share;
        for k in self.values() {
            let (columns, entries) = block.row_mut(k);
            let entries = columns.iter().zip(entries);
            entries.filter(|(j, _)| self.values.contains(j)).for_each(|(_, a)| *a -= change);
        }
    }
}
