//! The distance by which a discrete function lies beyond obstacles and gaps, between its nodes too.

use std::ops::Range;

use super::cell_errors::Counts;
use crate::assemble::Discretisation;
use crate::assemble::cut_simplices::in_space;
use crate::assemble::space::Space;
use crate::assemble::space::checks::finite;
use crate::assemble::space::tables::BasisAt;
use crate::error::Error;
use crate::instances::compiled;
use crate::mesh::{BoundaryCondition, edge_vertices};
use crate::parallel::cells;
use crate::problem::Datum;
use crate::quadrature::facet_to_cell;
use crate::real::{Precision, maximum};

/// Beyond a bound by more than this share of the largest distance from it there is a warning.
const SHARE_OF_DISTANCE: f64 = 0.1;

/// A distance below this many units of rounding of the size of the function is rounding.
const ROUNDINGS: f64 = 1e3;

const NAMES: [&str; 3] = ["the lower obstacle", "the upper obstacle", "the gap"];

/// By the same numbers what errors call the data, and the sign with which the function lies above them.
const DATA: [&str; 3] = ["obstacle", "obstacle", "gap"];
const SIGNS: [f64; 3] = [1.0, -1.0, 1.0];

/// How far a function lies beyond lower obstacles, upper obstacles and gaps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Penetration {
    /// The largest value of `psi - u`, `u - Psi` and `g - u`.
    beyond: [f64; 3],
    /// The largest values of the opposite.
    away: [f64; 3],
    /// A distance below this is rounding.
    rounding: f64,
}

impl Penetration {
    /// Nothing seen yet.
    const NONE: Self =
        Self { beyond: [f64::NEG_INFINITY; 3], away: [f64::NEG_INFINITY; 3], rounding: 0.0 };

    /// How far the function lies beyond a bound at most: negative where it reaches none.
    pub fn largest(&self) -> f64 {
        // a distance of zero has no sign
        self.beyond.into_iter().fold(f64::NEG_INFINITY, maximum) + 0.0
    }

    /// The numbers of which over several parts of a mesh the largest count.
    pub(crate) fn numbers(&self) -> [f64; 7] {
        let ([a, b, c], [d, e, f]) = (self.beyond, self.away);
        [a, b, c, d, e, f, self.rounding]
    }

    /// The penetration with these numbers.
    pub(crate) fn with_numbers([a, b, c, d, e, f, rounding]: [f64; 7]) -> Self {
        Self { beyond: [a, b, c], away: [d, e, f], rounding }
    }

    /// A warning, if the function lies beyond a bound by more than a tenth of its largest distance from it.
    pub(crate) fn remark(&self) -> Option<String> {
        let found = (0..3).filter_map(|k| {
            let (beyond, away) = (self.beyond[k], self.away[k].max(0.0));
            let is_far = beyond > self.rounding && beyond > SHARE_OF_DISTANCE * away;
            is_far.then(|| format!(
                "the solution lies beyond {} by {beyond:.1e}, more than a tenth of its largest distance from it, {away:.1e}",
                NAMES[k]
            ))
        });
        let found: Vec<String> = found.collect();
        (!found.is_empty()).then(|| found.join("; "))
    }

    /// What a value adds at a point where datum `k` is given.
    fn add(&mut self, k: usize, value: f64, datum: f64) {
        let away = SIGNS[k] * (value - datum);
        self.beyond[k] = maximum(self.beyond[k], -away);
        self.away[k] = maximum(self.away[k], away);
    }

    /// Both together.
    fn merged(mut self, other: &Self) -> Self {
        for k in 0..3 {
            self.beyond[k] = maximum(self.beyond[k], other.beyond[k]);
            self.away[k] = maximum(self.away[k], other.away[k]);
        }
        self
    }
}

