//! Numbers only: sparse matrices, and the inequality that every solver and exporter takes.
//!
//! Nothing here knows a mesh, a dimension or a scheme.

pub(crate) mod dense;
mod inequality;
mod matrix;
mod penalised_matrix;
pub(crate) mod submatrix;

pub(crate) use inequality::barycentre;
pub use inequality::{Bound, Contact, Inequality, Start, Support};
pub use matrix::SparseMatrix;
pub(crate) use matrix::transpose;
pub use penalised_matrix::{PenalisedMatrix, Term};
