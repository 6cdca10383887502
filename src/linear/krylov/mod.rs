//! Krylov methods for one matrix and one preconditioner, on the free unknowns.
//!
//! `conjugate_gradients`: symmetric matrices. `gmres`: all others. `lanczos`: eigenvalues from the
//! coefficients of conjugate gradients. `eigenvalue_run`: the smallest eigenvalue of a preconditioned matrix.
//! `stopping`: stopping rule and result. `method`: the method that fits an inequality.

mod conjugate_gradients;
mod eigenvalue_run;
mod gmres;
mod lanczos;
mod method;
mod stopping;

pub(crate) use conjugate_gradients::ConjugateGradients;
pub(crate) use eigenvalue_run::{EIGENVALUE_TO_RITZ_VALUE, eigenvalue_run};
pub(crate) use method::{KrylovMethod, symmetric_part};
pub(crate) use stopping::{KrylovRun, StopReason, StoppingRule};
