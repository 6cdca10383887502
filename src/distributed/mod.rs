//! Parts of a mesh in several processes: the numbers that unknowns have in all parts together, and the values
//! of unknowns that other parts own.
//!
//! A process assembles its [part](crate::mesh::Part) of a mesh by the same code as a whole mesh; rows, load
//! and bounds of its own unknowns are those of the whole, bit for bit. What processes have to tell one another
//! passes through one function, [`Exchange::exchange`]. [`in_process`] runs the parts as threads of one
//! process, for tests and as a model of an exchange between processes.

mod exchange;
mod numbering;

pub use exchange::{Exchange, InProcess, in_process};
pub use numbering::Numbering;
