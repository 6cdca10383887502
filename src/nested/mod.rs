//! One problem solved: nested meshes, the start from conforming P1, the result.
//!
//! [`solve`] is the whole of it for one problem and one scheme. [`NestedIteration`] has the settings and keeps
//! what several schemes share; a [`Study`](crate::study::Study) is a loop over it. [`adapt`] solves on meshes
//! that follow the error bound.

mod adaptive;
mod adaptive_meshes;
mod adaptivity;
mod cascade;
mod hierarchy;
mod iteration;
mod judge;
mod meshes;
mod p1;
mod phase;
mod piece;
mod scheme_solve;
mod solved;
mod system;
mod warnings;

pub use adaptive::{AdaptiveIteration, AdaptiveStep, adapt};
pub use adaptive_meshes::AdaptiveMeshes;
pub use adaptivity::{Adaptivity, Stop};
pub use hierarchy::Hierarchy;
pub(crate) use hierarchy::check_level;
pub use iteration::{NestedIteration, solve};
pub use meshes::Meshes;
pub use phase::Phase;
pub use solved::{KeptSolution, Solved};
pub use system::{System, SystemSolver};
pub(crate) use warnings::warnings_of_forces;
