//! The mixed block: the block of the matrix of an over-penalised element on the cells with free and fixed vertex
//! values and on the sides opposite to these cells.

use super::facet_mean_form::facet_mean_function;
use crate::algebra::{RectangularMatrix, SparseMatrix, galerkin_product};
use crate::linear::direct::{FactorError, Factors};
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

/// Factors of a block: in single precision until a block has no Cholesky factor in single precision, in the scalar `T`
/// for this block and all later ones.
///
/// A preconditioner need not be exact, and numeric factors with half the bytes take little more than half the time. The
/// smallest eigenvalues of a block are of the size of the stiffness, the largest ones of the size of the penalty: if
/// the ratio of the penalty to the stiffness exceeds the reciprocal of the machine epsilon of `f32`, pivots have no
/// correct digit in single precision.
pub(super) struct BlockFactors<T> {
    factors: PreparedFactors<T>,
    /// Whether all blocks so far had factors in single precision.
    is_single: bool,
}

/// The factors of the present block.
enum PreparedFactors<T> {
    /// No factors: the block has no functions.
    Empty,
    /// Factors of the block divided by `scale`, and workspace for a right-hand side.
    Single { factors: Factors<f32>, scale: f64, vector: Vec<f32> },
    /// Factors of the block in the scalar `T`.
    Full(Factors<T>),
}

impl<T: Real> BlockFactors<T> {
    /// No factors, before the first block.
    pub fn new() -> Self {
        Self { factors: PreparedFactors::Empty, is_single: true }
    }

    /// The factors of a block in single precision.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor_single(
        block: &SparseMatrix<T>,
        functions: &[u32],
    ) -> Result<PreparedFactors<T>, FactorError> {
        let scale = largest(&block.values);
        let single = SparseMatrix {
            row_starts: block.row_starts.clone(),
            columns: block.columns.clone(),
            values: block.values.iter().map(|a| (a.to_f64() / scale) as f32).collect(),
        };
        let factors = Factors::new(&single, true, functions)?;
        Ok(PreparedFactors::Single { factors, scale, vector: vec![0.0; functions.len()] })
    }
}

/// The largest absolute value of some numbers; one if all are zero.
fn largest<T: Real>(values: &[T]) -> f64 {
    let largest = values.iter().fold(0.0, |m: f64, a| m.max(a.to_f64().abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

impl<T: Real> BlockSolver<T> for BlockFactors<T> {
    fn factor(&mut self, block: &SparseMatrix<T>, _: &[u32]) -> Result<(), FactorError> {
        // the memory of the old factors is released before the new ones are computed
        self.factors = PreparedFactors::Empty;
        if block.size() == 0 {
            return Ok(());
        }
        let functions: Vec<u32> = (0..block.size() as u32).collect();
        if self.is_single {
            match Self::factor_single(block, &functions) {
                Err(FactorError::NotPositive | FactorError::Singular) => self.is_single = false,
                factors => {
                    self.factors = factors?;
                    return Ok(());
                }
            }
        }
        self.factors = PreparedFactors::Full(Factors::new(block, true, &functions)?);
        Ok(())
    }

    fn solve(&mut self, x: &mut [T]) {
        match &mut self.factors {
            PreparedFactors::Empty => {}
            PreparedFactors::Full(factors) => factors.solve_in_place(x, 1),
            PreparedFactors::Single { factors, scale, vector } => {
                // the quotient of a number that is not finite is not finite
                let unit = largest(x);
                vector.iter_mut().zip(&*x).for_each(|(s, x)| *s = (x.to_f64() / unit) as f32);
                factors.solve_in_place(vector, 1);
                let unit = unit / *scale;
                x.iter_mut().zip(&*vector).for_each(|(x, &s)| *x = T::lit(f64::from(s) * unit));
            }
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
        let mut rows =
            RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        let mut rest = entries.iter().peekable();
        for i in 0..matrix.size() as u32 {
            while let Some(&(_, k, value)) = rest.next_if(|entry| entry.0 == i) {
                rows.columns.push(k);
                rows.values.push(value);
            }
            rows.starts.push(rows.columns.len() as u32);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The tridiagonal matrix of a row of `n` points: a spring of stiffness one at each point, and springs of stiffness
    /// `penalty` between neighbours.
    fn springs(n: u32, penalty: f64) -> SparseMatrix<f64> {
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            let neighbours = (i.saturating_sub(1)..=(i + 1).min(n - 1)).filter(|&j| j != i);
            let diagonal = 1.0 + penalty * neighbours.clone().count() as f64;
            for j in i.saturating_sub(1)..=(i + 1).min(n - 1) {
                matrix.columns.push(j);
                matrix.values.push(if i == j { diagonal } else { -penalty });
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix
    }

    /// The largest error of a solution with values of size 1e30, relative to the largest value.
    fn error(factors: &mut BlockFactors<f64>, matrix: &SparseMatrix<f64>) -> f64 {
        let n = matrix.size();
        let expected: Vec<f64> = (0..n).map(|i| 1e30 * (1.0 + (i % 3) as f64)).collect();
        let mut x: Vec<f64> = matrix.residual(&vec![0.0; n], &expected);
        factors.solve(&mut x);
        x.iter().zip(&expected).map(|(x, e)| (x + e).abs() / 3e30).fold(0.0, f64::max)
    }

    #[test]
    fn factors_are_single_unless_pivots_have_no_digit_in_single_precision() {
        let mut factors = BlockFactors::new();
        // entries beyond the range of single precision
        for (penalty, unit, is_single, limit) in [
            (10.0, 1e60, true, 1e-5),
            (1e3, 1e-60, true, 1e-2),
            (1e9, 1.0, false, 1e-5),
            (10.0, 1.0, false, 1e-12),
        ] {
            let mut matrix = springs(50, penalty);
            matrix.values.iter_mut().for_each(|a| *a *= unit);
            factors.factor(&matrix, &[]).unwrap();
            assert_eq!(factors.is_single, is_single, "{penalty}");
            let error = error(&mut factors, &matrix);
            assert!(error < limit, "{penalty}: {error}");
        }
        let empty = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        factors.factor(&empty, &[]).unwrap();
        factors.solve(&mut []);
    }
}
