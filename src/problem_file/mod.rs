//! Problems of one's own from a TOML file, as scenes: mesh or box, data by name as numbers or expressions.
//!
//! ```toml
//! name = "plate"
//! mesh = "plate.msh"                 # beside this file; or: box = [[-1, 0], [1, 1]]
//!
//! [coefficient]                      # by region of the mesh; "default" for the rest
//! inclusion = 100.0
//! [source]
//! default = "-10 * sin(pi * x) * y"  # numbers, or expressions in x, y, z
//! inclusion = { value = "sign(x)", level = "x" }  # jumps where the level vanishes: cells are cut there
//! [reaction]
//! default = 0.5
//! [obstacle]                         # lower, upper, or both
//! lower.default = "0.2 - x^2 - y^2"
//!
//! [boundary.bore]                    # by boundary group of the mesh
//! kind = "dirichlet"
//! value = 0.0
//! [boundary.teeth]
//! kind = "neumann"
//! flux = "x * nx"                    # nx, ny, nz: the outward unit normal
//! [boundary.foot]
//! kind = "contact"
//! gap = "0.01 * x^2"                 # may use the normal as well
//! [boundary.default]                 # every boundary group without a table of its own
//! kind = "neumann"
//!
//! [exact]                            # where the solution is known
//! value = "x * y"
//! gradient = ["y", "x"]
//! ```
//!
//! The sides of a box are its boundary groups: `left` and `right` across the first axis, `bottom` and `top`
//! across the second, `back` and `front` across the third, the lower end first. What is absent is zero, the coefficient one,
//! an obstacle none. Where two Dirichlet groups meet, the first in the file gives the value. Expressions
//! have `+ - * / ^`, comparisons, `&& || !`, the constants `pi` and `e`, and functions of which an error
//! message lists the names; `if(condition, yes, no)` among them.

mod contents;
mod data;
mod error;
mod expression;
mod table;

pub use contents::ProblemFile;
pub use error::{ProblemFileError, ProblemFileErrorKind};

use std::path::Path;

use crate::input::read_file;
use table::Source;

/// Reads a problem and holds its data against its mesh: names, and values at vertices and barycentres.
///
/// # Errors
/// Every [`ProblemFileError`].
pub fn read(path: &Path) -> Result<ProblemFile, ProblemFileError> {
    let unreadable =
        |error| ProblemFileError::of_file(path, ProblemFileErrorKind::Unreadable, error);
    let text = String::from_utf8(read_file(path).map_err(unreadable)?)
        .map_err(|e| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, e)))?;
    let source = Source { path, text: &text };
    let root = source.root()?;
    let place = source.place(&root)?;
    match place.dimension() {
        1 => data::problem::<1>(&source, &root, &place),
        2 => data::problem::<2>(&source, &root, &place),
        _ => data::problem::<3>(&source, &root, &place),
    }
}
