//! One problem solved: nested meshes, the start from conforming P1, the result.

mod hierarchy;
mod iteration;
mod p1;
mod p1_solution;
mod solved;

pub(crate) use hierarchy::Coarsest;
pub use hierarchy::Hierarchy;
pub use iteration::{Meshes, NestedIteration, solve};
pub use p1_solution::P1Solution;
pub use solved::Solved;
