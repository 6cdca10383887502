//! One level of a multigrid method: its matrix, its fixed unknowns and its smoother.

use std::borrow::Cow;

use crate::algebra::{NO_INDEX, SparseMatrix};
use crate::linear::direct::FactorError;
use crate::linear::precondition::coarse_level::P1Level;
use crate::linear::precondition::gauss_seidel::GaussSeidel;
use crate::linear::precondition::prolongation::Prolongation;
use crate::linear::precondition::smoother::Smoother;
use crate::parallel::vectors::zeros;
use crate::real::Real;

/// If at most one row in this number of rows is outdated, the outdated rows of a smoother are replaced, which
/// is then faster than the construction of a new smoother.
const ROWS_PER_OUTDATED_ROW: usize = 8;

/// One level. Unknown `i` is the coefficient of basis function `i`.
pub(super) struct Level<'a, T: Real> {
    /// Number of unknowns of a cell if cells share no unknowns and are smoothed as blocks, else one.
    pub cell_size: usize,
    /// The unknowns that are neither fixed nor smoothed; empty for all levels but the finest.
    pub kept: Vec<u32>,
    /// Flags of unknowns that are fixed besides those with Dirichlet data; empty if there are none.
    pub fixed_besides: Vec<bool>,
    /// The given matrix, without truncation.
    pub matrix: Cow<'a, SparseMatrix<T>>,
    /// The rows that may differ from the given matrix because of truncation, ascending.
    pub recomputed_rows: Vec<u32>,
    /// Start of each of these rows in `recomputed_values`, and the number of values at the end.
    pub recomputed_starts: Vec<usize>,
    /// The values of these rows, one row after the other; the columns are those of the given matrix.
    pub recomputed_values: Vec<T>,
    /// The index of each row in `recomputed_rows`, [`NO_INDEX`] for all others; empty before rows are
    /// recomputed for the first time.
    pub recomputed_indices: Vec<u32>,
    /// Flags of the fixed unknowns of the finer level when rows were last recomputed; empty before the first time.
    pub fixed_on_finer: Vec<bool>,
    /// The rows that may have changed since the smoother was updated, ascending.
    pub outdated: Vec<u32>,
    /// The rows that may have changed since the coarser level recomputed its rows.
    pub changed_rows: Vec<u32>,
    /// The prolongation from the next coarser level; `None` for the coarsest.
    pub prolongation: Option<Cow<'a, Prolongation<T>>>,
    /// The unknowns with Dirichlet data; empty for the finest level.
    pub dirichlet: &'a [bool],
    /// `None` before the first use, and on a factored coarsest level.
    pub smoother: Option<Smoother>,
    /// The fixed unknowns.
    pub fixed: Vec<bool>,
    /// Workspace of the cycle: right-hand side and values, empty for the finest level, and residual.
    pub right_side: Vec<f32>,
    pub values: Vec<f32>,
    pub residual: Vec<f32>,
}

impl<'a, T: Real> Level<'a, T> {
    /// The finest level.
    pub fn finest(
        matrix: Cow<'a, SparseMatrix<T>>,
        prolongation: Option<Cow<'a, Prolongation<T>>>,
    ) -> Self {
        let n = matrix.size();
        Self {
            cell_size: 1,
            kept: Vec::new(),
            fixed_besides: Vec::new(),
            matrix,
            recomputed_rows: Vec::new(),
            recomputed_starts: vec![0],
            recomputed_values: Vec::new(),
            recomputed_indices: Vec::new(),
            fixed_on_finer: Vec::new(),
            outdated: Vec::new(),
            changed_rows: Vec::new(),
            prolongation,
            dirichlet: &[],
            smoother: None,
            fixed: vec![false; n],
            right_side: Vec::new(),
            values: Vec::new(),
            residual: zeros(n),
        }
    }

    /// A coarser level.
    pub fn coarser(level: &'a P1Level<T>) -> Self {
        let prolongation = level.coarser.as_ref().map(|c| Cow::Borrowed(&*c.prolongation));
        let n = level.size();
        Self {
            dirichlet: &level.fixed,
            right_side: zeros(n),
            values: zeros(n),
            ..Self::finest(Cow::Borrowed(&level.matrix), prolongation)
        }
    }
}

impl<T: Real> Level<'_, T> {
    /// Columns and values of row `i`, after truncation.
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let (columns, values) = self.matrix.row(i);
        match self.recomputed_index(i) {
            Some(k) => {
                let range = self.recomputed_starts[k]..self.recomputed_starts[k + 1];
                (columns, &self.recomputed_values[range])
            }
            None => (columns, values),
        }
    }

    /// The index of row `i` among the recomputed ones, if truncation may have changed the row.
    pub fn recomputed_index(&self, i: usize) -> Option<usize> {
        let index = self.recomputed_indices.get(i).filter(|&&k| k != NO_INDEX);
        index.map(|&k| k as usize)
    }

    /// Updates the smoother to the rows and the fixed unknowns of the level.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if the block of a cell is not positive definite.
    pub fn update_smoother(&mut self, scale: f64) -> Result<(), FactorError> {
        let mut smoother = match self.smoother.take() {
            Some(Smoother::Unknowns(smoother)) => {
                Smoother::Unknowns(self.smoother_by_unknowns(Some(smoother), scale))
            }
            // only the finest level has a smoother by cells, and its rows do not change
            Some(by_cells) => by_cells,
            None => Smoother::by_cells(&self.matrix, self.cell_size, scale)
                .unwrap_or_else(|| Smoother::Unknowns(self.smoother_by_unknowns(None, scale))),
        };
        self.outdated.clear();
        smoother.set_fixed(&self.fixed, &self.kept)?;
        self.smoother = Some(smoother);
        Ok(())
    }

    /// The smoother by unknowns for the present rows: the `previous` one with replaced rows if few rows are outdated,
    /// else a new one.
    fn smoother_by_unknowns(&self, previous: Option<GaussSeidel>, scale: f64) -> GaussSeidel {
        let max_replaced = self.matrix.size() / ROWS_PER_OUTDATED_ROW;
        match previous {
            Some(mut smoother) if self.outdated.len() <= max_replaced => {
                smoother.replace_rows(&self.outdated, |i| self.row(i), scale);
                smoother
            }
            _ if self.recomputed_rows.is_empty() => {
                GaussSeidel::new(&self.matrix, |i| self.matrix.row(i), scale)
            }
            _ => GaussSeidel::new(&self.matrix, |i| self.row(i), scale),
        }
    }
}
