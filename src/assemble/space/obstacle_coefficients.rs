//! The Bernstein coefficients of obstacles and gaps, where these jump too.
//!
//! On an edge from `a` to `b` with midpoint `m` the coefficient is `2 psi(m) - (psi(a) + psi(b)) / 2`. Beside a jump of a
//! lower obstacle it may lie half the jump above all of its values. There it is the largest of the three, and at a node
//! on a jump a cell takes the value from its own side; upper obstacles are mirrored. Data without jumps keep their
//! coefficients.

use super::coefficient::INWARD;
use super::{Space, Terms, checks};
use crate::error::Error;
use crate::mesh::BoundaryCondition;
use crate::parallel::cells;
use crate::problem::Datum;

/// A datum that binds unknowns of a cell: obstacles, or the gap on a facet.
#[derive(Clone, Copy)]
pub(crate) enum Binding {
    Lower,
    Upper,
    /// On the facet with this number in the cell.
    Gap(usize),
}

impl Binding {
    /// The name of the datum in messages.
    pub fn name(self) -> &'static str {
        if let Self::Gap(_) = self { "gap" } else { "obstacle" }
    }
    /// Minus one for data that bind from above.
    fn sign(self) -> f64 {
        if let Self::Upper = self { -1.0 } else { 1.0 }
    }
    /// The barycentre of the cell or of the facet on which the datum is given.
    fn barycentre(self, dimension: usize) -> [f64; 4] {
        let counts = |k: usize| match self {
            Self::Gap(local) => k <= dimension && k != local,
            _ => k <= dimension,
        };
        let n = (0..4).filter(|&k| counts(k)).count();
        std::array::from_fn(|k| if counts(k) { 1.0 / n as f64 } else { 0.0 })
    }
}

/// A difference stays, of a function that jumps, if it is at least this share of those over longer ways.
const SHARE: f64 = 1.0 / 16.0;

/// How often an edge is halved: a difference of a function without jumps is then far below that share.
const HALVINGS: usize = 12;

/// A difference below this share of the values is rounding.
const ROUNDING: f64 = 1e-12;

/// And below this many units of rounding of the constant that was taken from the data.
const ROUNDINGS: f64 = 8.0;

/// A datum in a cell, with the names for messages.
struct OnCell<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    cell: usize,
    datum: &'s Datum<D>,
    binding: Binding,
}

impl<const D: usize> OnCell<'_, '_, D> {
    fn at(&self, point: &[f64; 4]) -> Result<f64, Error> {
        let x = self.space.cell_point(point, self.cell);
        let value = self.space.at(self.datum, self.cell, &x);
        checks::finite(value, self.binding.name(), &x, self.cell)
    }
    /// The value at a point and, on a jump, that from the side of the cell.
    fn one_sided(&self, point: &[f64; 4]) -> Result<[f64; 2], Error> {
        let value = self.at(point)?;
        let barycentre = self.binding.barycentre(D);
        let on_way = |share: f64| between(point, &barycentre, share);
        let near = self.at(&on_way(INWARD))?;
        let difference = (near - value).abs();
        let size = near.abs().max(value.abs());
        if difference <= ROUNDING * size + ROUNDINGS * self.datum.rounding() {
            return Ok([value; 2]);
        }
        let farther = |share| Ok::<f64, Error>((self.at(&on_way(share))? - value).abs());
        let jumps = difference >= SHARE * farther(INWARD.sqrt())?.max(farther(1.0)?);
        Ok([value, if jumps { near } else { value }])
    }
    /// Whether the datum jumps between the ends of an edge, with these values at ends and midpoint.
    fn jumps_between(
        &self,
        [mut a, mut b]: [[f64; 4]; 2],
        [mut of_a, mut of_b, mut of_middle]: [f64; 3],
    ) -> Result<bool, Error> {
        let span = of_a.max(of_b).max(of_middle) - of_a.min(of_b).min(of_middle);
        for k in 0..HALVINGS {
            let middle = between(&a, &b, 0.5);
            if k > 0 {
                of_middle = self.at(&middle)?;
            }
            match (of_middle - of_a).abs() > (of_b - of_middle).abs() {
                true => (b, of_b) = (middle, of_middle),
                false => (a, of_a) = (middle, of_middle),
            }
        }
        Ok((of_b - of_a).abs() >= SHARE * span)
    }
}

