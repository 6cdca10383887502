//! One level of a multigrid method: its matrix, its fixed unknowns and its smoother.

use std::borrow::Cow;

use crate::algebra::SparseMatrix;
use crate::linear::direct::FactorError;
use crate::linear::precondition::block_gauss_seidel::{ScaledRows, Smoother, smoother};
use crate::linear::precondition::coarse_level::P1Level;
use crate::linear::precondition::prolongation::Prolongation;
use crate::parallel::vectors::zeros;
use crate::real::Real;

/// One level. Unknown `i` is the coefficient of basis function `i`.
pub(super) struct Level<'a, T: Real> {
    /// Number of unknowns of a cell if cells share no unknowns and are smoothed as blocks, else one.
    pub cell_size: usize,
    /// The unknowns that are neither fixed nor smoothed; empty for all levels but the finest.
    pub kept: Vec<u32>,
    /// Flags of unknowns that are fixed besides those with Dirichlet data; empty if there are none.
    pub fixed_besides: Vec<bool>,
    /// The matrix, after truncation.
    pub matrix: Cow<'a, SparseMatrix<T>>,
    /// The matrix without truncation; `None` for the finest level, where there is none.
    pub given: Option<&'a SparseMatrix<T>>,
    /// The rows that may differ from the given matrix because of truncation, ascending.
    pub recomputed_rows: Vec<u32>,
    /// Flags of the fixed unknowns of the finer level when rows were last recomputed; empty before the first time.
    pub fixed_on_finer: Vec<bool>,
    /// The rows that may have changed since the smoother was updated, ascending.
    pub outdated: Vec<u32>,
    /// The rows that may have changed since the coarser level recomputed its rows.
    pub changed_rows: Vec<u32>,
    /// The prolongation from the next coarser level; `None` for the coarsest.
    pub prolongation: Option<Cow<'a, Prolongation>>,
    /// The unknowns with Dirichlet data; empty for the finest level.
    pub dirichlet: &'a [bool],
    /// `None` before the first use, and on a factored coarsest level.
    pub smoother: Option<Box<dyn Smoother<T>>>,
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
        prolongation: Option<Cow<'a, Prolongation>>,
    ) -> Self {
        let n = matrix.size();
        Self {
            cell_size: 1,
            kept: Vec::new(),
            fixed_besides: Vec::new(),
            matrix,
            given: None,
            recomputed_rows: Vec::new(),
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
            given: Some(&level.matrix),
            right_side: zeros(n),
            values: zeros(n),
            ..Self::finest(Cow::Borrowed(&level.matrix), prolongation)
        }
    }
}

impl<T: Real> Level<'_, T> {
    /// Updates the smoother to the rows and the fixed unknowns of the level.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a block of the smoother is not positive definite.
    pub fn update_smoother(&mut self, scale: f64) -> Result<(), FactorError> {
        let previous = self.smoother.take();
        let row = |i: usize| self.matrix.row(i);
        let rows = ScaledRows { row: &row, scale };
        let mut smoother = match previous {
            Some(mut smoother) => {
                smoother.replace_rows(&self.outdated, rows);
                smoother
            }
            None => smoother((self.matrix.size(), self.cell_size), rows),
        };
        self.outdated.clear();
        smoother.set_fixed(&self.fixed, &self.kept)?;
        self.smoother = Some(smoother);
        Ok(())
    }
}
