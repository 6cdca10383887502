//! Nested iteration: the hierarchy of meshes, the start from conforming P1, and one solve.

mod any_scheme;
mod hierarchy;

pub use any_scheme::{AnyScheme, Solved, Task};
pub use hierarchy::{Hierarchy, P1Solution};
