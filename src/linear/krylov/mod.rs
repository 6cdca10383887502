//! Krylov methods for one matrix and one preconditioner, on the free unknowns.
//!
//! `conjugate_gradients`: symmetric matrices. `gmres`: all others. `lanczos`: eigenvalues from the
//! coefficients of conjugate gradients. `eigenvalue_run`: the smallest eigenvalue of a preconditioned matrix.
//! `stopping`: stopping rule and result. `method`: the method that fits an inequality. `product`: products with the
//! matrix of an inequality, by stored entries or by the sum `K + M^T S M` (`penalised_product`).

mod conjugate_gradients;
mod eigenvalue_run;
mod gmres;
mod lanczos;
mod method;
mod penalised_product;
mod product;
mod stopping;

pub(crate) use conjugate_gradients::ConjugateGradients;
pub(crate) use eigenvalue_run::{EIGENVALUE_TO_RITZ_VALUE, eigenvalue_run};
pub(crate) use method::{KrylovMethod, symmetric_part};
pub(crate) use product::Product;
pub(crate) use stopping::{KrylovRun, StopReason, StoppingRule};
