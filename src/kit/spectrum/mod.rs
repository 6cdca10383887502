//! Extreme eigenvalues of symmetric positive definite matrices and of pencils of two of them.
//!
//! The condition number of `B^-1 A`, with `B = 1` for that of `A`, determines the number of steps of
//! iterative solvers and the rounding errors of direct ones.
//!
//! ```
//! use unilateral::algebra::SparseMatrix;
//! use unilateral::kit::spectrum::extreme_eigenvalues;
//!
//! let matrix = SparseMatrix {
//!     row_starts: vec![0, 2, 4],
//!     columns: vec![0, 1, 0, 1],
//!     values: vec![2.0, -1.0, -1.0, 2.0],
//! };
//! let identity = SparseMatrix::from_diagonal(vec![1.0; 2]);
//! let found = extreme_eigenvalues(&matrix, &identity, 1e-10).unwrap();
//! assert!((found.condition() - 3.0).abs() < 1e-9);
//! ```

mod inertia;
mod lanczos;
mod mean_jump;

pub use inertia::negative_eigenvalues;
pub use lanczos::{Extremes, SpectrumError, extreme_eigenvalues};
pub use mean_jump::MeanJump;
