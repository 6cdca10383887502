//! Algebraic inequalities as files for other programs, and vectors that come back.
//!
//! Formats: Matrix Market (R. F. Boisvert, R. Pozo, K. Remington, NISTIR 5935, 1996), and the arrays of NumPy
//! (`.npy`, `.npz`; NumPy Enhancement Proposal 1), which `scipy.sparse.load_npz` reads.

mod constants;
mod inequality;
mod npy;
mod npz;

pub use constants::{read_constants, write_constants};
pub use inequality::write_inequality;
pub use npy::read_vector;
