//! A problem from a file.

use std::path::PathBuf;

use crate::error::Error;
use crate::mesh::gmsh::GmshMesh;
use crate::mesh::{BoxDomain, Mesh};
use crate::problem::Problem;

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
        /// Its [`fingerprint`](crate::input::fingerprint).
        fingerprint: String,
        /// The mesh, before the problem says what holds on its boundary.
        read: Box<GmshMesh<D>>,
    },
}

/// A problem from a file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OwnProblem<const D: usize> {
    /// Its name; that of the file if the file gives none.
    pub name: String,
    /// The [`fingerprint`](crate::input::fingerprint) of the file.
    pub fingerprint: String,
    /// The data.
    pub problem: Problem<D>,
    /// Mesh file or box.
    pub geometry: Geometry<D>,
}

impl<const D: usize> OwnProblem<D> {
    /// The mesh of the file, with the parts of its boundary as the problem says; none for a box.
    ///
    /// # Errors
    /// [`Error::Mesh`].
    pub fn mesh(&self) -> Result<Option<GmshMesh<D>>, Error> {
        let Geometry::File { read, .. } = &self.geometry else { return Ok(None) };
        let mut read = GmshMesh::clone(read);
        read.mesh = self.problem.bind_boundary(read.mesh)?;
        Ok(Some(read))
    }
    /// A mesh to hold the data against, of a box one with few cells, whatever its sides.
    pub(super) fn sample_mesh(&self) -> Result<Mesh<D>, Error> {
        match &self.geometry {
            Geometry::Box(domain) => {
                Ok(Mesh::kuhn_box(domain, domain.counts(4).map(|n| n.min(64)))?)
            }
            Geometry::File { read, .. } => Ok(read.mesh.clone()),
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
    /// The fingerprints of the files that have been read: `problem`, and `mesh` if there is one.
    pub fn fingerprints(&self) -> Vec<(&'static str, String)> {
        fn of<const D: usize>(own: &OwnProblem<D>) -> Vec<(&'static str, String)> {
            let mut files = vec![("problem", own.fingerprint.clone())];
            if let Geometry::File { fingerprint, .. } = &own.geometry {
                files.push(("mesh", fingerprint.clone()));
            }
            files
        }
        match self {
            Self::One(own) => of(own),
            Self::Two(own) => of(own),
            Self::Three(own) => of(own),
        }
    }
}
