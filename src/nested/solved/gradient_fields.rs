//! Gradients and fluxes in files for ParaView.

use super::Solved;
use crate::mesh::HalfFacet;
use crate::parallel::vectors::collect;
use crate::paraview::VtuFile;
use crate::real::Point;

/// What files have of gradients, and of the bound with its flux: on own cells, and on the facets of these on the boundary.
#[derive(Default)]
pub(super) struct GradientFields<const D: usize> {
    /// The means of the gradient.
    gradient: Vec<Point<D>>,
    /// The continuous gradient of linears at vertices; empty on parts of a mesh.
    recovered: Vec<Point<D>>,
    /// The shares of the cells in the bound; empty without a bound, as all that follows.
    bound: Vec<f64>,
    /// The means of the flux.
    flux: Vec<Point<D>>,
    facets: Vec<HalfFacet>,
    /// The means of the normal component of the flux on these facets.
    normal_flux: Vec<f64>,
}

impl<const D: usize> GradientFields<D> {
    /// Adds them to a file.
    pub fn add_to<'f>(&'f self, mut file: VtuFile<'f, D>) -> VtuFile<'f, D> {
        if !self.bound.is_empty() {
            file = file.on_cells("bound", &self.bound);
            file = file.vectors_on_cells("flux", &self.flux);
            file = file.on_facets("normal_flux", &self.facets, &self.normal_flux);
        }
        if !self.recovered.is_empty() {
            file = file.vectors_at_vertices("recovered_gradient", &self.recovered);
        }
        file.vectors_on_cells("gradient", &self.gradient)
    }
}

impl<const D: usize> Solved<'_, D> {
    /// Gradients, bound and flux; all parts of a mesh call it. Without an iterate all are empty.
    pub(super) fn gradient_fields(&self) -> GradientFields<D> {
        let Some(function) = self.function() else { return GradientFields::default() };
        let is_recovered = function.degree() == 1 && self.part().is_none();
        let of_function = GradientFields {
            gradient: self.of_own_cells(function.cell_gradients()),
            recovered: if is_recovered { function.recovered_gradient() } else { Vec::new() },
            ..GradientFields::default()
        };
        let Ok((pair, bound, _)) = self.pair_and_bound() else { return of_function };
        let (mesh, flux) = (self.mesh(), &pair.flux);
        let facets: Vec<HalfFacet> =
            mesh.boundary().iter().map(|f| (f.cell as usize, f.local.into())).collect();
        let normal = |&(cell, local): &HalfFacet| {
            flux.through(cell, local) / mesh.geometry(cell).facet_measure(local)
        };
        let normal_flux = facets.iter().map(normal).collect();
        GradientFields {
            bound: self.of_own_cells(bound.cells.clone()),
            flux: self.of_own_cells(collect(mesh.n_cells(), |cell| flux.mean_in(mesh, cell))),
            normal_flux: self.of_own_facets(&facets, normal_flux),
            facets: self.own_facets(facets),
            ..of_function
        }
    }
}
