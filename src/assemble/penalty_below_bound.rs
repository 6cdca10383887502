//! Penalties below the bound that proves coercivity.

use super::local::view;
use super::space::Space;
use crate::facet::{FacetForm, FacetView};
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};

impl<'a, const D: usize> Space<'a, D> {
    /// The facets whose penalty lies below the bound that proves coercivity: their number and the
    /// one with the smallest quotient of penalty and bound; none if the form has no such bound.
    pub fn penalty_below_bound(&self, form: &dyn FacetForm<D>) -> Option<PenaltyBelowBound> {
        let neighbours = self.neighbours.as_ref()?;
        let least_penalty = form.theory().least_penalty?;
        let mut worst: Option<PenaltyBelowBound> = None;
        for cell in 0..self.mesh.n_cells() {
            for local in 0..=D {
                if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                    && (other as usize) < cell
                {
                    continue;
                }
                let Some(view) = self.facet_view(neighbours, cell, local) else {
                    continue;
                };
                let needed = least_penalty(&view);
                let weight = form.penalty(&view);
                if weight >= needed {
                    continue;
                }
                let facets = worst.map_or(0, |w| w.facets) + 1;
                let here = PenaltyBelowBound { facets, cell, local, weight, needed };
                worst = match worst {
                    Some(w) if w.weight / w.needed <= weight / needed => {
                        Some(PenaltyBelowBound { facets, ..w })
                    }
                    _ => Some(here),
                };
            }
        }
        worst
    }

    /// The view of a facet on which a form acts, from the cell here.
    pub fn facet_view(
        &self,
        neighbours: &Neighbours,
        cell: usize,
        local: usize,
    ) -> Option<FacetView<'a, D>> {
        let metric = self.metric(cell);
        let here = self.side(cell, local, &metric);
        match neighbours.across(cell, local) {
            Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.pins => {
                Some(view(self.mesh, &here, None))
            }
            Neighbour::Boundary(_) | Neighbour::Cut => None,
            Neighbour::Cell { cell: other, local: other_local } => {
                let metric = self.metric(other as usize);
                let there = self.side(other as usize, other_local as usize, &metric);
                Some(view(self.mesh, &here, Some(&there)))
            }
        }
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