impl<const D: usize> Discretisation<'_, D> {
    /// How far a discrete function lies beyond obstacles and gaps: in each cell beyond the obstacles of its region, on
    /// each contact facet beyond the gap of its group. It is looked at at vertices, midpoints of edges and the points
    /// of the rule for loads, on facets of that for Neumann data. None without an inequality.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::Parameter`] unless there is one value for each unknown.
    pub fn penetration(&self, u: &[f64]) -> Result<Option<Penetration>, Error> {
        self.check_length(u)?;
        self.penetration_of((u, Precision::Double), &|_| true)
    }

    /// The penetration of values that were computed in a precision, in the cells that count, those of a part of a mesh,
    /// and on their facets.
    pub(crate) fn penetration_of(
        &self,
        values: (&[f64], Precision),
        counts: Counts<'_>,
    ) -> Result<Option<Penetration>, Error> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                (&[f64], Precision),
                Counts<'_>,
            ) -> Result<Option<Penetration>, Error>
                = |of, values, counts| {
                    let is_constrained = of.problem().is_constrained();
                    is_constrained.then(|| of.space.penetration(values, counts)).transpose()
                }
        )(self, values, counts)
    }
}

/// Points of a cell with the basis there.
type Points = Vec<([f64; 4], BasisAt)>;

impl<const D: usize> Space<'_, D> {
    fn penetration(
        &self,
        (u, precision): (&[f64], Precision),
        counts: Counts<'_>,
    ) -> Result<Penetration, Error> {
        let in_cell = self.points_on(None);
        let chunks = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut found = Penetration::NONE;
            for cell in cells.filter(|&cell| counts(cell)) {
                let region = self.mesh.region(cell);
                for (k, data) in [&self.data.lower, &self.data.upper].into_iter().enumerate() {
                    if let Some(datum) = data.of(region) {
                        self.add_distances((cell, &in_cell), u, (k, datum), &mut found)?;
                    }
                }
            }
            Ok::<Penetration, Error>(found)
        });
        let mut found = Penetration::NONE;
        for of_chunk in chunks {
            found = found.merged(&of_chunk?);
        }
        let on_facets: Vec<Points> = (0..D + 1).map(|local| self.points_on(Some(local))).collect();
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            if let Some(gap) = self.data.gap.of(group).filter(|_| counts(cell)) {
                self.add_distances((cell, &on_facets[local]), u, (2, gap), &mut found)?;
            }
        }
        // a solution that vanishes is as large as rounding of what its load would do
        let size = u.iter().map(|u| u.abs()).fold(self.size_of_load(), f64::max);
        Ok(Penetration {
            rounding: precision.epsilon() * ROUNDINGS * size
                + ROUNDINGS * self.body_constants.rounding(),
            ..found
        })
    }

    /// Adds the distances of a function from obstacle or gap `k` at points of a cell.
    fn add_distances(
        &self,
        (cell, points): (usize, &Points),
        u: &[f64],
        (k, datum): (usize, &Datum<D>),
        found: &mut Penetration,
    ) -> Result<(), Error> {
        let (values, corners) = (self.local_values(cell, u), self.mesh.corners(cell));
        for (point, basis) in points {
            let x = in_space(point, &corners);
            let bound = finite(self.at(datum, cell, &x), DATA[k], &x, cell)?;
            found.add(k, basis.value(&values), bound);
        }
        Ok(())
    }

    /// The points of a cell, or of a facet of it, at which a function is compared with obstacles or a gap.
    fn points_on(&self, facet: Option<usize>) -> Points {
        let is_on = |ends: &[usize; 2]| facet.is_none_or(|local| !ends.contains(&local));
        let vertices = (0..D + 1).map(|k| [k; 2]);
        let ends = vertices.chain(edge_vertices(D).iter().copied()).filter(is_on);
        let mut points: Vec<[f64; 4]> = ends.map(middle).collect();
        match facet {
            None => points.extend(&self.cell_rule.points),
            Some(k) => points.extend(self.facet_rule.iter().map(|(p, _)| facet_to_cell(p, k))),
        }
        points.into_iter().map(|point| (point, self.basis_at(&point))).collect()
    }
}

/// The middle of two vertices, or a vertex.
pub(super) fn middle([a, b]: [usize; 2]) -> [f64; 4] {
    let mut point = [0.0; 4];
    point[a] += 0.5;
    point[b] += 0.5;
    point
}
