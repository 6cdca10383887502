//! Numbers only: sparse matrices, and the inequality that every solver and exporter takes.
//!
//! Nothing here knows a mesh, a dimension or a scheme.

mod factored;
mod inequality;
mod matrix;

pub use factored::{Factored, Term};
pub(crate) use inequality::barycentre;
pub use inequality::{Bound, Contact, Inequality, Place, Start};
pub use matrix::SparseMatrix;
pub(crate) use matrix::transpose;
