//! Forces of obstacles on facets other than contact facets.
//!
//! | file | content |
//! |---|---|
//! | `mod` | a force; the jump of a normal flux |
//! | `flux_jumps` | the jumps of the normal flux of the function of a pair |
//!
//! What multipliers give of them is found around vertices: [`patches`](super::patches).

mod flux_jumps;

pub(super) use flux_jumps::fade;

use super::quadratics::products_on_facet;
use crate::mesh::HalfFacet;

/// The force of an obstacle on a facet: the flux of a pair leaves the two cells of the facet with this sum or, on a
/// Neumann facet, exceeds the datum by it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FacetForce {
    /// Cell and facet; between two cells the side of the cell with the smaller number.
    pub facet: HalfFacet,
    /// The other side; none on the boundary.
    pub other: Option<HalfFacet>,
    /// The measure of the facet times the force at its vertices, by their numbers in the cell; positive for a lower
    /// obstacle, negative for an upper one. All are equal where the flux has degree zero.
    pub densities: [f64; 4],
}

impl FacetForce {
    /// Cells and facets of the sides.
    pub(in crate::error_bound) fn sides(&self) -> impl Iterator<Item = HalfFacet> {
        [Some(self.facet), self.other].into_iter().flatten()
    }
    /// The integrals of the force times barycentric coordinates, by vertices of the cell.
    pub(in crate::error_bound) fn moments<const D: usize>(&self) -> [f64; 4] {
        products_on_facet::<D>(&self.densities, self.facet.1).map(|row| row.iter().sum())
    }
}

/// A jump of `alpha grad v . n` on a facet, `v` the function of a pair, and the force that the facet gets for it.
#[derive(Clone, Copy)]
pub(in crate::error_bound) struct FluxJump {
    pub force: FacetForce,
    /// The measure of the facet times `alpha grad v . n` from each side, at the vertices of the cell of that side.
    pub normal: [[f64; 4]; 2],
    /// The measure of the facet times the jump, at the vertices of the first cell.
    pub jump: [f64; 4],
    /// The unit of distances from the obstacle: jump per measure times the diameter of the cell over the coefficient, the
    /// smaller one of the two sides.
    pub unit: f64,
    /// The share of the jump that becomes the force, before the force is limited to one sign.
    pub share: f64,
}
