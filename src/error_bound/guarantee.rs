//! The terms of a bound that are not proven.

use super::PrimalDualPair;
use super::admissible_function::PairNode;
use super::estimate::Unproven;
use crate::arrays::map_entries;
use crate::assemble::space::Space;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::problem::{DataByGroup, DataOnMesh, Datum, Robin};
use crate::real::Point;

/// Numbers that differ by less than this share are equal but for rounding.
const AGREEMENT: f64 = 1e-12;

/// Numbers of which each is the difference of a datum and the constant of a body are equal if they differ by less than
/// this many units of rounding of the constant.
const ROUNDINGS: f64 = 8.0;

/// The highest degree of data that the rules of a bound follow.
const HIGHEST_DEGREE: usize = 12;

impl<const D: usize> Space<'_, D> {
    /// The terms of the bound that are not proven, but for that of the solver. `has_reaction_bound` says whether the
    /// lower bound of the reaction is not negative. Facets count with their cells.
    pub(super) fn unproven_terms(
        &self,
        pair: &PrimalDualPair<D>,
        has_reaction_bound: bool,
        counts: Counts<'_>,
    ) -> Vec<Unproven> {
        let data = &self.data;
        let is_below = |data: &DataByGroup<D>, degree: usize| {
            self.degree_of(data).is_some_and(|d| d <= degree)
        };
        let integrands = [&data.source, &data.lower, &data.upper, &data.gap];
        let has_jumps = data.source.any(&|f| f.level().is_some());
        let is_inexact = self.has_inexact_facets()
            || has_jumps
            || !is_below(&data.coefficient, 0)
            || self.has_varying_tensor()
            || !(is_below(&data.reaction, 2) && has_reaction_bound)
            || integrands.iter().any(|data| self.degree_of(data).is_none());
        let obstacles = [&data.lower, &data.upper, &data.gap];
        // every cell is visited: only where the answer counts
        let is_above = |degree: usize| obstacles.iter().any(|d| !is_below(d, degree));
        let is_curved = is_above(pair.degree)
            && (pair.degree > 1 || is_above(2) || !self.has_convex_obstacles());
        // linear data and obstacles: Bernstein coefficients are means of values at vertices
        let is_linear = obstacles.iter().all(|d| is_below(d, 1)) && is_below(&data.dirichlet, 1);
        // every edge is visited: only where the answer counts
        let may_leave = !is_curved
            && pair.degree > 1
            && !is_linear
            && obstacles.iter().any(|d| d.is_given())
            && !self.exceeds_obstacles(pair);
        let has_data = D > 1 && self.mesh.has_condition(BoundaryCondition::Dirichlet);
        // one with jumps is no trace of a function with finite energy
        let is_discrete = data.dirichlet.any(&|datum| datum.is_discrete());
        let found = [
            (is_inexact, Unproven::Quadrature),
            (
                has_data
                    && !(!is_discrete
                        && is_below(&data.dirichlet, pair.degree)
                        && self.takes_dirichlet_data(pair, counts)),
                Unproven::Boundary,
            ),
            (is_curved || may_leave, Unproven::Obstacle),
            (self.mesh.has_shapes(), Unproven::Shape),
        ];
        found.into_iter().filter(|(is_found, _)| *is_found).map(|(_, term)| term).collect()
    }

    /// The degree of data that are polynomials in cells, the largest one; none where one is unknown or too high to be
    /// integrated.
    pub(super) fn degree_of(&self, data: &DataByGroup<D>) -> Option<usize> {
        let stated = self.problem.data_degree;
        self.largest_degree(data.all().map(|datum| datum.degree_on(self.mesh, stated)))
    }
    /// The degree of Neumann data on facets, likewise, and of those of Robin sides with the discrete function; that of the
    /// flux of an exact solution is unknown, and a Robin coefficient of degree three has no known least value.
    pub(super) fn neumann_degree(&self) -> Option<usize> {
        let DataOnMesh { neumann, robin, friction, .. } = &self.data;
        let has_data = |group| {
            neumann.of(group).is_some() || robin.of(group).is_some() || friction.of(group).is_some()
        };
        let mut facets = self.grouped_facets_of(BoundaryCondition::Neumann);
        let is_exact = self.problem.exact.is_some() && facets.any(|(_, group)| !has_data(group));
        let of_exact = is_exact.then_some(None);
        let stated = self.problem.data_degree;
        let degrees = self.data.neumann.all().map(|flux| flux.degree());
        let of_side = |side: &Robin<D>| {
            let [of_coefficient, of_value] =
                side.data().map(|datum| datum.degree_on(self.mesh, stated));
            let of_coefficient = of_coefficient.filter(|degree| *degree <= 2)?;
            // of the flux, and of squares of the function
            Some(of_coefficient + of_value?.max(2 * self.basis_degree))
        };
        let of_friction = friction.all().map(|g| g.degree_on(self.mesh, stated));
        let of_sides: Vec<_> = robin.all().map(of_side).chain(of_friction).collect();
        let degrees = degrees.chain(of_exact).map(|degree| degree.or(stated)).chain(of_sides);
        self.largest_degree(degrees)
    }
    fn largest_degree(&self, mut degrees: impl Iterator<Item = Option<usize>>) -> Option<usize> {
        degrees
            .try_fold(0, |largest, degree| Some(largest.max(degree?)))
            .filter(|degree| *degree <= HIGHEST_DEGREE)
    }

    /// Whether the integrals of Neumann data over facets need not be those of the flux. A facet of an interval is a
    /// point.
    fn has_inexact_facets(&self) -> bool {
        D > 1
            && self.mesh.has_condition(BoundaryCondition::Neumann)
            && (self.problem.has_neumann_data() || self.data.friction.is_given())
            && self.neumann_degree().is_none_or(|degree| {
                !self.facet_rule.moments(D - 1, degree).all(|moment| moment.is_exact())
            })
    }

    /// Whether the Bernstein coefficients of a quadratic on all edges exceed those of obstacles and gaps, but for
    /// rounding: data may leave an obstacle between nodes, and two obstacles may ask more than one value can do.
    fn exceeds_obstacles(&self, pair: &PrimalDualPair<D>) -> bool {
        let exceeds = |bound: Option<&Datum<D>>, sign, cell, (ends, node): PairNode| {
            let Some(bound) = bound else { return true };
            let ends = map_entries(ends, |k| self.mesh.cell(cell)[k] as usize);
            let [x, y] = map_entries(ends, |v| self.mesh.vertices()[v]);
            let coefficient = |middle: f64, [a, b]: [f64; 2]| {
                [4.0 * middle - a - b, 4.0 * middle.abs() + a.abs() + b.abs()]
            };
            let of_ends = map_entries(ends, |v| pair.function[v]);
            let at = |x: &Point<D>| self.at(bound, cell, x);
            let [own, size] = coefficient(pair.function[node], of_ends);
            let [of_bound, size_of_bound] = coefficient(at(&((x + y) * 0.5)), [at(&x), at(&y)]);
            let rounding = AGREEMENT * size.max(size_of_bound) + ROUNDINGS * bound.rounding();
            sign * (own - of_bound) >= -rounding
        };
        let exceeds_in = |cell: usize| {
            let region = self.mesh.region(cell);
            let (lower, upper) = (self.data.lower.of(region), self.data.upper.of(region));
            self.pair_nodes(pair, cell)
                .all(|at| exceeds(lower, 1.0, cell, at) && exceeds(upper, -1.0, cell, at))
        };
        let exceeds_on = |(facet, group): (HalfFacet, usize)| {
            let gap = self.data.gap.of(group);
            self.pair_nodes_on(pair, facet).all(|at| exceeds(gap, 1.0, facet.0, at))
        };
        (0..self.mesh.n_cells()).all(exceeds_in)
            && self.grouped_facets_of(BoundaryCondition::Contact).all(exceeds_on)
    }

    /// Whether the function of a pair has the data of all Dirichlet facets at its nodes on them: where data of
    /// two facets differ at a common node no function with a square-integrable gradient takes both.
    fn takes_dirichlet_data(&self, pair: &PrimalDualPair<D>, counts: Counts<'_>) -> bool {
        let mut facets = self.grouped_facets_of(BoundaryCondition::Dirichlet);
        facets.all(|(facet, group)| {
            let mut nodes = self.pair_nodes_on(pair, facet);
            !counts(facet.0)
                || nodes.all(|(ends, node)| {
                    let [x, y] = map_entries(ends, |k| self.mesh.cell(facet.0)[k] as usize);
                    let [x, y] = map_entries([x, y], |v| self.mesh.vertices()[v]);
                    let datum = self.dirichlet_at(group, facet.0, &((x + y) * 0.5));
                    let value = pair.function[node];
                    let rounding = ROUNDINGS * self.body_constants.rounding();
                    (datum - value).abs() <= AGREEMENT * datum.abs().max(value.abs()) + rounding
                })
        })
    }
}
