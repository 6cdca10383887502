//! Cholesky factors of several matrices with the same pattern.

use std::sync::{Mutex, OnceLock};

use super::elimination_order::EliminationOrder;
use super::error::FactorError;
use super::factors::Factors;
use super::symbolic_factor::SymbolicFactor;
use crate::algebra::{SparseMatrix, Submatrix};
use crate::parallel::{lock, once};
use crate::real::Real;

/// Cholesky factorisation of several matrices with the same pattern: the order of elimination and the
/// symbolic factor of the first matrix are used for all of them.
#[derive(Default)]
pub(crate) struct RepeatedCholesky {
    /// The symbolic factor; empty before the first factorisation.
    symbolic: OnceLock<SymbolicFactor>,
    /// The order of elimination of the rows with positive pivots, for quasidefinite matrices; empty before the first
    /// of them.
    order: OnceLock<EliminationOrder>,
    /// The list `blocks` and the symbolic factor of the last quasidefinite matrix; see
    /// [`RepeatedCholesky::factor_quasidefinite`].
    last_symbolic: Mutex<Option<(Vec<u32>, SymbolicFactor)>>,
}

impl RepeatedCholesky {
    /// The Cholesky factor of a symmetric matrix, given by its lower triangle. All matrices must
    /// have the same pattern.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor<T: Real>(&self, lower: SparseMatrix<T>) -> Result<Factors<T>, FactorError> {
        if let Some(symbolic) = self.symbolic.get() {
            return Factors::cholesky(&mut Submatrix::from(lower), symbolic);
        }
        let mut lower = Submatrix::from(lower);
        let symbolic = SymbolicFactor::new(&lower, None)?;
        Factors::cholesky(&mut lower, once(&self.symbolic, || symbolic))
    }

    /// The factors `L D L^T` of a quasidefinite matrix, given by its lower triangle. The pivots of the leading rows are
    /// positive, those of all further rows negative. A further row is eliminated after the last leading row with which
    /// it is coupled. `leading` is the pattern of the leading rows, equal for all matrices; equal lists `blocks` must
    /// mean equal patterns of the further rows.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor_quasidefinite<T: Real>(
        &self,
        leading: &SparseMatrix<T>,
        lower: SparseMatrix<T>,
        blocks: &[u32],
    ) -> Result<Factors<T>, FactorError> {
        let n_positive = leading.size();
        let last = lock(&self.last_symbolic).take();
        let symbolic = match last.filter(|(last, _)| last == blocks) {
            Some((_, symbolic)) => symbolic,
            None => {
                let order = match self.order.get() {
                    Some(order) => order,
                    None => {
                        let all: Vec<u32> = (0..n_positive as u32).collect();
                        let order = EliminationOrder::new(leading, &all)?;
                        once(&self.order, || order)
                    }
                };
                let order = order.with_rows_after_their_columns(&lower);
                SymbolicFactor::new(&Submatrix::from(lower.clone()), Some(order))?
            }
        };
        let lower = Submatrix::from(lower);
        let factors = Factors::quasidefinite(&lower, n_positive, &symbolic);
        *lock(&self.last_symbolic) = Some((blocks.to_vec(), symbolic));
        factors
    }
}
