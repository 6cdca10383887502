//! Squares of errors, integrated over cells.

use std::ops::Range;

use super::admissible::InCells;
use super::cell_integrand::{CellIntegrand, LocalFunction};
use super::evaluation::Reference;
use super::kinks::Kinks;
use super::squared_errors::{SquaredErrors, Squares};
use crate::arrays::{array_of, map_entries};
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::tables::CellTable;
use crate::assemble::space::{Space, Terms, checks};
use crate::error::Error;
use crate::mesh::edge_vertices;
use crate::parallel::cells;
use crate::problem::Datum;
use crate::quadrature::{FullySymmetric, Quadrature, Rule};
use crate::real::{Point, maximum};

/// Degree of the rule for error norms: the exact solution is not polynomial, and the rule must not
/// limit what it measures. Cells that the exact free boundary or a jump of load, coefficient or reaction
/// cuts are divided. For basis functions of degree `b` the degree of the rule is at least `2 b + 2`, that
/// of the square of the largest term of the error.
const fn error_degree(dimension: usize) -> usize {
    match dimension {
        1 | 2 => 19,
        _ => 9,
    }
}

/// Degrees of two rules with fewer points for basis functions of some degree. Both are exact for the square of
/// the largest term of the error.
const fn lower_degrees(dimension: usize, basis_degree: usize) -> Option<[usize; 2]> {
    match (dimension, basis_degree) {
        (2 | 3, 1) => Some([5, 6]),
        (2, 2) => Some([7, 8]),
        _ => None,
    }
}

/// Two rules agree in a cell if their integrals differ by this share. Let `s` be the diameter divided by the length
/// over which derivatives of the solution change. The square of the error in L2 of functions of degree `b` has a
/// leading term of degree `2 b + 2`, so that rules of degrees `2 b + 3` and `2 b + 4` leave shares of the sizes `s^2`
/// and `s^3`, and smaller ones of the squares of gradients: where both agree, the rule of higher degree, which counts,
/// leaves about 1e-6.
const AGREEMENT: f64 = 1e-4;

/// Two rules agree in a cell if their integrals differ by this share of the mean over all cells.
const NEGLIGIBLE: f64 = 1e-8;

/// The largest ratio of two values at the corners of a cell of a coefficient that counts as smooth there. With a larger
/// one a coefficient without a level, and with it the exact gradient, may jump within the cell.
const SMOOTH_RATIO: f64 = 2.0;

/// An obstacle is linear along an edge if its value at the middle differs from the mean of its values at the ends by at
/// most this share.
const LINEAR: f64 = 1e-14;

/// Degree of the rule for means over facets.
const MEAN_DEGREE: usize = 5;

/// Whether a cell counts in a sum over cells.
pub(crate) type Counts<'c> = &'c (dyn Fn(usize) -> bool + Sync);

/// The data that the errors of all cells read.
struct Measure<'m, 'r, 'f, const D: usize> {
    exact: &'m Reference<'r, D>,
    /// The rule of highest degree.
    table: CellTable,
    /// Two rules that are tried before.
    lower: Option<[CellTable; 2]>,
    /// The rules on cells that kinks cut, the second one for cells in which admissible functions have no kinks.
    cut_rules: Option<[CutRule; 2]>,
    /// By region the functions whose zeros are kinks.
    kinks: Vec<Kinks<D>>,
    /// The functional of each node.
    nodes: Vec<Terms>,
    u: Option<&'m [f64]>,
    function: Option<InCells<'f, D>>,
}

