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
    /// Sets the fixed unknowns: those which the linear system does not contain, because Dirichlet data or the active
    /// set prescribe their values. Is called before the first use, and whenever the active set changes.
    ///
    /// # Errors
    /// [`FactorError`] if a diagonal block or a coarse matrix is not positive definite.
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError>;
    /// `z = B r` for a residual `r` that is zero on the fixed unknowns.
    fn apply(&mut self, r: &[T], z: &mut [T]);
    /// The forcing term: while the active set changes, a linear system is solved until the norm of the residual,
    /// divided by the initial norm, is at most the forcing term. An exact solution of such a system is lost work; a
    /// preconditioner whose iterations are expensive beside a change of the active set chooses a larger number.
    fn forcing_term(&self) -> f64 {
        0.1
    }
}

/// A symmetric matrix for which a preconditioner is asked, with the inequality and the spaces from which it can be
/// made.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PreconditionedSystem<'a, T> {
    /// The matrix of the inequality, or its symmetric part if the matrix is not symmetric.
    pub matrix: &'a SparseMatrix<T>,
    /// The inequality.
    pub inequality: &'a Inequality<T>,
    /// The conforming linear functions on the mesh and on coarser meshes, as far as they are known.
    pub spaces: &'a CoarseSpaces<T>,
}

impl<'a, T> PreconditionedSystem<'a, T> {
    /// The symmetric matrix `matrix`, which belongs to `inequality`, with coarse spaces.
    #[must_use]
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        inequality: &'a Inequality<T>,
        spaces: &'a CoarseSpaces<T>,
    ) -> Self {
        Self { matrix, inequality, spaces }
    }
}

/// A family of preconditioners: at most one for each system.
pub trait PreconditionerFamily<T: Real>: Send + Sync {
    /// The name of the family. Reports show it in the name of a solver that uses the family.
    fn name(&self) -> &'static str;
    /// The preconditioner of a system; `None` if none fits.
    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, T>,
    ) -> Option<Box<dyn Preconditioner<T> + 'a>>;
}

/// A preconditioner of the stiffness on Crouzeix-Raviart functions.
pub(crate) trait FacetMeansSolver<T>: Send + Sync {
    /// Sets the facets without a function, the facets with a function that conforming linear functions
    /// alone may correct, and the vertices at which conforming linear functions vanish.
    ///
    /// # Errors
    /// [`FactorError`] if a coarse matrix is not positive definite.
    fn set_fixed(
        &mut self,
        fixed_facets: &[bool],
        kept_facets: &[u32],
        fixed_vertices: &[bool],
    ) -> Result<(), FactorError>;
    /// Sets `means` to the correction of the means on facets for a residual that is zero on facets without a function.
    fn apply(&mut self, residual: &[T], means: &mut [T]);
}
