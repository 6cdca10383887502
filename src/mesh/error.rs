//! Errors of meshes.

use std::fmt::Display;

use super::boundary::BoundaryCondition;
use crate::input::excerpt;
use crate::readable_debug::debug_by_display;

/// The reason why lists of vertices and cells are not a mesh, with the place. `Debug` prints the
/// message.
///
/// Cells and vertices are counted from zero in the order given.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct MeshError {
    /// What is wrong.
    pub kind: MeshErrorKind,
    /// The cells in the message.
    pub cells: Vec<usize>,
    /// The vertices in the message by which a mesh file names the place.
    pub vertices: Vec<usize>,
    /// The position in the list of tagged facets of the facet in the message.
    pub tagged_facet: Option<usize>,
    message: String,
}

debug_by_display!(MeshError);

/// What is wrong with a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshErrorKind {
    /// A parameter of a built-in mesh is out of its range.
    Parameter,
    /// The list of cells is empty.
    NoCells,
    /// More cells or vertices than 32-bit numbering holds.
    TooLarge,
    /// The list of cell vertices does not divide by the vertices of a cell.
    IncompleteCell,
    /// A cell names a vertex that does not exist.
    VertexOutOfRange,
    /// A coordinate is not finite.
    NotFinite,
    /// The volume of a cell is at the rounding level of its diameter.
    DegenerateCell,
    /// Two cells have the same vertices.
    RepeatedCell,
    /// A facet belongs to three cells.
    FacetOfThreeCells,
    /// Two cells lie on the same side of the facet that they share.
    FoldedCells,
    /// Two cells contain one point.
    OverlappingCells,
    /// A facet of the boundary is in no group.
    UntaggedFacet,
    /// Two conditions are given for a facet.
    FacetWithTwoConditions,
    /// A facet in a group is not a facet of the boundary.
    NotABoundaryFacet,
    /// Two groups of a boundary facet are given different conditions.
    GroupWithTwoConditions,
    /// Neither the name of a boundary group nor the problem says what holds there.
    UndecidedGroup,
    /// The rounding of its new vertex changes the shape of half a cell.
    TooSmallToBisect,
    /// The shape of a boundary group does not fit the mesh or its refinement.
    Shape,
}

impl MeshError {
    /// The error of this kind with this sentence.
    pub(crate) fn new(kind: MeshErrorKind, message: String) -> Self {
        Self { kind, cells: Vec::new(), vertices: Vec::new(), tagged_facet: None, message }
    }
    pub(super) fn of_cells(self, cells: impl Into<Vec<usize>>) -> Self {
        Self { cells: cells.into(), ..self }
    }
    pub(super) fn of_vertices(self, vertices: &[u32]) -> Self {
        Self { vertices: vertices.iter().map(|&v| v as usize).collect(), ..self }
    }
    pub(super) fn of_tagged_facet(self, tag: usize) -> Self {
        Self { tagged_facet: Some(tag), ..self }
    }
    /// A parameter that is out of its range.
    pub(crate) fn parameter(parameter: &str, value: impl Display, allowed: impl Display) -> Self {
        Self::new(MeshErrorKind::Parameter, format!("{parameter} = {value}: {allowed}"))
    }
    /// More cells, vertices or groups than can be numbered.
    pub(crate) fn too_large(what: &str, count: usize, limit: usize) -> Self {
        let message = format!("the mesh has {count} {what}, at most {limit} can be numbered");
        Self::new(MeshErrorKind::TooLarge, message)
    }
    /// The error for two groups of one boundary facet with different conditions.
    pub(crate) fn two_conditions(
        [first, second]: [&str; 2],
        conditions: [BoundaryCondition; 2],
    ) -> Self {
        let ([first, second], [one, two]) =
            ([first, second].map(excerpt), conditions.map(BoundaryCondition::name));
        let message = format!(
            "boundary groups {first} and {second} share facets, but the first is {one} and the second {two}: give them facets of their own"
        );
        Self::new(MeshErrorKind::GroupWithTwoConditions, message)
    }
    /// The error for a boundary group of undecided condition with these names.
    pub(crate) fn undecided(names: &[String]) -> Self {
        let group = names.iter().map(excerpt).collect::<Vec<_>>().join(", ");
        let message = format!(
            "nothing says what holds on boundary group {group}: give the problem data there (dirichlet_on, neumann_on, signorini_on) and bind it to the mesh (Problem::bind_boundary), or name the group dirichlet, neumann or contact"
        );
        Self::new(MeshErrorKind::UndecidedGroup, message)
    }
}
