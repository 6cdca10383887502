//! Krylov methods for one matrix and one preconditioner, on the free unknowns.
//!
//! `conjugate_gradients`: symmetric matrices. `gmres`: all others. `lanczos`: eigenvalues from the
//! coefficients of conjugate gradients. `stopping`: stopping rule and result. `method`: the method that
//! fits an inequality.

mod conjugate_gradients;
mod gmres;
mod lanczos;
mod method;
mod stopping;

pub(crate) use conjugate_gradients::ConjugateGradients;
pub(crate) use method::{KrylovMethod, symmetric_part};
pub(crate) use stopping::{KrylovRun, StopReason, StoppingRule};
