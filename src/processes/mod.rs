//! Processes that share a mesh: what they tell one another.
//!
//! A process assembles its [part](crate::mesh::Part) of a mesh by the same code as a whole mesh; rows, load
//! and bounds of its own unknowns are those of the whole, bit for bit. What processes have to tell one another
//! passes through one function, [`Exchange::exchange`]. [`in_process`] runs the parts as threads of one
//! process, for tests and as a model of an exchange between processes.
//!
//! Whether bounds contradict each other depends on all data and so on all parts: [`check_bounds`] decides it. A step that may fail in one part ends in [`agree`], which makes its error one
//! of all parts.
//!
//! [`Hierarchy::of_parts`](crate::nested::Hierarchy::of_parts) has the part of one process of nested meshes, on which
//! [`NestedIteration`](crate::nested::NestedIteration) solves as on a whole mesh.

mod agree;
mod check_bounds;
mod error;
mod exchange;
mod numbering;
mod over_parts;

pub use agree::agree;
pub(crate) use agree::agree_on_data;
pub use check_bounds::check_bounds;
pub use error::ExchangeError;
pub use exchange::{Exchange, InProcess, in_process};
pub use numbering::Numbering;
pub(crate) use over_parts::OverParts;
