//! What of a bound is proven.

use super::PrimalDualPair;
use super::estimate::Unproven;
use super::function::PairNode;
use crate::arrays::map_entries;
use crate::assemble::space::{Place, Space};
use crate::measure::Counts;
use crate::mesh::BoundaryPart;
use crate::problem::{DataByGroup, DatumRef};
use crate::real::{Real, point_f64};

/// Numbers that differ by less than this share are equal but for rounding.
const AGREEMENT: f64 = 1e-12;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The terms that are not proven; the arguments say whether the term of the solver is, and whether the bound from
    /// below for the reaction is positive or zero. Facets count with their cells.
    pub(super) fn unproven_terms(
        &self,
        pair: &PrimalDualPair,
        [is_algebra_proven, has_reaction_bound]: [bool; 2],
        counts: Counts<'_>,
    ) -> Vec<Unproven> {
        let (data, stated) = (&self.data, self.problem.data_degree);
        let is_below = |data: &DataByGroup<'_, D>, degree: usize| {
            is_constant(data) || stated.is_some_and(|stated| stated <= degree)
        };
        let integrands = [&data.source, &data.lower, &data.upper, &data.gap];
        let has_jumps = data.source.any(&|f| f.level().is_some());
        let is_inexact = self.has_inexact_facets(pair)
            || has_jumps
            || !is_below(&data.coefficient, 0)
            || !(is_below(&data.reaction, 2) && has_reaction_bound)
            || integrands.iter().any(|data| !is_below(data, usize::MAX));
        let obstacles = [&data.lower, &data.upper, &data.gap];
        let is_curved = obstacles.iter().any(|d| !is_below(d, pair.degree));
        // linear data and obstacles: Bernstein coefficients are means of values at vertices
        let is_linear = obstacles.iter().all(|d| is_below(d, 1)) && is_below(&data.dirichlet, 1);
        // every edge is visited: only where the answer counts
        let may_leave = !is_curved
            && pair.degree > 1
            && !is_linear
            && obstacles.iter().any(|d| d.is_given())
            && !self.exceeds_obstacles(pair);
        let has_data = D > 1 && self.mesh.has_part(BoundaryPart::Dirichlet);
        let found = [
            (is_inexact, Unproven::Quadrature),
            (
                has_data
                    && !(is_below(&data.dirichlet, pair.degree)
                        && self.takes_dirichlet_data(pair, counts)),
                Unproven::Boundary,
            ),
            (is_curved || may_leave, Unproven::Obstacle),
            (!is_algebra_proven, Unproven::Algebra),
        ];
        found.into_iter().filter(|(is_found, _)| *is_found).map(|(_, term)| term).collect()
    }

    /// Whether integrals of Neumann data or contact over facets need not be exact. A facet of an interval is a point.
    fn has_inexact_facets(&self, pair: &PrimalDualPair) -> bool {
        let (neumann, gap) = (&self.data.neumann, &self.data.gap);
        let stated = self.problem.data_degree;
        let has = |part| D > 1 && self.mesh.has_part(part);
        let [has_neumann, has_contact] =
            map_entries([BoundaryPart::Neumann, BoundaryPart::Contact], has);
        let has_neumann = has_neumann && self.problem.has_neumann_data();
        let is_constant = neumann.every(&|f| f.constant().is_some());
        if has_neumann && stated.is_none() && !(is_constant && self.problem.exact.is_none()) {
            return true;
        }
        // the square of a datum less the flux; the flux times the distance of the function from the gap
        let stated = stated.unwrap_or(0);
        let of_neumann = 2 * stated.max(pair.degree - 1);
        let of_contact = pair.degree - 1 + stated.max(pair.degree);
        let degrees = [(has_neumann, of_neumann), (has_contact && gap.is_given(), of_contact)];
        let degree = degrees.iter().filter(|(has, _)| *has).map(|(_, degree)| *degree).max();
        degree.is_some_and(|d| !self.facet_rule.moments(D - 1, d).all(|m| m.is_exact()))
    }

    /// Whether the Bernstein coefficients of a quadratic on all edges exceed those of obstacles and gaps, but for
    /// rounding: data may leave an obstacle between nodes, and two obstacles may ask more than one value can do.
    fn exceeds_obstacles(&self, pair: &PrimalDualPair) -> bool {
        let exceeds = |bound: Option<DatumRef<'_, D>>, sign, cell, (ends, node): PairNode| {
            let Some(bound) = bound else { return true };
            let ends = map_entries(ends, |k| self.mesh.cell(cell)[k] as usize);
            let [x, y] = map_entries(ends, |v| point_f64(&self.mesh.vertices()[v]));
            let coefficient = |middle: f64, [a, b]: [f64; 2]| {
                [4.0 * middle - a - b, 4.0 * middle.abs() + a.abs() + b.abs()]
            };
            let of_ends = map_entries(ends, |v| pair.function[v]);
            let [own, size] = coefficient(pair.function[node], of_ends);
            let [of_bound, size_of_bound] =
                coefficient(bound.at(&((x + y) * 0.5)), [bound.at(&x), bound.at(&y)]);
            sign * (own - of_bound) >= -AGREEMENT * size.max(size_of_bound)
        };
        let exceeds_in = |cell: usize| {
            let region = self.mesh.region(cell);
            let (lower, upper) = (self.data.lower.of(region), self.data.upper.of(region));
            self.pair_nodes(pair, cell)
                .all(|at| exceeds(lower, 1.0, cell, at) && exceeds(upper, -1.0, cell, at))
        };
        let exceeds_on = |(place, group): (Place, usize)| {
            let gap = self.data.gap.of(group);
            self.pair_nodes_on(pair, place).all(|at| exceeds(gap, 1.0, place.0, at))
        };
        (0..self.mesh.n_cells()).all(exceeds_in)
            && self.grouped_facets_of(BoundaryPart::Contact).all(exceeds_on)
    }

    /// Whether the function of a pair has the data of all Dirichlet facets at its nodes on them: where data of
    /// two facets differ at a common node no function with a square-integrable gradient takes both.
    fn takes_dirichlet_data(&self, pair: &PrimalDualPair, counts: Counts<'_>) -> bool {
        let mut facets = self.grouped_facets_of(BoundaryPart::Dirichlet);
        facets.all(|(place, group)| {
            let mut nodes = self.pair_nodes_on(pair, place);
            !counts(place.0)
                || nodes.all(|(ends, node)| {
                    let [x, y] = map_entries(ends, |k| self.mesh.cell(place.0)[k] as usize);
                    let [x, y] = map_entries([x, y], |v| point_f64(&self.mesh.vertices()[v]));
                    let datum = self.dirichlet_at(group, &((x + y) * 0.5));
                    let value = pair.function[node];
                    (datum - value).abs() <= AGREEMENT * datum.abs().max(value.abs())
                })
        })
    }
}

/// Whether a datum is a number wherever it is given.
fn is_constant<const D: usize>(data: &DataByGroup<'_, D>) -> bool {
    data.every(&|f| f.constant().is_some())
}
