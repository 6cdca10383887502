//! What a facet form comes down to: a few numbers for all facets, a few for each.

use std::any::Any;
use std::convert::Infallible;
use std::ops::Range;

use super::local::{CellSide, flux_weight, view};
use super::space::Space;
use super::space::metric::Metrics;
use crate::facet::{FacetForm, InteriorPenalty, OverPenalty, Trace};
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryPart, Neighbour};
use crate::parallel::cells;
use crate::real::Real;

/// A coefficient of the form, at most linear in the penalty weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficient<T> {
    constant: T,
    by_penalty: T,
}

impl<T: Real> Coefficient<T> {
    #[inline(always)]
    pub fn at(&self, penalty: T) -> T {
        self.constant + self.by_penalty * penalty
    }
}

/// The coefficients of a form in moments of traces: of `[v][u]`, `[v] flux(u)`, `flux(v) [u]` and
/// `flux(v) flux(u)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients<T> {
    pub jump_jump: Coefficient<T>,
    pub jump_flux: Coefficient<T>,
    pub flux_jump: Coefficient<T>,
    pub flux_flux: Coefficient<T>,
}

impl<T: Real> Coefficients<T> {
    fn of<const D: usize>(form: &(impl FacetForm<T, D> + ?Sized)) -> Self {
        // a form that reads fluxes it did not ask for shall fail its first test
        let none = T::lit(if form.uses_flux() { 0.0 } else { f64::NAN });
        let jump = Trace { jump: T::lit(1.0), flux: none };
        let flux = Trace { jump: T::lit(0.0), flux: T::lit(1.0) };
        let read = |v, u| {
            let constant = form.integrand(v, u, T::lit(0.0));
            Coefficient { constant, by_penalty: form.integrand(v, u, T::lit(1.0)) - constant }
        };
        Self {
            jump_jump: read(jump, jump),
            jump_flux: read(jump, flux),
            flux_jump: read(flux, jump),
            flux_flux: read(flux, flux),
        }
    }
}

/// The penalty weight of every facet that carries the form and, where the form uses fluxes, the
/// weights of the normal derivatives of its two cells in the flux. The numbers of a facet stand with
/// the cell here, so that each is computed once.
pub(crate) struct FacetCoefficients<T> {
    pub coefficients: Coefficients<T>,
    entries: Vec<T>,
    /// Numbers for each facet of each cell.
    stride: usize,
}

/// The numbers of one facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacetWeight<T> {
    pub penalty: T,
    /// The weight in the flux of the cell whose rows are made.
    pub own_flux_weight: T,
    /// The weight in the flux of the cell across.
    pub other_flux_weight: T,
}

impl<T: Real> FacetCoefficients<T> {
    /// The weights of a form, in parallel.
    ///
    /// Many forms read a few numbers of a facet only. For forms whose formula the compiler sees it
    /// leaves out all others, down to the metrics of cells: a quarter of the time of an assembly.
    pub fn of<const D: usize>(
        space: &Space<'_, T, D>,
        form: &dyn FacetForm<T, D>,
        metrics: &Metrics<T>,
    ) -> Self {
        let known: &dyn Any = form;
        if let Some(form) = known.downcast_ref::<InteriorPenalty>() {
            Self::of_form(space, form, metrics)
        } else if let Some(form) = known.downcast_ref::<OverPenalty>() {
            Self::of_form(space, form, metrics)
        } else {
            Self::of_form(space, form, metrics)
        }
    }

    fn of_form<const D: usize>(
        space: &Space<'_, T, D>,
        form: &(impl FacetForm<T, D> + ?Sized),
        metrics: &Metrics<T>,
    ) -> Self {
        let neighbours = space.coupled_neighbours();
        let uses_flux = form.uses_flux();
        let stride = if uses_flux { 3 } else { 1 };
        let per_cell = stride * (D + 1);
        let n_cells = space.mesh.n_cells();
        let mut entries = in_large_pages(vec![T::lit(0.0); per_cell * n_cells]);
        let fill = |cells: Range<usize>, piece: &mut [T]| {
            for (cell, out) in cells.zip(piece.chunks_exact_mut(per_cell)) {
                let metric = metrics.at(cell);
                for (local, out) in out.chunks_exact_mut(stride).enumerate() {
                    let here =
                        CellSide { cell, local, metric: &metric, coefficient: space.alpha(cell) };
                    let facet = match neighbours.across(cell, local) {
                        Neighbour::Cell { cell: other, .. } if (other as usize) < cell => continue,
                        Neighbour::Cell { cell: other, local } => {
                            let (cell, local) = (other as usize, local as usize);
                            let metric = metrics.at(cell);
                            let coefficient = space.alpha(cell);
                            let there = CellSide { cell, local, metric: &metric, coefficient };
                            view(space.mesh, &here, Some(&there))
                        }
                        Neighbour::Boundary(BoundaryPart::Dirichlet) if !space.pins => {
                            view(space.mesh, &here, None)
                        }
                        Neighbour::Boundary(_) => continue,
                    };
                    out[0] = form.penalty(&facet);
                    if uses_flux {
                        let average_weight = form.average_weight(&facet);
                        out[1] = flux_weight(&facet, average_weight, true);
                        out[2] = flux_weight(&facet, average_weight, false);
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * per_cell, &mut entries, &fill);
        Self { coefficients: Coefficients::of(form), entries, stride }
    }

    /// The numbers of a facet, kept at facet `local` of the cell here, as asked for from that cell
    /// or from the one across.
    #[inline(always)]
    pub fn at<const D: usize>(&self, here: (usize, usize), from_here: bool) -> FacetWeight<T> {
        let start = (here.0 * (D + 1) + here.1) * self.stride;
        let kept = &self.entries[start..start + self.stride];
        if self.stride == 1 {
            let zero = T::lit(0.0);
            return FacetWeight {
                penalty: kept[0],
                own_flux_weight: zero,
                other_flux_weight: zero,
            };
        }
        let (own, other) = if from_here { (kept[1], kept[2]) } else { (kept[2], kept[1]) };
        FacetWeight { penalty: kept[0], own_flux_weight: own, other_flux_weight: other }
    }
}
