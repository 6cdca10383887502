//! Reader of Gmsh meshes: MSH 4.1 and 2.2, text and binary. Writer: MSH 4.1, text.
//!
//! The cells of the mesh are the elements of the largest dimension in the file; the names of their
//! physical groups make the regions of the mesh. The groups of its boundary are the elements of one
//! dimension less in physical groups; elements in no group are ignored, so a boundary facet in no group
//! is reported by [`Mesh::with_groups`](crate::mesh::Mesh::with_groups). Groups may have any names, a group
//! without a name is called by its number. The names `dirichlet`, `neumann` and `contact` say what holds on
//! a part of the boundary; for others the data of a problem do, see
//! [`Problem::bind_boundary`](crate::problem::Problem::bind_boundary). Facets of groups that lie between two cells
//! are left out. Elements of higher order are read as straight ones, with a [`GmshWarning`]. There are warnings too
//! of facets of the boundary that lie on each other with different nodes, and of periodic boundaries, whose sides are
//! not tied to each other.
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
//! use unilateral::mesh::gmsh;
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
//! assert_eq!(gmsh::dimension(file)?, 1);
//! let read = gmsh::parse::<1>(file)?;
//! assert_eq!(read.mesh.n_cells(), 2);
//! assert!(read.warnings.is_empty());
//! # Ok::<(), gmsh::GmshError>(())
//! ```

mod assemble;
mod binary;
mod contents;
mod element_types;
mod error;
mod node_index;
mod position;
mod sections;
mod source;
mod text;
mod version_four;
mod version_two;
mod write;

pub use assemble::GmshMesh;
pub use error::{GmshError, GmshWarning};
pub use position::{ElementPosition, FilePosition};
pub use write::{to_text, write};

use crate::input::read_file;
use crate::instances::compiled;
use sections::{Wanted, read_contents};
use std::path::Path;

/// Reads a mesh of dimension `D` from a file.
///
/// # Errors
/// Every [`GmshError`].
pub fn read<const D: usize>(path: &Path) -> Result<GmshMesh<D>, GmshError> {
    let bytes =
        read_file(path).map_err(|source| GmshError::Unreadable { path: path.into(), source })?;
    parse(&bytes)
}

/// Reads a mesh of dimension `D` from the bytes of a file.
///
/// # Errors
/// Every [`GmshError`] but [`GmshError::Unreadable`].
pub fn parse<const D: usize>(bytes: &[u8]) -> Result<GmshMesh<D>, GmshError> {
    compiled!(const D: fn(&[u8]) -> Result<GmshMesh<D>, GmshError> = read_bytes)(bytes)
}

fn read_bytes<const D: usize>(bytes: &[u8]) -> Result<GmshMesh<D>, GmshError> {
    assemble::assemble(&read_contents(bytes, Wanted::Everything)?)
}

/// The largest dimension of an element of a file, from its bytes: the `D` of [`parse`].
///
/// # Errors
/// Errors of the header and of the elements of the file; [`GmshError::NoCells`] if it has only points.
pub fn dimension(bytes: &[u8]) -> Result<usize, GmshError> {
    read_contents(bytes, Wanted::Elements)?.dimension()
}
