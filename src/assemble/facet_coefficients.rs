//! The numbers to which a facet form comes down: a few for all facets, a few for each.

use std::convert::Infallible;
use std::ops::Range;

use super::space::Space;
use super::space::form_facets::FormFacet;
use super::space::metric::Metrics;
use super::trace::flux_weight;
use crate::arrays::map_entries;
use crate::facet::{FacetForm, FacetKind, FacetView, Trace};
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::parallel::cells;

/// A coefficient of the form, at most linear in the penalty weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficient {
    constant: f64,
    by_penalty: f64,
}

impl Coefficient {
    #[inline(always)]
    pub fn at(&self, penalty: f64) -> f64 {
        self.constant + self.by_penalty * penalty
    }
}

/// The coefficients of a form in moments of traces: of `[v][u]`, `[v] flux(u)`, `flux(v) [u]` and
/// `flux(v) flux(u)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    pub jump_jump: Coefficient,
    pub jump_flux: Coefficient,
    pub flux_jump: Coefficient,
    pub flux_flux: Coefficient,
}

impl Coefficients {
    /// The coefficients on a facet.
    fn of<const D: usize>(form: &dyn FacetForm<D>, facet: &FacetView<D>) -> Self {
        // a form that reads fluxes it did not ask for shall fail its first test
        let none = if form.uses_flux() { 0.0 } else { f64::NAN };
        let jump = Trace { jump: 1.0, flux: none };
        let flux = Trace { jump: 0.0, flux: 1.0 };
        let read = |v, u| {
            let constant = form.integrand(facet, v, u, 0.0);
            Coefficient { constant, by_penalty: form.integrand(facet, v, u, 1.0) - constant }
        };
        Self {
            jump_jump: read(jump, jump),
            jump_flux: read(jump, flux),
            flux_jump: read(flux, jump),
            flux_flux: read(flux, flux),
        }
    }
    /// Those of no form.
    fn zero() -> Self {
        let zero = Coefficient { constant: 0.0, by_penalty: 0.0 };
        Self { jump_jump: zero, jump_flux: zero, flux_jump: zero, flux_flux: zero }
    }
}

/// The penalty weight of every facet that carries the form and, where the form uses fluxes, the
/// weights of the normal derivatives of its two cells in the flux; where the coefficient varies in one of
/// these, their average weights. The numbers of a facet stand with
/// the cell here, so that each is computed once.
pub(crate) struct FacetCoefficients {
    /// For a uniform form those on interior and on Dirichlet facets, else those of each facet of each
    /// cell.
    coefficients: Vec<Coefficients>,
    is_uniform: bool,
    entries: Vec<f64>,
    /// Numbers for each facet of each cell.
    stride: usize,
}

/// The numbers of one facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacetWeight<'w> {
    pub coefficients: &'w Coefficients,
    pub penalty: f64,
    /// The weight in the flux of the cell whose rows are made; its average weight where the coefficient
    /// varies in one of the cells.
    pub own_flux_weight: f64,
    /// The same of the other cell.
    pub other_flux_weight: f64,
}

impl FacetCoefficients {
    /// The weights of a form, in parallel.
    pub fn of<const D: usize>(
        space: &Space<'_, D>,
        form: &dyn FacetForm<D>,
        metrics: &Metrics,
    ) -> Self {
        let uses_flux = form.uses_flux();
        let stride = if uses_flux { 3 } else { 1 };
        let per_cell = stride * (D + 1);
        let n_cells = space.mesh.n_cells();
        let mut entries = in_large_pages(vec![0.0; per_cell * n_cells]);
        let view = |facet| space.facet_view(facet, Some(metrics));
        let fill = |cells: Range<usize>, chunk: &mut [f64]| {
            for (cell, out) in cells.zip(chunk.chunks_exact_mut(per_cell)) {
                for (local, out) in out.chunks_exact_mut(stride).enumerate() {
                    let Some(facet) = space.counted_facet((cell, local)) else { continue };
                    let of_facet = view(facet);
                    out[0] = form.penalty(&of_facet);
                    if uses_flux {
                        let average_weight = form.average_weight(&of_facet);
                        (out[1], out[2]) = if space.varies_at(facet.here, facet.there) {
                            (average_weight, 1.0 - average_weight)
                        } else {
                            let of = |side, is_here| {
                                let of_normal = space.normal_component(side);
                                flux_weight(&of_facet, average_weight, (is_here, of_normal))
                            };
                            let there = facet.there.unwrap_or(facet.here);
                            (of(facet.here, true), of(there, false))
                        };
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * per_cell, &mut entries, &fill);
        let is_uniform = form.is_uniform();
        let of = |facet: FormFacet| Coefficients::of(form, &view(facet));
        let zero = Coefficients::zero();
        let coefficients = if is_uniform {
            let interior = space.form_facets().find(|facet| facet.there.is_some());
            let mut on_boundary = space.facets_of(BoundaryCondition::Dirichlet);
            let dirichlet = on_boundary.find_map(|facet| space.form_facet(facet));
            map_entries([interior, dirichlet], |facet| facet.map_or(zero, of)).into()
        } else {
            let mut of_all = vec![zero; n_cells * (D + 1)];
            for facet in space.form_facets() {
                of_all[facet.here.0 * (D + 1) + facet.here.1] = of(facet);
            }
            of_all
        };
        Self { coefficients, is_uniform, entries, stride }
    }

    /// The numbers of the facet `here`; its flux weights are first that of the cell whose rows are made, the cell here if
    /// `from_here`, else the cell there.
    #[inline(always)]
    pub fn at<const D: usize>(
        &self,
        here: HalfFacet,
        from_here: bool,
        kind: FacetKind,
    ) -> FacetWeight<'_> {
        let facet = here.0 * (D + 1) + here.1;
        let coefficients = &self.coefficients[if self.is_uniform { kind as usize } else { facet }];
        let start = facet * self.stride;
        let kept = &self.entries[start..start + self.stride];
        let (mut own_flux_weight, mut other_flux_weight) = (0.0, 0.0);
        if self.stride > 1 {
            (own_flux_weight, other_flux_weight) =
                if from_here { (kept[1], kept[2]) } else { (kept[2], kept[1]) };
        }
        FacetWeight { coefficients, penalty: kept[0], own_flux_weight, other_flux_weight }
    }
}
