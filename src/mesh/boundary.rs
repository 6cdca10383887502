//! Parts of the boundary.

/// The part of the boundary a facet belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BoundaryPart {
    /// Values are given.
    Dirichlet,
    /// The flux is given.
    Neumann,
    /// The Signorini condition holds.
    Contact,
}

impl BoundaryPart {
    /// The parts.
    pub const ALL: [Self; 3] = [Self::Dirichlet, Self::Neumann, Self::Contact];

    /// The name of the physical group in a mesh file.
    pub fn name(self) -> &'static str {
        match self {
            BoundaryPart::Dirichlet => "dirichlet",
            BoundaryPart::Neumann => "neumann",
            BoundaryPart::Contact => "contact",
        }
    }
    /// The part of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }
}

/// A facet of the boundary: its cell, its number in the cell, its part, its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// The cell.
    pub cell: u32,
    /// The facet is opposite this vertex of the cell.
    pub local: u8,
    /// The part of the boundary; [`BoundaryPart::Neumann`] as long as that of its group is not decided.
    pub part: BoundaryPart,
    /// Number of its group, see [`Mesh::boundary_groups`](super::Mesh::boundary_groups).
    pub group: u16,
}

impl BoundaryFacet {
    /// Sorts facets by cell and number in the cell; not generic, so that the sorting code is
    /// compiled once.
    pub(super) fn sort(facets: &mut [Self]) {
        facets.sort_unstable_by_key(|f| (f.cell, f.local));
    }
}
