//! Linear systems: sparse factors, Krylov methods, preconditioners.
//!
//! A system is solved on the *free* unknowns; all other unknowns are *fixed*, by Dirichlet data or
//! because their bound is active.
//!
//! | file | content |
//! |---|---|
//! | `method` | [`LinearMethod`]: the choice between direct and iterative solvers |
//! | `direct/` | the systems of an inequality, Cholesky and LU factors, static condensation |
//! | `krylov/` | conjugate gradients and GMRES |
//! | `precondition/` | preconditioners: multigrid, auxiliary spaces, splitting into facet means and jumps |

pub(crate) mod direct;
pub(crate) mod krylov;
mod method;
pub(crate) mod precondition;

pub use direct::{FactorError, Factors, is_positive_definite};
pub use method::LinearMethod;
pub use precondition::{
    BuiltInPreconditioners, CoarseLevel, CoarseSpaces, P1Level, PreconditionedSystem,
    Preconditioner, PreconditionerFamily, Prolongation,
};
