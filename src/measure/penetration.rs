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
use crate::problem::{DataByGroup, Datum};
use crate::quadrature::facet_to_cell;
use crate::real::{Point, Precision};

/// Beyond a bound by more than this share of the largest distance from it there is a warning.
const SHARE_OF_DISTANCE: f64 = 0.1;

/// With affine data there is one from this share of the largest value of the function on.
const SHARE_OF_VALUE: f64 = 1e-6;

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
    /// The largest value of the function.
    largest_value: f64,
    /// For each of the three whether its data, and all others of the problem, are known to be affine.
    is_affine: [bool; 3],
    /// A distance below this is rounding.
    rounding: f64,
}

impl Penetration {
    /// Nothing seen yet.
    const NONE: Self = Self {
        beyond: [f64::NEG_INFINITY; 3],
        away: [f64::NEG_INFINITY; 3],
        largest_value: 0.0,
        is_affine: [false; 3],
        rounding: 0.0,
    };

    /// How far the function lies beyond a bound at most: negative where it reaches none.
    pub fn largest(&self) -> f64 {
        // a distance of zero has no sign
        self.beyond.into_iter().fold(f64::NEG_INFINITY, f64::max) + 0.0
    }

    /// The numbers of which over several parts of a mesh the largest count.
    pub(crate) fn numbers(&self) -> [f64; 7] {
        let ([a, b, c], [d, e, f]) = (self.beyond, self.away);
        [a, b, c, d, e, f, self.largest_value]
    }

    /// The penetration with these numbers.
    pub(crate) fn with_numbers(self, [a, b, c, d, e, f, largest_value]: [f64; 7]) -> Self {
        Self { beyond: [a, b, c], away: [d, e, f], largest_value, ..self }
    }

    /// A warning, if the function lies beyond a bound by more than a tenth of its largest distance from it; or, with
    /// affine data, by more than a millionth of its largest value.
    pub(crate) fn remark(&self) -> Option<String> {
        let rounding = self.rounding;
        let of_value = (SHARE_OF_VALUE * self.largest_value).max(rounding);
        let found = (0..3).filter_map(|k| {
            let (beyond, away) = (self.beyond[k], self.away[k].max(0.0));
            let end = match beyond > rounding {
                true if beyond > SHARE_OF_DISTANCE * away => {
                    format!("more than a tenth of its largest distance from it, {away:.1e}")
                }
                true if self.is_affine[k] && beyond > of_value => {
                    format!("with affine data: its largest value is {:.1e}", self.largest_value)
                }
                _ => return None,
            };
            Some(format!("the solution lies beyond {} by {beyond:.1e}, {end}", NAMES[k]))
        });
        let found: Vec<String> = found.collect();
        (!found.is_empty()).then(|| found.join("; "))
    }

    /// What a value adds at a point where a datum is given, above which the function lies with the sign one.
    fn add(&mut self, k: usize, sign: f64, [value, datum]: [f64; 2]) {
        let away = sign * (value - datum);
        self.beyond[k] = self.beyond[k].max(-away);
        self.away[k] = self.away[k].max(away);
    }

    /// Both together.
    fn merged(mut self, other: &Self) -> Self {
        for k in 0..3 {
            self.beyond[k] = self.beyond[k].max(other.beyond[k]);
            self.away[k] = self.away[k].max(other.away[k]);
        }
        self
    }
}

