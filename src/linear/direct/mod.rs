//! Direct solvers of linear systems.
//!
//! `factors`: Cholesky and LU factors of a submatrix; `symbolic_factor`: the symbolic part of Cholesky.
//! `static_condensation`, `block_inverse`: factors of
//! `K + M^T S M`; `condensed_solution`: solutions by them; `assembled_sum`: solutions for quadratics.

mod assembled_sum;
mod block_inverse;
mod condensed_solution;
mod error;
mod factors;
mod static_condensation;
mod symbolic_factor;

pub use error::FactorError;
pub(crate) use factors::add_to_diagonal;
pub use factors::{Factors, is_positive_definite};
pub(crate) use static_condensation::{CondensedFactors, MatrixFactors, StaticCondensation};
pub(crate) use symbolic_factor::{SymbolicFactor, symbolic_factor};
