//! Contact forces of quadratics, changed along a facet.
//!
//! On a contact facet `F` the normal flux is the contact force, which must not be negative. A number added to the
//! density `c_Fj` at one vertex and taken from that at another keeps the force of the facet; taken from
//! `c_jj` and added to that of the other vertex it keeps the divergence in the cell. What changes is the mismatch, and
//! the complementarity of the contact force.

use super::cells::Cells;
use crate::assemble::space::{Place, Space};
use crate::error_bound::PrimalDualPair;
use crate::error_bound::quadratics::vertices_of;
use crate::error_bound::terms::limit;
use crate::mesh::BoundaryPart;
use crate::quadrature::facet_to_cell;
use crate::real::Real;

/// Visits of each pair of vertices of each facet.
const SWEEPS: usize = 4;

/// A contact facet.
struct ContactFacet {
    /// The cell among those of the exchange, and the number of the facet in it.
    at: Place,
    /// The mean distances from the gap times barycentric coordinates.
    gaps: [f64; 4],
    /// By how much a force of the other sign counts: the factor of the root of the sum of the squares of its values at
    /// the vertices.
    variation: f64,
    /// Whether the force is nowhere negative.
    has_one_sign: bool,
}

impl<const D: usize> Cells<'_, D> {
    /// Adds to the density of a facet at a vertex, and keeps the divergence.
    fn add_to_force(&mut self, (k, local): Place, vertex: usize, change: f64) {
        let start = self.cells[k].number * Self::N;
        self.flux[start + local * (D + 1) + vertex] += change;
        self.flux[start + vertex * (D + 2)] -= change;
    }

    /// The density of a facet at a vertex.
    fn force(&self, (k, local): Place, vertex: usize) -> f64 {
        self.flux[self.cells[k].number * Self::N + local * (D + 1) + vertex]
    }

    /// Moves a contact force towards its mean, until it is nowhere negative: if that costs less than its negative
    /// part counts for.
    fn make_force_positive(&mut self, facet: &mut ContactFacet) {
        let at = facet.at;
        let mean = vertices_of::<D>(at.1).map(|j| self.force(at, j)).sum::<f64>() / D as f64;
        let mut values = [mean; 4];
        vertices_of::<D>(at.1).for_each(|j| values[j] = self.force(at, j));
        let share = limit(mean, &values[..=D]);
        facet.has_one_sign = mean > 0.0;
        if share == 1.0 || mean <= 0.0 {
            return;
        }
        let squares: f64 = values[..=D].iter().map(|c| (c - mean).powi(2)).sum();
        let of_negative = (1.0 - share) * facet.variation * squares.sqrt();
        let limit = (self.mismatch(at.0).sqrt() + of_negative).powi(2);
        let changes = values.map(|c| (1.0 - share) * (mean - c));
        vertices_of::<D>(at.1).for_each(|j| self.add_to_force(at, j, changes[j]));
        if self.mismatch(at.0) > limit {
            vertices_of::<D>(at.1).for_each(|j| self.add_to_force(at, j, -changes[j]));
            facet.has_one_sign = false;
        }
    }

    /// Exchanges the contact force of a facet between two of its vertices.
    fn exchange_force(&mut self, facet: &ContactFacet, [a, b]: [usize; 2]) {
        let (k, local) = facet.at;
        let terms = [
            (local * (D + 1) + a, 1.0),
            (local * (D + 1) + b, -1.0),
            (a * (D + 2), -1.0),
            (b * (D + 2), 1.0),
        ];
        let slope: f64 = terms.iter().map(|(number, sign)| sign * self.slope(k, *number)).sum();
        let mut curvature = 0.0;
        for (row, sign) in terms {
            for (column, other) in terms {
                curvature += sign * other * self.product(k, row, column);
            }
        }
        let least = -(slope + facet.gaps[a] - facet.gaps[b]) / curvature;
        let (most, fewest) = (self.force(facet.at, b), -self.force(facet.at, a));
        let change = least.min(most.max(0.0)).max(fewest.min(0.0));
        if change.is_finite() {
            self.add_to_force(facet.at, a, change);
            self.add_to_force(facet.at, b, -change);
        }
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Changes the contact forces of quadratics along facets, as far as that makes the bound smaller.
    pub(in crate::error_bound) fn exchange_forces(
        &self,
        function: &PrimalDualPair,
        flux: &mut [f64],
    ) {
        let facets: Vec<(Place, usize)> = self.grouped_facets_of(BoundaryPart::Contact).collect();
        let mut numbers: Vec<usize> = facets.iter().map(|((cell, _), _)| *cell).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let mut cells = self.cells_with_products(&numbers, |_| [0.0; 4], function, flux);
        let in_contact = |&(place, group): &(Place, usize)| {
            let gap = self.data.gap.of(group)?;
            let admissible = self.admissible_in(function, place.0);
            let mut gaps = [0.0; 4];
            for (point, weight) in self.facet_rule.iter() {
                let x = self.facet_point(point, place.0, place.1);
                let point = facet_to_cell(point, place.1);
                let distance = (admissible.at(&point, &x).0 - gap.at(&x)).max(0.0);
                gaps.iter_mut().zip(&point).for_each(|(gap, b)| *gap += weight * distance * b);
            }
            let alpha = self.alpha(place.0).to_f64();
            let measure = self.facet_measure(place);
            let square = (measure * alpha * (D * (D + 1)) as f64).recip();
            Some(ContactFacet {
                at: (numbers.binary_search(&place.0).ok()?, place.1),
                gaps,
                variation: self.constant_of_trace(place) * square.sqrt(),
                has_one_sign: false,
            })
        };
        let mut facets: Vec<ContactFacet> = facets.iter().filter_map(in_contact).collect();
        facets.iter_mut().for_each(|facet| cells.make_force_positive(facet));
        for _ in 0..SWEEPS {
            for facet in facets.iter().filter(|facet| facet.has_one_sign) {
                for a in vertices_of::<D>(facet.at.1) {
                    for b in vertices_of::<D>(facet.at.1).filter(|&b| b > a) {
                        cells.exchange_force(facet, [a, b]);
                    }
                }
            }
        }
    }
}
