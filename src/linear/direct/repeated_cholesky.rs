//! Cholesky factors of several matrices with the same pattern.

use std::sync::OnceLock;

use super::elimination_order::EliminationOrder;
use super::error::FactorError;
use super::factors::Factors;
use super::symbolic_factor::SymbolicFactor;
use crate::algebra::{PenalisedMatrix, SparseMatrix, Submatrix, barycentre};
use crate::real::Real;

/// Cholesky factorisation of matrices with the same pattern: the order of elimination and the
/// symbolic factor of the first matrix are used for all.
#[derive(Default)]
pub(crate) struct RepeatedCholesky {
    /// A point for each row, if known.
    points: Option<Vec<[f32; 3]>>,
    /// The symbolic factor; empty before the first factorisation.
    symbolic: OnceLock<SymbolicFactor>,
}

impl RepeatedCholesky {
    /// The factorisation of matrices with one row for each jump between two blocks. The point of a row
    /// is the barycentre of the `points` of the unknowns in the jump, if these are known.
    pub fn on_jumps<T: Real>(penalised: &PenalisedMatrix<T>, points: Option<&[[f32; 3]]>) -> Self {
        let centres = |points: &[[f32; 3]]| {
            let is_shared =
                |&jump: &usize| penalised.blocks_of_jump(jump).iter().all(Option::is_some);
            let jumps = (0..penalised.n_jumps()).filter(is_shared);
            jumps.map(|jump| centre_of_jump(penalised, jump, points)).collect()
        };
        Self { points: points.map(centres), symbolic: OnceLock::new() }
    }

    /// The Cholesky factor of a symmetric matrix, given by its lower triangle. All matrices must
    /// have the same pattern.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor<T: Real>(&self, lower: SparseMatrix<T>) -> Result<Factors<T>, FactorError> {
        if let Some(symbolic) = self.symbolic.get() {
            return Factors::cholesky(&mut Submatrix::from(lower), symbolic);
        }
        let all: Vec<u32> = (0..lower.size() as u32).collect();
        let order = EliminationOrder::new(&lower, &all, self.points.as_deref())?;
        let mut lower = Submatrix::from(lower);
        let symbolic = SymbolicFactor::new(&lower, Some(order.into_unknowns()))?;
        Factors::cholesky(&mut lower, self.symbolic.get_or_init(|| symbolic))
    }
}

/// The barycentre of the points of the unknowns in a jump.
fn centre_of_jump<T: Real>(
    penalised: &PenalisedMatrix<T>,
    jump: usize,
    points: &[[f32; 3]],
) -> [f32; 3] {
    let unknowns = penalised.terms_of(jump).iter().flat_map(|term| [term.here, term.there]);
    barycentre(unknowns.filter_map(|unknown| points.get(unknown as usize).copied()))
}
