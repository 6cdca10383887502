//! Penalties below the bound that proves coercivity.

use super::space::Space;
use crate::facet::FacetForm;

impl<const D: usize> Space<'_, D> {
    /// The facets whose penalty lies below the bound that proves coercivity: their number and the
    /// one with the smallest quotient of penalty and bound; none if the form has no such bound.
    pub fn penalty_below_bound(&self, form: &dyn FacetForm<D>) -> Option<PenaltyBelowBound> {
        let least_penalty = form.theory().least_penalty.filter(|_| form.couples())?;
        let mut worst: Option<PenaltyBelowBound> = None;
        for facet in self.form_facets() {
            let view = self.facet_view(facet, None);
            let (needed, weight) = (least_penalty(&view), form.penalty(&view));
            if weight >= needed {
                continue;
            }
            let facets = worst.map_or(0, |w| w.facets) + 1;
            worst = match worst {
                Some(w) if w.weight / w.needed <= weight / needed => {
                    Some(PenaltyBelowBound { facets, ..w })
                }
                _ => {
                    let (cell, local) = facet.here;
                    Some(PenaltyBelowBound { facets, cell, local, weight, needed })
                }
            };
        }
        worst
    }
}

/// A warning: penalties below the bound that proves coercivity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the penalty of {facets} facets lies below the bound that proves coercivity; worst at facet {local} of cell {cell}: {weight:.3e} where {needed:.3e} is enough"
)]
pub struct PenaltyBelowBound {
    /// How many facets lie below.
    pub facets: usize,
    /// Cell of the facet that misses by the largest factor.
    pub cell: usize,
    /// Number of that facet in the cell.
    pub local: usize,
    /// Its weight.
    pub weight: f64,
    /// The weight that is provably enough.
    pub needed: f64,
}
