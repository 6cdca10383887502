//! The mixed block: the block of the matrix of an over-penalised element on the cells with free and fixed vertex
//! values and on the sides opposite to these cells.

use crate::algebra::{NO_INDEX, SidePenalties, SparseMatrix};
use crate::linear::direct::{FactorError, Factors, minimum_degree_of_groups};
use crate::real::Real;

/// The mixed block, with its solver.
pub(super) struct MixedBlock<'a, T> {
    /// The free vertex values of cells with free and fixed unknowns.
    pub vertex_values: Vec<u32>,
    /// The sides of cells without fixed unknowns that are opposite to cells with free and fixed unknowns.
    pub sides: Vec<u32>,
    /// These sides, with what eliminates their means from the block.
    condensed: Vec<CondensedSide<T>>,
    solver: Box<dyn BlockSolver<T> + 'a>,
    /// Workspace: residual and correction at the vertex values.
    vector: Vec<T>,
}

/// The solver of a block of the matrix on few unknowns.
pub(crate) trait BlockSolver<T>: Send + Sync {
    /// Factors the block of the matrix on some unknowns, ascending.
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
            // the unknowns of a cell stand one after the other, and are coupled to nearly the same unknowns
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
        Self {
            vertex_values: Vec::new(),
            sides: Vec::new(),
            condensed: Vec::new(),
            solver,
            vector: Vec::new(),
        }
    }
}

impl<T: Real> MixedBlock<'_, T> {
    /// Eliminates the means of the sides from the block, each by its entry of `diagonal`, the form of its facet mean
    /// function with itself, and factors what remains on the vertex values.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(
        &mut self,
        matrix: &SparseMatrix<T>,
        penalties: &SidePenalties<T>,
        diagonal: &[T],
    ) -> Result<(), FactorError> {
        let Self { vertex_values, sides, condensed, solver, .. } = self;
        let mut block = matrix.submatrix(vertex_values);
        condensed.clear();
        for &side in &*sides {
            let side = CondensedSide::new(side as usize, vertex_values, penalties, diagonal);
            side.subtract_from(&mut block);
            condensed.push(side);
        }
        solver.factor(&block, vertex_values)
    }

    /// Solves the block for the residual with the entries `r` for vertex values and `g` for facet mean functions. Sets
    /// the entries of `z` at the vertex values of the block to the solution, and adds the solution at the sides of the
    /// block to the entries of `means`.
    pub fn solve(&mut self, r: &[T], g: &[T], means: &mut [T], z: &mut [T]) {
        let Self { vertex_values, condensed, solver, vector, .. } = self;
        vector.clear();
        vector.extend(vertex_values.iter().map(|&i| r[i as usize]));
        for side in &*condensed {
            let share = side.coupling * side.inverse * g[side.side];
            side.values().for_each(|k| vector[k] += share);
        }
        solver.solve(vector);
        for side in &*condensed {
            let sum = side.values().fold(T::lit(0.0), |sum, k| sum + vector[k]);
            means[side.side] += side.inverse * (g[side.side] + side.coupling * sum);
        }
        for (&i, &value) in vertex_values.iter().zip(&*vector) {
            z[i as usize] = value;
        }
    }
}

/// A side whose mean is eliminated from the block.
struct CondensedSide<T> {
    side: usize,
    /// The positions in the block of the free vertex values on the facet, in the opposite cell; then [`NO_INDEX`].
    values: [u32; 3],
    /// The entry of the block of the mean with each of these values, with negative sign.
    coupling: T,
    /// The reciprocal of the diagonal entry of the mean.
    inverse: T,
}

impl<T: Real> CondensedSide<T> {
    /// The side with its opposite values among the `vertex_values` of the block, ascending.
    fn new(
        side: usize,
        vertex_values: &[u32],
        penalties: &SidePenalties<T>,
        diagonal: &[T],
    ) -> Self {
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
        Self { side, values, coupling, inverse: T::lit(1.0) / diagonal[side] }
    }

    fn values(&self) -> impl Iterator<Item = usize> {
        self.values.into_iter().filter(|&k| k != NO_INDEX).map(|k| k as usize)
    }

    /// Subtracts what the elimination of the mean subtracts from the block.
    fn subtract_from(&self, block: &mut SparseMatrix<T>) {
        let change = self.coupling * self.inverse * self.coupling;
        for k in self.values() {
            let (columns, entries) = block.row_mut(k);
            let entries = columns.iter().zip(entries);
            entries.filter(|(j, _)| self.values.contains(j)).for_each(|(_, a)| *a -= change);
        }
    }
}
