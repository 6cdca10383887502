//! Problems of one's own from a TOML file, as scenes: mesh or box, data by name as numbers or expressions.
//!
//! ```toml
//! name = "plate"
//! mesh = "plate.msh"                 # beside this file; or: box = [[-1, 0], [1, 1]]
//!
//! [constants]                        # numbers by name, for the expressions and numbers of the file
//! load = 10.0
//! half = "load / 2"                  # from those above it
//!
//! [coefficient]                      # by region of the mesh; "default" for the rest
//! inclusion = 100.0                 # or a symmetric tensor, [[2, 0.5], [0.5, 1]]
//! [source]
//! default = "-load * sin(pi * x) * y"  # numbers, or expressions in x, y, z
//! inclusion = { value = "sign(x)", level = "x" }  # jumps where the level vanishes: cells are cut there
//! [reaction]
//! default = 0.5
//! [obstacle]                         # lower, upper, or both
//! lower.default = "0.2 - x^2 - y^2"
//!
//! [boundary.bore]                    # by boundary group of the mesh
//! kind = "dirichlet"
//! value = 0.0
//! shape = "x^2 + y^2 - 1"            # zero on the group: new vertices of refinements move there
//! [boundary.teeth]
//! kind = "neumann"
//! flux = "x * nx"                    # nx, ny, nz: the outward unit normal
//! [boundary.wall]
//! kind = "robin"                     # alpha du/dn + coefficient (u - value) = 0
//! coefficient = 5.0
//! value = 20.0
//! [boundary.foot]
//! kind = "contact"
//! gap = "0.01 * x^2"                 # may use the normal as well
//! [boundary.default]                 # every boundary group without a table of its own
//! kind = "neumann"
//!
//! [exact]                            # where the solution is known
//! value = "x * y"
//! gradient = ["y", "x"]
//!
//! [values]                           # numbers of the solution by name, for rows of reports
//! tip = { at = [0.5, 0.5] }
//! mean = { mean = "inclusion" }      # by region, as largest and smallest; "default": all
//! held = { reaction = "bore" }       # by boundary group, as integral and, of contact groups, force
//! ```
//!
//! The sides of a box are its boundary groups: `left` and `right` across the first axis, `bottom` and `top`
//! across the second, `back` and `front` across the third, the lower end first. What is absent is zero, the coefficient one,
//! an obstacle none. Where two Dirichlet groups meet, the first in the file gives the value. Expressions
//! have `+ - * / ^`, comparisons, `&& || !`, the constants `pi` and `e`, and functions of which an error
//! message lists the names; `if(condition, yes, no)` among them.

mod constants;
mod contents;
mod data;
mod error;
mod expression;
mod formula;
mod table;

pub use contents::ProblemFile;
pub use error::{ProblemFileError, ProblemFileErrorKind};

use std::path::Path;

use crate::input::read_file;
use constants::{combinations, suffix};
use table::Source;

/// Reads a problem and holds its data against its mesh: names, and values at vertices and barycentres.
///
/// # Errors
/// Every [`ProblemFileError`].
pub fn read(path: &Path) -> Result<ProblemFile, ProblemFileError> {
    read_with(path, &[]).map(|mut problems| problems.remove(0))
}

/// Reads a problem for every combination of values of its constants, which take the place of those in the file. The
/// names of the problems end in the values of the constants that have several: `plate[load=2]`.
///
/// # Errors
/// Every [`ProblemFileError`].
pub fn read_with(
    path: &Path,
    constants: &[(String, Vec<f64>)],
) -> Result<Vec<ProblemFile>, ProblemFileError> {
    let unreadable =
        |error| ProblemFileError::of_file(path, ProblemFileErrorKind::Unreadable, error);
    let text = String::from_utf8(read_file(path).map_err(unreadable)?)
        .map_err(|e| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, e)))?;
    let of = |chosen| {
        let mut source = Source { path, text: &text, constants: Vec::new() };
        let root = source.root()?;
        source.read_constants(&root, &chosen)?;
        let (place, suffix) = (source.place(&root)?, suffix(constants, &chosen));
        match place.dimension() {
            1 => data::problem::<1>(&source, &root, &place, &suffix),
            2 => data::problem::<2>(&source, &root, &place, &suffix),
            _ => data::problem::<3>(&source, &root, &place, &suffix),
        }
    };
    combinations(constants).into_iter().map(of).collect()
}
