//! The traits of preconditioners and of families of them.

use super::coarse_spaces::CoarseSpaces;
use crate::algebra::{Inequality, SparseMatrix};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// A preconditioner `B`: an approximate inverse of a symmetric matrix on the free unknowns, symmetric
/// and positive definite there, zero on the fixed ones.
pub trait Preconditioner<T>: Send + Sync {
    /// The name in reports.
    fn name(&self) -> &'static str;
    /// Sets the fixed unknowns; is called before the first use, and whenever the active set changes.
    ///
    /// # Errors
    /// [`FactorError`] if a diagonal block or a coarse matrix is not positive definite.
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError>;
    /// `z = B r` for a residual `r` that is zero on the fixed unknowns.
    fn apply(&mut self, r: &[T], z: &mut [T]);
    /// The factor by which the norm of the residual is reduced by the solution of a system while the
    /// active set changes.
    fn reduction(&self) -> f64 {
        0.1
    }
}

/// A symmetric matrix that needs a preconditioner.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PreconditionedSystem<'a, T> {
    /// The matrix of the inequality, or its symmetric part if the matrix is not symmetric.
    pub matrix: &'a SparseMatrix<T>,
    /// The inequality.
    pub inequality: &'a Inequality<T>,
    /// The conforming linear functions on the mesh and on coarser meshes.
    pub spaces: &'a CoarseSpaces<T>,
}

impl<'a, T> PreconditionedSystem<'a, T> {
    /// The symmetric part of the matrix of an inequality, with coarse spaces.
    #[must_use]
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        inequality: &'a Inequality<T>,
        spaces: &'a CoarseSpaces<T>,
    ) -> Self {
        Self { matrix, inequality, spaces }
    }
}

/// A family of preconditioners: one for each system.
pub trait PreconditionerFamily<T: Real>: Send + Sync {
    /// The name of a solver with these preconditioners, in reports.
    fn name(&self) -> &'static str;
    /// The preconditioner of a system; `None` if none fits.
    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, T>,
    ) -> Option<Box<dyn Preconditioner<T> + 'a>>;
}
