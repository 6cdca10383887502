//! Errors of meshes.

use super::boundary::BoundaryCondition;
use crate::input::excerpt;
use crate::readable_debug::debug_by_display;

/// The reason why lists of vertices and cells are not a mesh, with the place. `Debug` prints the
/// message.
///
/// Cells and vertices are counted from zero in the order given.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A parameter of a built-in mesh is out of its range.
    #[error("{parameter} = {value}: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given, as text.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// The list of cells is empty.
    #[error("the mesh has no cells of dimension {dimension}")]
    NoCells {
        /// Dimension of the mesh.
        dimension: usize,
    },
    /// More cells or vertices than 32-bit numbering holds.
    #[error("the mesh has {count} {what}, at most {limit} can be numbered")]
    TooLarge {
        /// "cells" or "vertices".
        what: &'static str,
        /// Number of cells or vertices.
        count: usize,
        /// Largest number allowed.
        limit: usize,
    },
    /// The list of cell vertices does not divide by the vertices of a cell.
    #[error("{entries} cell vertices do not make cells of {per_cell}")]
    IncompleteCell {
        /// Length of the list.
        entries: usize,
        /// Vertices of a cell.
        per_cell: usize,
    },
    /// A cell names a vertex that does not exist.
    #[error("cell {cell} names vertex {vertex}, but there are only {vertices}")]
    VertexOutOfRange {
        /// The cell.
        cell: usize,
        /// The vertex in the list of the cell.
        vertex: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A coordinate is not finite.
    #[error("coordinate {axis} of vertex {vertex} is {value}: coordinates must be finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        axis: usize,
        /// Value of the coordinate.
        value: f64,
    },
    /// The volume of a cell is at the rounding level of its diameter.
    #[error(
        "cell {cell} is degenerate: volume {volume:e} against diameter {diameter:e} (vertices {vertices:?})"
    )]
    DegenerateCell {
        /// The cell.
        cell: usize,
        /// Vertices of the cell.
        vertices: Vec<u32>,
        /// Volume of the cell.
        volume: f64,
        /// Diameter of the cell.
        diameter: f64,
    },
    /// Two cells have the same vertices.
    #[error("cells {first} and {second} have the same vertices {vertices:?}")]
    RepeatedCell {
        /// The first of the two.
        first: usize,
        /// The second.
        second: usize,
        /// Vertices of both cells.
        vertices: Vec<u32>,
    },
    /// A facet belongs to three cells.
    #[error(
        "facet {vertices:?} belongs to cells {cells:?}: a facet lies between two cells at most"
    )]
    FacetOfThreeCells {
        /// Vertices of the facet.
        vertices: Vec<u32>,
        /// The first three cells of the facet.
        cells: [usize; 3],
    },
    /// Two cells lie on the same side of the facet that they share.
    #[error(
        "cells {} and {} lie on the same side of their common facet {vertices:?}: the mesh folds over there; correct the coordinates or the cells",
        cells[0], cells[1]
    )]
    FoldedCells {
        /// Vertices of the facet.
        vertices: Vec<u32>,
        /// The two cells.
        cells: [usize; 2],
    },
    /// Two cells contain one point.
    #[error(
        "cells {first} and {second} overlap at {at}: bodies of the mesh lie on each other; leave one of them out, or mesh their union"
    )]
    OverlappingCells {
        /// The first of the two.
        first: usize,
        /// The second.
        second: usize,
        /// A point of both, as coordinates in parentheses.
        at: String,
    },
    /// A facet of the boundary is in no group.
    #[error("boundary facet {vertices:?} of cell {cell}, at {at}, is in no group: {}", remedy(*coincident))]
    UntaggedFacet {
        /// Vertices of the facet.
        vertices: Vec<u32>,
        /// Cell of the facet.
        cell: usize,
        /// Barycentre of the facet, as coordinates in parentheses.
        at: String,
        /// How many facets of the boundary lie on others; zero if this one does not.
        coincident: usize,
    },
    /// Two conditions are given for a facet.
    #[error(
        "facet {vertices:?} is in two groups, {first} and {second}, with different boundary conditions"
    )]
    FacetWithTwoConditions {
        /// Vertices of the facet.
        vertices: Vec<u32>,
        /// The first condition.
        first: &'static str,
        /// The second condition.
        second: &'static str,
        /// Position of the second mention in the list of tagged facets.
        tag: usize,
    },
    /// A facet in a group is not a facet of the boundary.
    #[error("facet {vertices:?} is in group {group} but {why}")]
    NotABoundaryFacet {
        /// Vertices of the facet.
        vertices: Vec<u32>,
        /// The name of the group.
        group: String,
        /// "lies between two cells" or "belongs to no cell".
        why: &'static str,
        /// Position in the list of tagged facets.
        tag: usize,
    },
    /// Two groups of a boundary facet are given different conditions.
    #[error(
        "boundary groups {} and {} share facets, but the first is {} and the second {}: give them facets of their own",
        groups[0], groups[1], conditions[0], conditions[1]
    )]
    GroupWithTwoConditions {
        /// The two groups.
        groups: Box<[String; 2]>,
        /// Their conditions.
        conditions: [&'static str; 2],
    },
    /// Neither the name of a boundary group nor the problem says what holds there.
    #[error(
        "nothing says what holds on boundary group {group}: give the problem data there (dirichlet_on, neumann_on, signorini_on) and bind it to the mesh (Problem::bind_boundary), or name the group dirichlet, neumann or contact{hint}"
    )]
    UndecidedGroup {
        /// The names of the group.
        group: String,
        /// A name that is meant, or nothing.
        hint: String,
    },
    /// The rounding of its new vertex changes the shape of half a cell.
    #[error(
        "cell {cell} cannot be bisected at {at}: rounding changes the volume of its halves; mark no cell there"
    )]
    TooSmallToBisect {
        /// The cell of the mesh before the bisection.
        cell: usize,
        /// The new vertex, as coordinates in parentheses.
        at: String,
    },
}

