//! Parts of a mesh in several processes: the numbers that unknowns have in all parts together, the values of
//! unknowns that other parts own, and what parts find together.
//!
//! A process assembles its [part](crate::mesh::Part) of a mesh by the same code as a whole mesh; rows, load
//! and bounds of its own unknowns are those of the whole, bit for bit. What processes have to tell one another
//! passes through one function, [`Exchange::exchange`]. [`in_process`] runs the parts as threads of one
//! process, for tests and as a model of an exchange between processes.
//!
//! Two things depend on all data and so on all parts: the mesh size of a
//! [refined part](crate::mesh::Part::refine), which [`merge_all`] finds, and whether bounds contradict each other,
//! which [`check_bounds`] tells. A step that may fail in one part ends in [`agree`], which makes its error one
//! of all parts.

mod agree;
mod check_bounds;
mod engine;
mod error;
mod exchange;
mod merge;
mod numbering;
#[cfg(feature = "petsc")]
pub mod petsc;
mod process;
mod solve;

pub use agree::agree;
pub use check_bounds::check_bounds;
pub use engine::{Engine, EngineMethod, EngineSolver, OwnData, OwnRows};
pub use error::ExchangeError;
pub use exchange::{Exchange, InProcess, in_process};
pub use merge::{Merge, merge_all};
pub use numbering::Numbering;
pub use process::Process;
pub use solve::{Differences, DistributedIteration, DistributedSolved, PartHierarchy};
