//! Direct solvers of linear systems.
//!
//! `direct_system`: the systems of an inequality. `factors`: Cholesky and LU factors of a submatrix; `symbolic_factor`: the
//! symbolic part of Cholesky. `static_condensation`, `block_inverse`: factors of `K + M^T S M`; `condensed_solution`:
//! solutions by them.

mod block_inverse;
mod condensed_solution;
mod direct_system;
mod error;
mod factors;
mod static_condensation;
mod symbolic_factor;

pub(crate) use direct_system::{DirectSystem, MixedVector, SystemFactors};
pub use error::FactorError;
pub use factors::{Factors, is_positive_definite};
pub(crate) use symbolic_factor::SymbolicFactor;