debug_by_display!(MeshError);

/// What to do with a boundary facet in no group.
fn remedy(coincident: usize) -> String {
    match coincident {
        0 => "put it in one; the names dirichlet, neumann, contact say what holds there, for other names a problem does".to_owned(),
        n => format!(
            "it lies on another one, with nodes of its own, as {n} facets do; {UNITE}, or put both sides of a slit in groups"
        ),
    }
}

/// What to do with facets that lie on each other.
pub(crate) const UNITE: &str = "let bodies that were meshed apart share their nodes (in Gmsh by BooleanFragments or Coherence before meshing)";

impl MeshError {
    /// The error for a boundary group of undecided condition with these names.
    pub(crate) fn undecided(names: &[String]) -> Self {
        let meant = |name: &String| BoundaryCondition::from_name(&name.trim().to_lowercase());
        let hint =
            names.iter().find_map(meant).map(|condition| format!("; write {}", condition.name()));
        let names: Vec<String> = names.iter().map(excerpt).collect();
        Self::UndecidedGroup { group: names.join(", "), hint: hint.unwrap_or_default() }
    }
    /// The cells in the message.
    pub fn cells(&self) -> Vec<usize> {
        match self {
            Self::VertexOutOfRange { cell, .. }
            | Self::DegenerateCell { cell, .. }
            | Self::UntaggedFacet { cell, .. }
            | Self::TooSmallToBisect { cell, .. } => vec![*cell],
            Self::RepeatedCell { first, second, .. }
            | Self::OverlappingCells { first, second, .. } => vec![*first, *second],
            Self::FoldedCells { cells, .. } => cells.to_vec(),
            Self::FacetOfThreeCells { cells, .. } => cells.to_vec(),
            _ => Vec::new(),
        }
    }
    /// The position in the list of tagged facets of the facet in the message.
    pub fn tagged_facet(&self) -> Option<usize> {
        match self {
            Self::FacetWithTwoConditions { tag, .. } | Self::NotABoundaryFacet { tag, .. } => {
                Some(*tag)
            }
            _ => None,
        }
    }
}
