//! Nested iteration: the hierarchy of meshes, the start from conforming P1, and one solve.

mod hierarchy;
mod solve;

pub use hierarchy::{Hierarchy, P1Solution};
pub use solve::{Solved, Task, solve};
