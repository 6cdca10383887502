//! Extreme eigenvalues of symmetric positive definite matrices and of pencils of two of them.
//!
//! The condition number of `B^-1 A`, with `B` one for that of `A` itself, tells how many steps an
//! iterative solver needs and how much of the rounding unit a direct one loses.
//!
//! ```
//! use unilateral::algebra::SparseMatrix;
//! use unilateral::kit::spectrum::{Diagonal, Factored, Lanczos};
//!
//! let matrix = SparseMatrix {
//!     row_starts: vec![0, 2, 4],
//!     columns: vec![0, 1, 0, 1],
//!     values: vec![2.0, -1.0, -1.0, 2.0],
//! };
//! let a = Factored::new(&matrix).unwrap();
//! let found = Lanczos::default().extremes(&a, &Diagonal::one(2)).unwrap();
//! assert!((found.condition() - 3.0).abs() < 1e-9);
//! ```

mod lanczos;
mod mean_jump;
mod positive;

pub use lanczos::{Extremes, Lanczos, SpectrumError};
pub use mean_jump::MeanJump;
pub use positive::{Diagonal, Factored, Positive};
