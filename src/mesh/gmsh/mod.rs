//! Reader of Gmsh meshes: MSH 4.1 and 2.2, text and binary.
//!
//! The cells of the mesh are the elements of the largest dimension in the file; the names of their
//! physical groups make the regions of the mesh. The groups of its boundary are the elements of one
//! dimension less in physical groups; elements in no group are ignored, so a boundary facet in no group
//! is reported by [`Mesh::with_groups`](crate::mesh::Mesh::with_groups). Groups may have any names, a group
//! without a name is called by its number. The names `dirichlet`, `neumann` and `contact` say which
//! condition holds on their facets; for others the data of a problem do, see
//! [`Problem::bind_boundary`](crate::problem::Problem::bind_boundary). Facets of groups that lie between two cells
//! are left out. Elements of order two are read as straight ones, with a warning; another warning says which facets
//! of the boundary lie on each other with different nodes. The sides of periodic boundaries are not tied to each other.
//!
//! Cells and vertices are numbered anew, along a Hilbert curve, because Gmsh's own numbers scatter neighbours
//! over the memory: of two files that list the same elements in different orders the meshes are equal. Files of
//! fields have the order of the mesh; [`GmshMesh::node_tags`] and [`GmshMesh::element_tags`] lead to the file.
//!
//! In Gmsh the groups are made by lines such as
//!
//! ```text
//! Physical Curve("dirichlet") = {1, 2, 3};
//! Physical Curve("contact") = {4};
//! Physical Surface("domain") = {1};
//! ```
//!
//! in a script, or in its window. In one dimension the boundary is made of points.
//!
//! # Example
//!
//! ```
//! use unilateral::mesh::gmsh::{GmshError, GmshFile};
//!
//! let file = br#"$MeshFormat
//! 2.2 0 8
//! $EndMeshFormat
//! $PhysicalNames
//! 2
//! 0 1 "dirichlet"
//! 1 2 "string"
//! $EndPhysicalNames
//! $Nodes
//! 3
//! 1 0 0 0
//! 2 0.5 0 0
//! 3 1 0 0
//! $EndNodes
//! $Elements
//! 4
//! 1 15 2 1 1 1
//! 2 15 2 1 2 3
//! 3 1 2 2 1 1 2
//! 4 1 2 2 1 2 3
//! $EndElements
//! "#;
//! let file = GmshFile::parse(*file)?;
//! assert_eq!(file.dimension(), 1);
//! let read = file.mesh::<1>()?;
//! assert_eq!(read.mesh.n_cells(), 2);
//! assert!(read.warnings.is_empty());
//! # Ok::<(), GmshError>(())
//! ```

mod assemble;
mod contents;
mod error;
mod sections;
mod source;

pub use assemble::GmshMesh;
pub use error::{GmshError, GmshErrorKind};

use crate::input;
use crate::instances::compiled;
use contents::Contents;
use std::path::Path;

/// A file that has been read, for the mesh of its dimension.
#[derive(Clone)]
pub struct GmshFile {
    contents: Contents,
    dimension: usize,
}

impl GmshFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Those of [`GmshFile::parse`]; [`GmshErrorKind::Unreadable`].
    pub fn read(path: &Path) -> Result<Self, GmshError> {
        let bytes = input::read_file(path).map_err(|error| {
            let message = format!("cannot read {}: {error}", path.display());
            GmshError::new(GmshErrorKind::Unreadable, message).caused_by(error)
        })?;
        Self::parse(bytes)
    }
    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// Errors of the format; [`GmshErrorKind::NoCells`] if the file has only points.
    pub fn parse(bytes: impl Into<Vec<u8>>) -> Result<Self, GmshError> {
        let contents = sections::read_contents(bytes.into())?;
        let dimension = contents.dimension().ok_or_else(|| {
            let message = "the file has no lines, triangles or tetrahedra; mesh before saving, and put the domain in a physical group: Gmsh saves only elements of groups once there is one";
            GmshError::new(GmshErrorKind::NoCells, message)
        })?;
        Ok(Self { contents, dimension })
    }
    /// The dimension of the mesh: the largest one of an element.
    pub fn dimension(&self) -> usize {
        self.dimension
    }
    /// The [`fingerprint`](input::fingerprint) of the file.
    pub fn fingerprint(&self) -> String {
        input::fingerprint(&self.contents.bytes)
    }
    /// The mesh, of dimension `D`.
    ///
    /// # Errors
    /// [`GmshErrorKind::WrongDimension`], and errors of nodes, elements and groups that do not make a mesh.
    pub fn mesh<const D: usize>(&self) -> Result<GmshMesh<D>, GmshError> {
        assemble::check_dimension(self.dimension, D)?;
        compiled!(const D: fn(&Contents) -> Result<GmshMesh<D>, GmshError> = assemble::assemble)(
            &self.contents,
        )
    }
}

impl std::fmt::Debug for GmshFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GmshFile").field("dimension", &self.dimension).finish_non_exhaustive()
    }
}

/// Reads a mesh of dimension `D` from a file.
///
/// # Errors
/// Those of [`GmshFile::read`] and [`GmshFile::mesh`].
pub fn read<const D: usize>(path: &Path) -> Result<GmshMesh<D>, GmshError> {
    GmshFile::read(path)?.mesh()
}
