//! The obstacle that gives the active bound of an unknown: the multiplier of the unknown belongs to that bound.
//!
//! Of several data that bind an unknown below the largest counts, above the smallest: obstacles of the regions around
//! it and the gaps of its contact facets. The datum that the bound of the unknown equals is found again here, since
//! nothing but the bound itself is kept.

use std::ops::Range;

use super::obstacle_coefficients::Binding;
use super::{Space, Terms};
use crate::algebra::{Bound, Contact};
use crate::constraint::BoundBy;
use crate::mesh::HalfFacet;
use crate::parallel::cells;
use crate::problem::Datum;

/// A datum gives a bound if they differ by at most this many units of rounding.
const ROUNDINGS: f64 = 16.0;

/// Where obstacles give the active bounds of unknowns.
#[derive(Debug)]
pub(crate) struct ActiveObstacles {
    /// Whether the problem has obstacles: then they give all active bounds of which nothing else is known.
    has_obstacle: bool,
    /// By cell a bit for each of its unknowns: whether the cell may carry a share of the multiplier that obstacles have
    /// there. Empty where all cells may: for one obstacle without names and no gap.
    in_cells: Vec<u32>,
    /// By unknown whether an obstacle gives the active bound; empty as above.
    at_unknowns: Vec<bool>,
}

impl ActiveObstacles {
    /// Whether a cell carries a share of the multiplier that obstacles have at its unknown `i`. Of each unknown some
    /// cell does.
    pub fn act_in(&self, cell: usize, i: usize) -> bool {
        self.in_cells.get(cell).is_none_or(|bits| bits >> i & 1 == 1)
    }
    /// Whether an obstacle gives the active bound of an unknown.
    pub fn act_at(&self, unknown: usize) -> bool {
        self.at_unknowns.get(unknown).map_or(self.has_obstacle, |at| *at)
    }
}

impl<const D: usize> Space<'_, D> {
    /// Where obstacles give the active bounds. Where obstacle and gap are equal it is the obstacle; of equal obstacles
    /// of two regions both do.
    pub(crate) fn active_obstacles(
        &self,
        bounds: &[Bound<f64>],
        contact: &[Contact],
    ) -> ActiveObstacles {
        let has_obstacle = self.problem.has_obstacle();
        let by_region = self.data.lower.has_names() || self.data.upper.has_names();
        let mut found =
            ActiveObstacles { has_obstacle, in_cells: Vec::new(), at_unknowns: Vec::new() };
        let on_boundary = self.problem.acts_on_boundary();
        if !has_obstacle || !(by_region || on_boundary) {
            return found;
        }
        let terms = self.node_terms(&self.facet_rule);
        let nodes: Vec<(usize, BoundBy)> = self.bounded_nodes().collect();
        let is_active = |unknown: usize| {
            bounds[unknown].is_inequality() && contact.get(unknown) != Some(&Contact::Inactive)
        };
        // the unknowns of a cell that are active, and those of them to which its obstacles give the bound
        let bits_of = |cell: usize| {
            let (mut active, mut given) = (0_u32, 0_u32);
            for &node in &nodes {
                let unknown = self.dofs.of(cell, node.0);
                if is_active(unknown) {
                    active |= 1 << node.0;
                    let state = contact.get(unknown).copied();
                    let gives = self.obstacle_gives(&terms, cell, node, bounds[unknown], state);
                    given |= u32::from(gives) << node.0;
                }
            }
            [active, given]
        };
        let bits = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            cells.map(bits_of).collect::<Vec<_>>()
        });
        let bits = bits.concat();
        found.at_unknowns = self.unknowns_without_gap();
        let mut has_cell = vec![false; bounds.len()];
        for (cell, [active, given]) in bits.iter().enumerate() {
            for i in 0..self.per_cell() {
                let unknown = self.dofs.of(cell, i);
                found.at_unknowns[unknown] |= given >> i & 1 == 1;
                has_cell[unknown] |= (!active | given) >> i & 1 == 1;
            }
        }
        let without_cell = |cell: usize| {
            let lost = (0..self.per_cell()).filter(|&i| !has_cell[self.dofs.of(cell, i)]);
            lost.fold(0, |bits, i| bits | 1 << i)
        };
        let in_cells = bits.iter().enumerate();
        found.in_cells =
            in_cells.map(|(cell, [active, given])| !active | given | without_cell(cell)).collect();
        found
    }

    /// Whether an obstacle of a cell gives the active bound at a node.
    fn obstacle_gives(
        &self,
        terms: &[Terms],
        cell: usize,
        node: (usize, BoundBy),
        bound: Bound<f64>,
        state: Option<Contact>,
    ) -> bool {
        let region = self.mesh.region(cell);
        let gives = |datum, bound| self.datum_gives(datum, terms, cell, node, bound);
        let lower = (Binding::Lower, self.data.lower.of(region));
        let upper = (Binding::Upper, self.data.upper.of(region));
        (state != Some(Contact::Upper) && gives(lower, bound.lower()))
            || (state != Some(Contact::Lower) && gives(upper, bound.upper()))
    }

    /// By unknown whether neither a gap nor friction binds it.
    fn unknowns_without_gap(&self) -> Vec<bool> {
        let mut without = vec![true; self.dofs.size()];
        for ((cell, local), group) in self.facets_of_forces() {
            if self.data.friction.of(group).or(self.data.gap.of(group)).is_some() {
                let bounded = self.bounded_nodes_on(local);
                bounded.for_each(|(i, _)| without[self.dofs.of(cell, i)] = false);
            }
        }
        without
    }

    /// Whether the gap of a contact facet gives the lower bound of the unknown at a node.
    pub(crate) fn gap_gives(
        &self,
        ((cell, local), group): (HalfFacet, usize),
        node: (usize, BoundBy),
        terms: &[Terms],
        bound: Bound<f64>,
    ) -> bool {
        let gap = (Binding::Gap(local), self.data.gap.of(group));
        self.datum_gives(gap, terms, cell, node, bound.lower())
    }

    /// Whether a datum in a cell gives a bound at a node, which was rounded once; false without a datum or a bound.
    fn datum_gives(
        &self,
        (binding, datum): (Binding, Option<&Datum<D>>),
        terms: &[Terms],
        cell: usize,
        (i, by): (usize, BoundBy),
        bound: Option<f64>,
    ) -> bool {
        let Some((datum, bound)) = datum.zip(bound) else { return false };
        let value = self.bound(by, &terms[i], (cell, &self.nodes[i]), (binding, datum));
        let rounding = ROUNDINGS * (f64::EPSILON * bound.abs() + datum.rounding());
        value.is_ok_and(|value| (value - bound).abs() <= rounding)
    }
}
