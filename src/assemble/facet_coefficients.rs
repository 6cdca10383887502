//! What a facet form comes down to: a few numbers for all facets, a few for each.

use std::convert::Infallible;
use std::ops::Range;

use super::local::flux_weight;
use super::space::Space;
use super::space::metric::Metrics;
use crate::arrays::map_entries;
use crate::facet::{FacetForm, FacetKind, FacetView, Trace};
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryPart, Neighbour};
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
    /// The same of the cell across.
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
        let across = |(cell, local)| match space.coupled_neighbours().across(cell, local) {
            Neighbour::Cell { cell, local } => Some((cell as usize, local as usize)),
            Neighbour::Boundary(_) | Neighbour::Cut => None,
        };
        let fill = |cells: Range<usize>, chunk: &mut [f64]| {
            for (cell, out) in cells.zip(chunk.chunks_exact_mut(per_cell)) {
                for (local, out) in out.chunks_exact_mut(stride).enumerate() {
                    let Some(facet) = kept_view(space, metrics, cell, local) else { continue };
                    out[0] = form.penalty(&facet);
                    if uses_flux {
                        let average_weight = form.average_weight(&facet);
                        (out[1], out[2]) = if space.varies_at((cell, local), across((cell, local)))
                        {
                            (average_weight, 1.0 - average_weight)
                        } else {
                            let of = |is_here| flux_weight(&facet, average_weight, is_here);
                            (of(true), of(false))
                        };
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * per_cell, &mut entries, &fill);
        let is_uniform = form.is_uniform();
        let facets = || (0..n_cells * (D + 1)).map(|k| (k / (D + 1), k % (D + 1)));
        let view = |(cell, local)| kept_view(space, metrics, cell, local);
        let of = |facet: FacetView<'_, D>| Coefficients::of(form, &facet);
        let or_zero = |of: Option<Coefficients>| of.unwrap_or_else(Coefficients::zero);
        let coefficients = if is_uniform {
            let interior = facets().filter_map(view).find(|f| f.kind() == FacetKind::Interior);
            let dirichlet = space.facets_of(BoundaryPart::Dirichlet).find_map(view);
            map_entries([interior, dirichlet], |facet| or_zero(facet.map(of))).into()
        } else {
            facets().map(|facet| or_zero(view(facet).map(of))).collect()
        };
        Self { coefficients, is_uniform, entries, stride }
    }

    /// The numbers of a facet, kept at facet `local` of the cell here, as asked for from that cell
    /// or from the one across.
    #[inline(always)]
    pub fn at<const D: usize>(
        &self,
        here: (usize, usize),
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

/// The view of a facet that carries a form, from the cell with the lower number: what was kept of the
/// cells is read, and products of gradients are left out.
#[inline(always)]
fn kept_view<'a, const D: usize>(
    space: &Space<'a, D>,
    metrics: &Metrics,
    cell: usize,
    local: usize,
) -> Option<FacetView<'a, D>> {
    let side = |place| metrics.side::<D>(place, space.extreme_coefficients(place));
    let there = match space.coupled_neighbours().across(cell, local) {
        Neighbour::Cell { cell: other, .. } if (other as usize) < cell => return None,
        Neighbour::Cell { cell: other, local } => Some(side((other as usize, local as usize)).1),
        Neighbour::Boundary(BoundaryPart::Dirichlet) if !space.pins => None,
        Neighbour::Boundary(_) | Neighbour::Cut => return None,
    };
    let (measure, here) = side((cell, local));
    Some(FacetView::new(space.mesh, (cell, local), measure, here, there))
}
