//! Names of regions of cells and of groups of boundary facets.
//!
//! A cell or a boundary facet may be in several named groups. Cells with the same names form a *region*,
//! boundary facets with the same names a *boundary group*; the mesh stores one number for each cell
//! and boundary facet. Refinement keeps both.

use super::boundary::BoundaryCondition;

/// The names that a set of boundary facets has in common, and the condition that holds on them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BoundaryGroup {
    /// The names.
    pub names: Vec<String>,
    /// The condition; none as long as neither a name (`dirichlet`, `neumann`, `contact`) nor a problem
    /// decides.
    pub condition: Option<BoundaryCondition>,
}

/// The regions and boundary groups of a mesh, by number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::mesh) struct Groups {
    /// The names of each region; a mesh without names has one region without names.
    pub regions: Vec<Vec<String>>,
    /// The boundary groups.
    pub boundary: Vec<BoundaryGroup>,
    /// The names of groups that have facets between two cells.
    pub inside: Vec<String>,
}
