//! Inequalities solved over the parts of a mesh, one in each process, with a library for distributed matrices.
//!
//! [`SolverOnParts`] is the solver of a [`NestedIteration`](crate::nested::NestedIteration) on the
//! [parts](crate::nested::Hierarchy::of_parts) of nested meshes: the active set method of one process, whose
//! preconditioners have an [`Engine`] in place of multigrid and factors. What processes tell one another is in
//! [`processes`](crate::processes).
//!
//! `engine`: what a library does. `process`: one of the processes. `solver_on_parts`: the solve. `preconditioner`,
//! `own_unknowns`: preconditioners of one process with an engine inside; `auxiliary_space`: blocks of cells and
//! conforming linear functions. `petsc`: MPI and PETSc.

mod auxiliary_space;
mod engine;

mod own_unknowns;
#[cfg(feature = "petsc")]
pub mod petsc;
mod preconditioner;
mod process;
mod solver_on_parts;

pub use engine::{Engine, EngineMethod, EngineSolver, OwnRows};

pub use process::Process;
pub use solver_on_parts::SolverOnParts;