/// The point on the way between two points.
fn between(a: &[f64; 4], b: &[f64; 4], share: f64) -> [f64; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

impl<const D: usize> Space<'_, D> {
    /// The Bernstein coefficient of a datum in a cell, of a node with these terms, and whether a jump moved it.
    pub(super) fn obstacle_coefficient(
        &self,
        terms: &Terms,
        cell: usize,
        (binding, datum): (Binding, &Datum<D>),
    ) -> Result<(f64, bool), Error> {
        if let Some(constant) = datum.constant() {
            return Ok((terms.iter().map(|(_, weight)| weight * constant).sum(), false));
        }
        let of = OnCell { space: self, cell, datum, binding };
        let larger = |a: f64, b: f64| if (a - b) * binding.sign() < 0.0 { b } else { a };
        let [(a, _), (b, _), (middle, _)] = terms[..] else {
            // of a vertex the value itself counts too
            let [value, near] = of.one_sided(&terms[0].0)?;
            let bound = larger(value, near);
            return Ok((bound, bound != value));
        };
        let [at_a, at_b, at_middle] =
            [of.one_sided(&a)?, of.one_sided(&b)?, of.one_sided(&middle)?];
        let coefficient = |k: usize| -> f64 {
            let values = [at_a[k], at_b[k], at_middle[k]];
            terms.iter().zip(values).map(|((_, weight), value)| weight * value).sum()
        };
        let values = [at_a[1], at_b[1], at_middle[1]];
        let [plain, from_side] = [coefficient(0), coefficient(1)];
        let largest = larger(larger(values[0], values[1]), values[2]);
        let is_beyond = larger(from_side, largest) != largest;
        if is_beyond && of.jumps_between([a, b], values)? {
            return Ok((largest, true));
        }
        Ok((from_side, from_side != plain))
    }

    /// The number of Bernstein coefficients on edges that a jump of an obstacle or a gap moved.
    pub(crate) fn coefficients_on_jumps(&self) -> Result<usize, Error> {
        if !self.problem.is_constrained() || !self.has_coefficients() {
            return Ok(0);
        }
        let terms = self.node_terms(&self.facet_rule);
        let is_moved = |i: usize, cell, (binding, datum): (Binding, Option<&Datum<D>>)| {
            datum.map_or(Ok(false), |datum| {
                self.obstacle_coefficient(&terms[i], cell, (binding, datum)).map(|(_, moved)| moved)
            })
        };
        let chunks = cells::map(self.mesh.n_cells(), &|cells| {
            let mut moved = Vec::new();
            for cell in cells {
                let region = self.mesh.region(cell);
                let data = [
                    (Binding::Lower, self.data.lower.of(region)),
                    (Binding::Upper, self.data.upper.of(region)),
                ];
                for i in D + 1..self.per_cell() {
                    if is_moved(i, cell, data[0])? || is_moved(i, cell, data[1])? {
                        moved.push(self.dofs.of(cell, i));
                    }
                }
            }
            Ok(moved)
        });
        let mut moved = chunks.into_iter().collect::<Result<Vec<_>, Error>>()?.concat();
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            for i in self.nodes_on(local).filter(|&i| i > D) {
                if is_moved(i, cell, (Binding::Gap(local), self.data.gap.of(group)))? {
                    moved.push(self.dofs.of(cell, i));
                }
            }
        }
        Ok(number_of_different(moved))
    }
}

/// How many different numbers there are; not generic, so that the sorting code is compiled once.
fn number_of_different(mut numbers: Vec<usize>) -> usize {
    numbers.sort_unstable();
    numbers.dedup();
    numbers.len()
}
