//! Inequalities solved over the parts of a mesh.
//!
//! `hierarchy`: the part of nested meshes. `system`: a scheme on a part. `iteration`: the solve, nested. `solved`:
//! its result, with `files` and `verify`. `over_parts`: what solvers ask of other parts. `preconditioner`,
//! `own_unknowns`: preconditioners of one process with an engine inside; `auxiliary_space`: blocks of cells and
//! conforming linear functions.

mod auxiliary_space;
#[cfg(feature = "report")]
mod files;
mod hierarchy;
mod iteration;
mod over_parts;
mod own_unknowns;
mod preconditioner;
mod solved;
mod system;
mod verify;

pub use hierarchy::PartHierarchy;
pub use iteration::DistributedIteration;
pub use solved::DistributedSolved;
pub use verify::Differences;
