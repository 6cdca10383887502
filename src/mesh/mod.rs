//! Simplicial meshes in one, two and three dimensions.
//!
//! # Conventions
//!
//! * The vertices of a cell are listed in ascending global number. Facet `i` of a cell is opposite
//!   its vertex `i`; its vertices are the others, still ascending. So both cells of a facet see its
//!   vertices in the same order, and no orientation is ever stored.
//! * Barycentric coordinate `i` of a cell has gradient `g_i`; the outward normal of facet `i` is
//!   `-g_i / |g_i|`, the height over it `1 / |g_i|`, its measure `D |K| |g_i|`. In one dimension a
//!   facet is a vertex and its measure is one.
//! * A mesh is immutable once made, and what [`Mesh::new`] accepts carries a finite element space.

mod bisection;
mod boundary;
mod components;
mod domain;
mod edges;
mod error;
mod facets;
mod geometry;
pub mod gmsh;
mod groups;
pub(crate) mod incidence;
mod names;
pub(crate) mod neighbour_numbers;
mod overlap;
mod part;
mod refine;
mod renumber;
mod shapes;
mod simplicial;
mod validate;

pub use bisection::{BisectedMesh, Bisection};
pub use boundary::{BoundaryCondition, BoundaryFacet};
pub(crate) use components::Components;
#[cfg(feature = "problem-files")]
pub(crate) use domain::SIDES;
pub use domain::{BoxDomain, Domain};
#[doc(hidden)]
pub use edges::Edges;
pub(crate) use edges::edge_vertices;
pub use error::{MeshError, MeshErrorKind};
pub(crate) use facets::CELL_LIMIT;
pub use facets::{Facets, HalfFacet, Neighbour, Neighbours};
pub use geometry::CellGeometry;
pub(crate) use geometry::box_search::BoxSearch;
pub(crate) use geometry::describe_point;
pub(crate) use geometry::simplex::{FACTORIAL, cofactors, cross, dot, with_zeros};
pub use groups::BoundaryGroup;
pub use part::{Across, Extent, Layers, Part};
pub use refine::Refinement;
#[cfg(feature = "problem-files")]
pub(crate) use shapes::shape::{Shape, normal_of};
pub use simplicial::Mesh;
pub use validate::{GroupedFacet, TaggedFacet};
