//! Boundary conditions, and the facets on which they hold.

/// The condition that holds on a facet of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BoundaryCondition {
    /// Values are given.
    Dirichlet,
    /// The flux is given.
    Neumann,
    /// The Signorini condition holds.
    Contact,
}

impl BoundaryCondition {
    /// The conditions.
    pub const ALL: [Self; 3] = [Self::Dirichlet, Self::Neumann, Self::Contact];

    /// The name of the physical group in a mesh file.
    pub fn name(self) -> &'static str {
        match self {
            BoundaryCondition::Dirichlet => "dirichlet",
            BoundaryCondition::Neumann => "neumann",
            BoundaryCondition::Contact => "contact",
        }
    }
    /// The condition of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }
}

/// A facet of the boundary: its cell, its number in the cell, its condition, its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// The cell.
    pub cell: u32,
    /// The facet is opposite this vertex of the cell.
    pub local: u8,
    /// The condition; [`BoundaryCondition::Neumann`] as long as that of its group is not decided.
    pub condition: BoundaryCondition,
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
