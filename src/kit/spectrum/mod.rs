//! Extreme eigenvalues of symmetric positive definite matrices and of pencils of two of them.
//!
//! The condition number of `B^-1 A`, with `B = 1` for that of `A`, determines the number of steps of
//! iterative solvers and the rounding errors of direct ones.
//!
//! ```
//! use unilateral::algebra::SparseMatrix;
//! use unilateral::kit::spectrum::{Diagonal, CholeskyMatrix, Lanczos};
//!
//! let matrix = SparseMatrix {
//!     row_starts: vec![0, 2, 4],
//!     columns: vec![0, 1, 0, 1],
//!     values: vec![2.0, -1.0, -1.0, 2.0],
//! };
//! let a = CholeskyMatrix::new(&matrix).unwrap();
//! let found = Lanczos::default().extremes(&a, &Diagonal::identity(2)).unwrap();
//! assert!((found.condition() - 3.0).abs() < 1e-9);
//! ```

mod inertia;
mod lanczos;
mod mean_jump;
mod positive_definite;

pub use inertia::{negative_eigenvalues, smallest_eigenvalue};
pub use lanczos::{Extremes, Lanczos, SpectrumError};
pub use mean_jump::MeanJump;
pub use positive_definite::{CholeskyMatrix, Diagonal, PositiveDefinite};
