//! Traces of basis functions on a facet, and their weights in the flux.

use super::space::metric::CellMetric;
use super::space::tables::{BasisAt, Derivatives};
use crate::element::MAX_BASIS;
use crate::facet::{FacetForm, FacetView, Trace};

/// Most moments of fluxes on a facet: cubics on a triangle, for linears with a bubble in space.
pub(crate) const MAX_FLUX_MOMENTS: usize = 10;

/// The weight of a cell's derivative `T grad u . n` in the flux of a facet: the conductance of the facet
/// times the average weight that the form gives to the cell here or there, over the normal component of the tensor.
#[inline(always)]
pub(crate) fn flux_weight<const D: usize>(
    facet: &FacetView<D>,
    average_weight: f64,
    (is_here, of_normal): (bool, f64),
) -> f64 {
    let weight = match facet.there {
        None => facet.here.coefficient,
        Some(_) => {
            let own = if is_here { average_weight } else { 1.0 - average_weight };
            facet.conductance(average_weight) * own
        }
    };
    weight / of_normal
}

/// Traces of the first `n` basis functions of a cell on its facet `local`, one moment of them. Where the coefficient
/// varies the derivatives with their weights in the flux are given.
///
/// Fluxes are not numbers if the form does not use them, so that a form which reads what it did not
/// ask for fails its first test.
pub(crate) fn traces<const D: usize>(
    form: &dyn FacetForm<D>,
    facet: &FacetView<D>,
    (metric, local): (&CellMetric<D>, usize),
    (is_here, of_normal): (bool, f64),
    (basis, weighted): (&BasisAt, Option<&Derivatives>),
    n: usize,
) -> [Trace; MAX_BASIS] {
    let sign = if is_here { 1.0 } else { -1.0 };
    let mut out = [Trace { jump: 0.0, flux: f64::NAN }; MAX_BASIS];
    for (trace, &value) in out.iter_mut().zip(&basis.values).take(n) {
        trace.jump = sign * value;
    }
    if form.uses_flux() {
        let (derivatives, weight) = match weighted {
            Some(derivatives) => (derivatives, 1.0),
            None => (
                &basis.derivatives,
                flux_weight(facet, form.average_weight(facet), (is_here, of_normal)),
            ),
        };
        let scale = sign * weight / facet.measure;
        let derivatives = metric.normal_derivatives(local, derivatives, n, scale);
        for (trace, derivative) in out.iter_mut().zip(derivatives).take(n) {
            trace.flux = derivative;
        }
    }
    out
}
