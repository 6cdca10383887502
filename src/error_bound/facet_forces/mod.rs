//! Forces of obstacles on facets other than contact facets.
//!
//! | file | content |
//! |---|---|
//! | `mod` | a force, and one that is asked for |
//! | `asked` | the forces that the function of a pair asks for |
//!
//! What multipliers give of them is found around vertices: [`patches`](super::patches).

mod asked;

use super::quadratics::products_on_facet;
use crate::mesh::{HalfFacet, Mesh};

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
    /// The density at a vertex of one of the two cells, by its number there.
    pub(in crate::error_bound) fn at_vertex<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        (cell, vertex): (usize, usize),
    ) -> f64 {
        let vertex = mesh.cell(cell)[vertex];
        let place = mesh.cell(self.facet.0).iter().position(|&v| v == vertex);
        self.densities[place.expect("both cells of a facet have its vertices")]
    }
    /// The integrals of the force times barycentric coordinates, by vertices of the cell.
    pub(in crate::error_bound) fn moments<const D: usize>(&self) -> [f64; 4] {
        products_on_facet::<D>(&self.densities, self.facet.1).map(|row| row.iter().sum())
    }
}

/// A force that the function of a pair asks for.
#[derive(Clone, Copy)]
pub(in crate::error_bound) struct AskedForce {
    pub force: FacetForce,
    /// The measure of the facet times `alpha grad v . n` from each side, at the vertices of the cell of that side.
    pub normal: [[f64; 4]; 2],
    /// The share of what is asked for that the force has.
    pub share: f64,
}