impl<const D: usize> Space<'_, D> {
    /// Squares of the errors of a vector of unknowns and of a function in cells over the cells that count.
    pub(super) fn cell_errors(
        &self,
        exact: &Reference<'_, D>,
        u: Option<&[f64]>,
        function: Option<InCells<'_, D>>,
        counts: Counts<'_>,
    ) -> Result<SquaredErrors, Error> {
        let (degree, lower) = match exact {
            Reference::Exact(_) => (
                error_degree(D).max(2 * self.basis_degree + 2),
                lower_degrees(D, self.basis_degree),
            ),
            // exact: the integrand is the square of a difference of polynomials
            Reference::Coarse { space, .. } => {
                (2 * self.basis_degree.max(space.basis_degree), None)
            }
        };
        let lower = lower.map(|degrees| degrees.map(|degree| FullySymmetric.rule(D, degree)));
        let lower = match lower {
            Some([Ok(a), Ok(b)]) => Some([a, b].map(|rule| self.cell_table(rule))),
            _ => None,
        };
        let cell_rule = Rule::new(D, degree);
        let nodes = self.node_terms(&Rule::new(D - 1, MEAN_DEGREE), &cell_rule);
        let kinks: Vec<Kinks<D>> =
            (0..self.mesh.regions().len()).map(|region| self.kinks(exact, region)).collect();
        let has_kinks = kinks.iter().any(|kinks| !kinks.levels.is_empty());
        let cut_rules = has_kinks.then(|| {
            let rule = || CutRule::new(D, degree);
            [rule(), rule().without_needless_bisections()]
        });
        let table = self.cell_table(cell_rule);
        let measure = Measure { exact, table, lower, cut_rules, kinks, nodes, u, function };
        let n_cells = self.mesh.n_cells();
        // partial sums are added in order, so the result does not depend on threads
        let chunks = cells::map(n_cells, &|cells: Range<usize>| {
            let (mut sum, mut open) = (SquaredErrors::default(), Vec::new());
            for cell in cells.filter(|&cell| counts(cell)) {
                let [low, high] = self.squares_in(&measure, cell, true)?;
                match differ(&low, &high, &map_entries(high, |square| AGREEMENT * square)) {
                    true => open.push((cell, low, high)),
                    false => sum.add(&high),
                }
                sum.max = maximum(sum.max, self.largest_at_nodes(&measure, cell)?);
            }
            Ok::<_, Error>((sum, open))
        });
        let (mut total, mut open) = (SquaredErrors::default(), Vec::new());
        for chunk in chunks {
            let (sum, of_chunk) = chunk?;
            total.add(&sum.squares);
            total.max = maximum(total.max, sum.max);
            open.extend(of_chunk);
        }
        let mut estimate = total;
        open.iter().for_each(|(_, _, high)| estimate.add(high));
        let n_counted = (0..n_cells).filter(|&cell| counts(cell)).count();
        let negligible =
            map_entries(estimate.squares, |square| NEGLIGIBLE * square / n_counted as f64);
        let chunks = cells::map(open.len(), &|range: Range<usize>| {
            let mut sum = SquaredErrors::default();
            for (cell, low, high) in &open[range] {
                match differ(low, high, &negligible) {
                    true => sum.add(&self.squares_in(&measure, *cell, false)?[1]),
                    false => sum.add(high),
                }
            }
            Ok::<_, Error>(sum)
        });
        for chunk in chunks {
            total.add(&chunk?.squares);
        }
        Ok(total)
    }

    /// The data with which the error is integrated in a cell.
    fn integrand_in<'c, 'f: 'c>(
        &'c self,
        of: &'c Measure<'_, '_, 'f, D>,
        cell: usize,
    ) -> CellIntegrand<'c, D> {
        let geometry = self.mesh.geometry(cell);
        let gradients: [Point<D>; 4] = array_of(|k| match k <= D {
            true => *geometry.gradient(k),
            false => Point::zeros(),
        });
        let discrete = of.u.map(|u| {
            let (n, values) = (self.per_cell(), self.local_values(cell, u));
            let mut discrete = LocalFunction { n, values, slope: None };
            // the derivatives of linear functions are those at any point
            if self.basis_degree <= 1 {
                discrete.slope = Some(discrete.gradient(&of.table.basis[0], &gradients));
            }
            discrete
        });
        let region = self.mesh.region(cell);
        let coefficient = self.data.coefficient.of(region);
        CellIntegrand {
            exact: of.exact,
            cell,
            volume: geometry.volume,
            gradients,
            discrete,
            admissible: of.function.map(|f| f(cell)),
            alpha: self.alpha(cell),
            varying: coefficient.filter(|_| self.varying_in(cell).is_some()),
            coefficient,
            reaction: self.data.reaction.of(region),
        }
    }

    /// The squares of a cell by two rules; by the same one if it is the one of highest degree.
    fn squares_in(
        &self,
        of: &Measure<'_, '_, '_, D>,
        cell: usize,
        try_lower: bool,
    ) -> Result<[Squares; 2], Error> {
        let integrand = self.integrand_in(of, cell);
        let by_rule = |table: &CellTable| {
            let CellTable { points, basis, weights } = table;
            let in_space = |point: &[f64; 4]| self.cell_point(point, cell);
            let mut sums = Squares::default();
            for ((point, basis), &weight) in points.iter().zip(basis).zip(weights) {
                integrand.add(&mut sums, (point, &in_space(point)), weight, basis);
            }
            integrand.checked(sums, || points.iter().map(in_space).collect())
        };
        if !try_lower {
            return by_rule(&of.table).map(|squares| [squares; 2]);
        }
        let on_pieces = of.cut_rules.as_ref().and_then(|rules| {
            let level = of.kinks[self.mesh.region(cell)].level_in(&rules[0], self.mesh, cell)?;
            if !rules[0].cuts(self.mesh, cell, &level) {
                return None;
            }
            let corners = self.mesh.corners(cell);
            let is_linear = self.basis_degree == 1 && self.has_linear_obstacles(cell);
            let rule = &rules[usize::from(is_linear)];
            let mut sums = Squares::default();
            rule.visit(&corners, &level, &mut |point, weight| {
                let x = in_space(point, &corners);
                integrand.add(&mut sums, (point, &x), weight, &self.basis_at(point));
            });
            let points = || {
                let mut points = Vec::new();
                rule.visit(&corners, &level, &mut |point, _| {
                    points.push(in_space(point, &corners))
                });
                points
            };
            Some(integrand.checked(sums, points))
        });
        if let Some(squares) = on_pieces {
            return squares.map(|squares| [squares; 2]);
        }
        let corner = |k: usize| self.mesh.vertices()[self.mesh.cell(cell)[k] as usize];
        let touches_in_piece = || {
            let admissible = integrand.admissible.as_ref();
            admissible.is_some_and(|function| function.touches_in_piece(corner))
        };
        match &of.lower {
            Some([low, high])
                if !may_jump(integrand.coefficient, corner) && !touches_in_piece() =>
            {
                Ok([by_rule(low)?, by_rule(high)?])
            }
            _ => by_rule(&of.table).map(|squares| [squares; 2]),
        }
    }

    /// Whether obstacles are linear in a cell, as far as their values at corners and middles of edges tell. A linear
    /// obstacle exceeds no linear admissible function within a cell.
    fn has_linear_obstacles(&self, cell: usize) -> bool {
        let (region, corners) = (self.mesh.region(cell), self.mesh.corners(cell));
        let is_linear = |bound: &Datum<D>| {
            let at_corners = corners.map(|x| bound.at(&x));
            edge_vertices(D).iter().all(|&[a, b]| {
                let at_middle = bound.at(&((corners[a] + corners[b]) * 0.5));
                let deviation = (at_middle - 0.5 * (at_corners[a] + at_corners[b])).abs();
                deviation <= LINEAR * (at_corners[a].abs() + at_corners[b].abs())
            })
        };
        let bounds = [self.data.lower.of(region), self.data.upper.of(region)];
        bounds.into_iter().flatten().all(is_linear)
    }

    /// The largest error at the nodes of a cell.
    fn largest_at_nodes(&self, of: &Measure<'_, '_, '_, D>, cell: usize) -> Result<f64, Error> {
        let Some(u) = of.u else { return Ok(0.0) };
        let mut largest = 0.0_f64;
        for (i, (node, terms)) in self.nodes.iter().zip(&of.nodes).enumerate() {
            let at = |(point, weight): &([f64; 4], f64)| {
                weight * of.exact.value(cell, &self.cell_point(point, cell))
            };
            let value: f64 = terms.iter().map(at).sum();
            let value = match value.is_finite() {
                true => value,
                false => {
                    checks::finite(value, "exact solution", &self.node_point(cell, node), cell)?
                }
            };
            let error = (u[self.dofs.of(cell, i)] - value).abs();
            largest = maximum(largest, error);
        }
        Ok(largest)
    }
}

/// Whether a coefficient may jump within a cell with these corners, though no level says so.
fn may_jump<const D: usize>(
    coefficient: Option<&Datum<D>>,
    corner: impl Fn(usize) -> Point<D>,
) -> bool {
    let Some(alpha) = coefficient else { return false };
    if alpha.constant().is_some() || alpha.level().is_some() {
        return false;
    }
    let values = (0..=D).map(|k| alpha.at(&corner(k)));
    let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    most > SMOOTH_RATIO * least
}

/// Whether two lists of squares differ by more than is allowed.
fn differ(a: &Squares, b: &Squares, allowed: &Squares) -> bool {
    a.iter().zip(b).zip(allowed).any(|((a, b), allowed)| (a - b).abs() > *allowed)
}
