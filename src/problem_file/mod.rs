//! Problems of one's own from a TOML file: mesh or box, data by name as numbers or expressions.
//!
//! ```toml
//! name = "plate"
//! mesh = "plate.msh"                 # beside this file; or: box = [[-1, 0], [1, 1]]
//!
//! [coefficient]                      # by region of the mesh; "default" for the rest
//! inclusion = 100.0
//! [source]
//! default = "-10 * sin(pi * x) * y"  # numbers, or expressions in x, y, z
//! [reaction]
//! default = 0.5
//! [obstacle]                         # lower, upper, or both
//! lower.default = "0.2 - x^2 - y^2"
//!
//! [boundary.bore]                    # every boundary group of the mesh
//! kind = "dirichlet"
//! value = 0.0
//! [boundary.teeth]
//! kind = "neumann"
//! flux = "x * nx"                    # nx, ny, nz: the outward unit normal
//! [boundary.foot]
//! kind = "contact"
//! gap = "0.01 * x^2"
//!
//! [exact]                            # where the solution is known
//! value = "x * y"
//! gradient = ["y", "x"]
//! ```
//!
//! The sides of a box are its boundary groups: `left` and `right` across the first axis, `bottom` and `top`
//! across the second, `back` and `front` across the third. What is absent is zero, the coefficient one,
//! an obstacle none. Where two Dirichlet groups meet, the first in the file gives the value. Expressions
//! have `+ - * / ^`, comparisons, `&& || !`, the constants `pi` and `e`, and functions of which an error
//! message lists the names; `if(condition, yes, no)` among them.

mod data;
mod error;
mod expression;
mod table;

pub use error::{ProblemFileError, ProblemFileFault};

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::input::read_file;
use crate::mesh::gmsh::{self, GmshMesh};
use crate::mesh::{BoxDomain, Mesh};
use crate::problem::Problem;
use crate::real::Real;
use table::Source;

/// Where a problem is posed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Geometry<const D: usize> {
    /// A box, with the parts of its sides.
    Box(BoxDomain<D>),
    /// A Gmsh file.
    File {
        /// Its path.
        path: PathBuf,
        /// Its contents.
        bytes: Vec<u8>,
    },
}

/// A problem from a file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OwnProblem<const D: usize> {
    /// Its name; that of the file if the file gives none.
    pub name: String,
    /// The data.
    pub problem: Problem<D>,
    /// Mesh file or box.
    pub geometry: Geometry<D>,
}

impl<const D: usize> OwnProblem<D> {
    /// The mesh of the file, with the parts of its boundary as the problem says; none for a box.
    ///
    /// # Errors
    /// [`Error::Gmsh`] and [`Error::Mesh`], in a scalar in which the mesh degenerates, say.
    pub fn mesh<T: Real>(&self) -> Result<Option<GmshMesh<T, D>>, Error> {
        let Geometry::File { bytes, .. } = &self.geometry else { return Ok(None) };
        let mut read = gmsh::parse::<T, D>(bytes)?;
        read.mesh = self.problem.bind_boundary(read.mesh)?;
        Ok(Some(read))
    }
    /// A mesh to hold the data against.
    fn sample_mesh(&self) -> Result<Mesh<f64, D>, Error> {
        match &self.geometry {
            Geometry::Box(domain) => Ok(Mesh::kuhn_box(domain, domain.counts(4))?),
            Geometry::File { bytes, .. } => Ok(gmsh::parse::<f64, D>(bytes)?.mesh),
        }
    }
}

/// A problem from a file, of any dimension.
#[derive(Clone, Debug)]
pub enum AnyOwnProblem {
    /// In one dimension.
    One(OwnProblem<1>),
    /// In the plane.
    Two(OwnProblem<2>),
    /// In space.
    Three(OwnProblem<3>),
}

impl AnyOwnProblem {
    /// The contents of the mesh file, if there is one.
    pub fn mesh_bytes(&self) -> Option<&[u8]> {
        fn of<const D: usize>(own: &OwnProblem<D>) -> Option<&[u8]> {
            match &own.geometry {
                Geometry::File { bytes, .. } => Some(bytes),
                Geometry::Box(_) => None,
            }
        }
        match self {
            Self::One(own) => of(own),
            Self::Two(own) => of(own),
            Self::Three(own) => of(own),
        }
    }
}

/// Reads a problem and holds its data against its mesh: names, and values at vertices and barycentres.
///
/// # Errors
/// Every [`ProblemFileError`].
pub fn read(path: &Path) -> Result<AnyOwnProblem, ProblemFileError> {
    let unreadable = |source| ProblemFileError::Unreadable { path: path.into(), source };
    let text = String::from_utf8(read_file(path).map_err(unreadable)?)
        .map_err(|e| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, e)))?;
    let source = Source { path, text: &text };
    let root = source.root()?;
    let place = source.place(&root)?;
    Ok(match place.dimension() {
        1 => AnyOwnProblem::One(data::problem(&source, &root, &place)?),
        2 => AnyOwnProblem::Two(data::problem(&source, &root, &place)?),
        _ => AnyOwnProblem::Three(data::problem(&source, &root, &place)?),
    })
}