impl<const D: usize> Discretisation<'_, D> {
    /// How far a discrete function lies beyond obstacles and gaps: in each cell beyond the obstacles of its region, on
    /// each contact facet beyond the gap of its group. It is looked at at vertices, midpoints of edges and the points
    /// of the rule for loads, on facets of that for Neumann data, and of quadratics at the point of each edge where the
    /// quadratic through their distances at ends and midpoint is least: exact on edges for data of degree two. At
    /// vertices alone where function and datum are affine: there it is exact. None without an inequality.
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
        let data = [&self.data.lower, &self.data.upper, &self.data.gap];
        let is_linear = self.basis_degree == 1;
        let at_vertices = data.map(|data| is_linear && self.is_affine(data));
        let in_cells = self.points_on(None, at_vertices[0] && at_vertices[1]);
        let of_chunk = |cells: Range<usize>| {
            let mut found = Penetration::NONE;
            for cell in cells.filter(|&cell| counts(cell)) {
                self.add_penetration(cell, u, &in_cells, &mut found)?;
            }
            Ok::<Penetration, Error>(found)
        };
        let at_vertices_of_mesh = |vertices: Range<usize>| {
            let mut found = Penetration::NONE;
            for v in vertices {
                self.add_penetration_at((0, &self.mesh.vertices()[v]), u[v], &mut found)?;
            }
            Ok(found)
        };
        // unknowns are the values at vertices; those of a part belong to cells that do not count, too
        let is_one_value = self.is_conforming_linear() && !self.data.obstacles_differ();
        let has_obstacle = self.problem.has_obstacle();
        let by_vertices = (has_obstacle && is_one_value && at_vertices[0] && at_vertices[1])
            .then(|| cells::map(self.mesh.vertices().len(), &at_vertices_of_mesh))
            // an error names its cell
            .filter(|chunks| chunks.iter().all(Result::is_ok));
        let chunks = match by_vertices {
            Some(chunks) => chunks,
            None if has_obstacle => cells::map(self.mesh.n_cells(), &of_chunk),
            None => Vec::new(),
        };
        let mut found = Penetration::NONE;
        for of_chunk in chunks {
            found = found.merged(&of_chunk?);
        }
        let on_facets: Vec<Points> =
            (0..D + 1).map(|local| self.points_on(Some(local), at_vertices[2])).collect();
        for (facet, group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let gap = self.data.gap.of(group).filter(|_| counts(facet.0));
            if let Some(gap) = gap {
                self.add_distances((facet.0, &on_facets[facet.1]), u, (2, gap), &mut found)?;
            }
        }
        let is_affine = self.has_affine_data();
        let largest_value = u.iter().map(|u| u.abs()).fold(0.0, f64::max);
        // a solution that vanishes is as large as rounding of what its load would do
        let size = largest_value.max(self.size_of_load());
        Ok(Penetration {
            largest_value,
            is_affine: data.map(|data| is_affine && self.is_affine(data)),
            rounding: precision.epsilon() * ROUNDINGS * size
                + ROUNDINGS * self.body_constants.rounding(),
            ..found
        })
    }

    /// Adds the distances in a cell.
    fn add_penetration(
        &self,
        cell: usize,
        u: &[f64],
        points: &Points,
        found: &mut Penetration,
    ) -> Result<(), Error> {
        let region = self.mesh.region(cell);
        for (k, data) in [&self.data.lower, &self.data.upper].into_iter().enumerate() {
            if let Some(datum) = data.of(region) {
                self.add_distances((cell, points), u, (k, datum), found)?;
            }
        }
        Ok(())
    }

    /// Adds the distances of a function from obstacle or gap `k` at points of a cell and, of quadratics, where their
    /// difference from the datum, as that of a quadratic, is least within an edge of which the points have ends and
    /// midpoint.
    fn add_distances(
        &self,
        (cell, points): (usize, &Points),
        u: &[f64],
        (k, datum): (usize, &Datum<D>),
        found: &mut Penetration,
    ) -> Result<(), Error> {
        let (values, corners) = (self.local_values(cell, u), self.mesh.corners(cell));
        let bound_at = |point: &[f64; 4]| {
            let x = in_space(point, &corners);
            finite(self.at(datum, cell, &x), DATA[k], &x, cell)
        };
        let mut at_vertices = [[0.0; 2]; 4];
        for (point, basis) in points {
            let here = [basis.value(&values), bound_at(point)?];
            found.add(k, SIGNS[k], here);
            if let Some(vertex) = point.iter().position(|&b| b == 1.0) {
                at_vertices[vertex] = here;
            } else if self.basis_degree == 2
                && let Some([a, b]) = ends_of_middle(point)
            {
                let nodes = [at_vertices[a], here, at_vertices[b]];
                let Some(share) = least_within(nodes.map(|[u, psi]| SIGNS[k] * (u - psi))) else {
                    continue;
                };
                let mut point = [0.0; 4];
                (point[a], point[b]) = (1.0 - share, share);
                let value = quadratic(nodes.map(|[u, _]| u), share);
                found.add(k, SIGNS[k], [value, bound_at(&point)?]);
            }
        }
        Ok(())
    }

    /// Adds the distances of a value at a vertex of the mesh, without regions.
    fn add_penetration_at(
        &self,
        (cell, x): (usize, &Point<D>),
        value: f64,
        found: &mut Penetration,
    ) -> Result<(), Error> {
        let region = self.mesh.region(cell);
        let bounds = [self.data.lower.of(region), self.data.upper.of(region)];
        for (k, bound) in bounds.into_iter().enumerate() {
            if let Some(bound) = bound {
                let bound = finite(self.at(bound, cell, x), DATA[k], x, cell)?;
                found.add(k, SIGNS[k], [value, bound]);
            }
        }
        Ok(())
    }

    /// The points of a cell, or of a facet of it, at which a function is compared with obstacles or a gap.
    fn points_on(&self, facet: Option<usize>, are_vertices_enough: bool) -> Points {
        let is_on = |ends: &[usize; 2]| facet.is_none_or(|local| !ends.contains(&local));
        let ends = (0..D + 1).map(|k| [k; 2]).filter(is_on);
        let mut points: Vec<[f64; 4]> = ends.map(middle).collect();
        if !are_vertices_enough {
            points.extend(edge_vertices(D).iter().copied().filter(is_on).map(middle));
            match facet {
                None => points.extend(&self.cell_rule.points),
                Some(k) => points.extend(self.facet_rule.iter().map(|(p, _)| facet_to_cell(p, k))),
            }
        }
        points.into_iter().map(|point| (point, self.basis_at(&point))).collect()
    }

    /// Whether a degree of a flux, or the one stated for all data without a degree of their own, is at most one.
    fn is_affine_degree(&self, degree: Option<usize>) -> bool {
        degree.or(self.problem.data_degree).is_some_and(|degree| degree <= 1)
    }

    /// Whether a datum is known to be affine wherever it is given.
    fn is_affine(&self, data: &DataByGroup<D>) -> bool {
        let stated = self.problem.data_degree;
        data.every(&|datum| datum.degree_on(self.mesh, stated).is_some_and(|degree| degree <= 1))
    }

    /// Whether all data but obstacles and gaps are known to be affine.
    fn has_affine_data(&self) -> bool {
        let data = &self.data;
        let has = |condition| self.mesh.has_condition(condition);
        // without Neumann data an exact solution gives the flux
        let is_known = data.neumann.is_given() || self.problem.exact.is_none();
        let flux_is_affine = data.neumann.every(&|flux| self.is_affine_degree(flux.degree()))
            && (is_known || self.is_affine_degree(None));
        [&data.coefficient, &data.source, &data.reaction].into_iter().all(|d| self.is_affine(d))
            && (!has(BoundaryCondition::Dirichlet) || self.is_affine(&data.dirichlet))
            && (!has(BoundaryCondition::Neumann) || flux_is_affine)
    }
}

/// The middle of two vertices, or a vertex.
pub(super) fn middle([a, b]: [usize; 2]) -> [f64; 4] {
    let mut point = [0.0; 4];
    point[a] += 0.5;
    point[b] += 0.5;
    point
}

/// The vertices of which a point is the middle.
fn ends_of_middle(point: &[f64; 4]) -> Option<[usize; 2]> {
    let mut ends = (0..4).filter(|&k| point[k] == 0.5);
    ends.next().zip(ends.next()).map(<[usize; 2]>::from)
}

/// The share of an interval after which the quadratic with these values at ends and middle is least, if within.
fn least_within([a, middle, b]: [f64; 3]) -> Option<f64> {
    let curvature = a - 2.0 * middle + b;
    let share = (3.0 * a - 4.0 * middle + b) / (4.0 * curvature);
    (curvature > 0.0 && share > 0.0 && share < 1.0).then_some(share)
}

/// The quadratic with these values at ends and middle after a share of the interval.
fn quadratic([a, middle, b]: [f64; 3], t: f64) -> f64 {
    a * (1.0 - t) * (1.0 - 2.0 * t) + 4.0 * middle * t * (1.0 - t) + b * t * (2.0 * t - 1.0)
}
