//! Squares of errors, integrated over cells.

mod data;
mod integrand;
mod roughness;

use std::ops::Range;

use data::may_jump;
use integrand::{CellIntegrand, LocalFunction};
use roughness::{Polynomials, Roughness};

use super::admissible::InCells;
use super::evaluation::Reference;
use super::kinks::Kinks;
use super::squared_errors::{SquaredErrors, Squares};
use crate::arrays::{array_of, map_entries};
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::tables::CellTable;
use crate::assemble::space::{Space, Terms, checks};
use crate::element::{Entity, Node};
use crate::error::Error;
use crate::parallel::cells;
use crate::parallel::vectors::collect;
use crate::quadrature::{FullySymmetric, OrthonormalPolynomials, Quadrature, Rule};
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

/// Degree of the rule in cells where the error is smooth, for basis functions of some degree `b`: `2 b + 3`, exact for
/// the square of the largest term of the error.
const fn smooth_degree(dimension: usize, basis_degree: usize) -> Option<usize> {
    match (dimension, basis_degree) {
        (2 | 3, 1) => Some(5),
        (2, 2) => Some(7),
        _ => None,
    }
}

/// The error counts as smooth in a cell if `1 - |P q|^2 / |q|^2` is at most this number: `q` is the flux of the error
/// in the L2 norm, `P` the projection to polynomials of the degree of the basis. Let `s` be the diameter divided by the
/// length over which derivatives of the solution change. The number is a fraction of `s^2`, and the rule leaves a small
/// part of it of the square of the error in L2, a small part of its square of that of the gradient.
const SMOOTH: f64 = 1e-3;

/// The rule of smooth cells also counts where what is not smooth of each square is less than this number times the mean
/// of that square over all cells.
const NEGLIGIBLE: f64 = 1e-8;

/// Degree of the rule for means over facets.
const MEAN_DEGREE: usize = 5;

/// Whether a cell counts in a sum over cells.
pub(crate) type Counts<'c> = &'c (dyn Fn(usize) -> bool + Sync);

/// The data that the errors of all cells read.
struct Measure<'m, 'r, 'f, const D: usize> {
    exact: &'m Reference<'r, D>,
    /// The rule of highest degree.
    table: CellTable,
    /// The rule in cells where the error is smooth.
    smooth: Option<SmoothRule>,
    /// The rules on cells that kinks cut, the second one for cells in which admissible functions have no kinks.
    cut_rules: Option<[CutRule; 2]>,
    /// By region the functions whose zeros are kinks.
    kinks: Vec<Kinks<D>>,
    /// The values at vertices of the first of these functions, where it is that of the contact set.
    contact_at_vertices: Option<Vec<f64>>,
    /// Whether the unknowns of a cell are the values of a linear function at the vertices.
    is_conforming_linear: bool,
    /// The functional of each node.
    nodes: Vec<Terms>,
    /// The exact solution at the vertices of the mesh, if all nodes are vertices.
    at_vertices: Option<Vec<f64>>,
    u: Option<&'m [f64]>,
    function: Option<InCells<'f, D>>,
}

/// The rule in cells where the error is smooth.
struct SmoothRule {
    table: CellTable,
    /// Number of polynomials.
    n: usize,
    /// The values of orthonormal polynomials of the degree of the basis, by point.
    polynomials: Vec<Polynomials>,
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
        let (degree, smooth) = match exact {
            Reference::Exact(_) => (
                error_degree(D).max(2 * self.basis_degree + 2),
                smooth_degree(D, self.basis_degree),
            ),
            // exact: the integrand is the square of a difference of polynomials
            Reference::Coarse { space, .. } => {
                (2 * self.basis_degree.max(space.basis_degree), None)
            }
        };
        let smooth = smooth.map(|degree| self.smooth_rule(degree)).transpose()?;
        let cell_rule = Rule::new(D, degree);
        let nodes = self.node_terms(&Rule::new(D - 1, MEAN_DEGREE));
        let kinks: Vec<Kinks<D>> =
            (0..self.mesh.regions().len()).map(|region| self.kinks(exact, region)).collect();
        let has_kinks = kinks.iter().any(|kinks| !kinks.levels.is_empty());
        let cut_rules = has_kinks.then(|| {
            let rule = || CutRule::new(D, degree);
            [rule(), rule().without_needless_bisections()]
        });
        let table = self.cell_table(cell_rule);
        let measure = Measure {
            exact,
            table,
            smooth,
            cut_rules,
            kinks,
            contact_at_vertices: self.contact_at_vertices(exact),
            is_conforming_linear: self.is_conforming_linear(),
            nodes,
            at_vertices: self.values_at_vertices(exact),
            u,
            function,
        };
        let n_cells = self.mesh.n_cells();
        // partial sums are added in order, so the result does not depend on threads
        let chunks = cells::map(n_cells, &|cells: Range<usize>| {
            let (mut sum, mut open) = (SquaredErrors::default(), Vec::new());
            for cell in cells.filter(|&cell| counts(cell)) {
                let integrand = self.integrand_in(&measure, cell);
                let (rough, squares) = self.squares_in(&measure, &integrand)?;
                match rough <= SMOOTH {
                    true => sum.add(&squares),
                    false => open.push((cell, map_entries(squares, |s| rough * s), squares)),
                }
                sum.max = maximum(sum.max, self.largest_at_nodes(&measure, &integrand)?);
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
        open.iter().for_each(|(_, _, squares)| estimate.add(squares));
        let n_counted = (0..n_cells).filter(|&cell| counts(cell)).count();
        let negligible =
            map_entries(estimate.squares, |square| NEGLIGIBLE * square / n_counted as f64);
        let chunks = cells::map(open.len(), &|range: Range<usize>| {
            let mut sum = SquaredErrors::default();
            for (cell, rough, squares) in &open[range] {
                match rough.iter().zip(&negligible).all(|(rough, limit)| rough <= limit) {
                    true => sum.add(squares),
                    false => {
                        let integrand = self.integrand_in(&measure, *cell);
                        sum.add(&self.squares_by(&measure, &integrand)?);
                    }
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
            // linear functions have one basis function for each vertex, with the same derivatives at all points
            let slope = || of.table.basis[0].gradient(&values[..D + 1], &gradients);
            LocalFunction { n, values, slope: (self.basis_degree <= 1).then(slope) }
        });
        let region = self.mesh.region(cell);
        let coefficient = self.data.coefficient.of(region);
        let mut admissible = of.function.map(|f| f(cell));
        let mut is_admissible = false;
        // elsewhere values at the obstacle alone tell where the exact solution may have a kink
        if of.contact_at_vertices.is_some()
            && let Some(function) = &mut admissible
            && function.is_linear(&self.mesh.corners(cell))
        {
            function.bounds = [None; 2];
            let has_same_values = |of: &LocalFunction<D>| of.values[..=D] == function.values[..=D];
            is_admissible = of.is_conforming_linear
                && coefficient.is_none_or(|alpha| alpha.constant().is_some())
                && discrete.as_ref().is_some_and(has_same_values);
        }
        CellIntegrand {
            exact: of.exact,
            cell,
            constant: self.body_constants.of_cell(cell),
            volume: geometry.volume,
            gradients,
            discrete,
            admissible: admissible.filter(|_| !is_admissible),
            is_admissible,
            alpha: self.alpha(cell),
            varying: coefficient.filter(|_| self.varying_in(cell).is_some()),
            coefficient,
            reaction: self.data.reaction.of(region),
        }
    }

    /// The rule of this degree with the polynomials of the degree of the basis.
    fn smooth_rule(&self, degree: usize) -> Result<SmoothRule, Error> {
        let table = self.cell_table(FullySymmetric.rule(D, degree)?);
        let polynomials = OrthonormalPolynomials::new(D, self.basis_degree);
        let n = polynomials.len();
        let at =
            |point: &[f64; 4]| array_of(|k| if k < n { polynomials.value(k, point) } else { 0.0 });
        let polynomials = table.points.iter().map(at).collect();
        Ok(SmoothRule { table, n, polynomials })
    }

    /// The values of an exact solution at the vertices of the mesh, if these are all nodes.
    fn values_at_vertices(&self, exact: &Reference<'_, D>) -> Option<Vec<f64>> {
        let Reference::Exact(exact) = exact else { return None };
        let is_vertex = |node: &Node| matches!(node.entity(), Entity::Vertex(_));
        let vertices = self.mesh.vertices();
        let is_known = self.nodes.iter().all(is_vertex);
        is_known.then(|| collect(vertices.len(), |v| exact.value.at(&vertices[v])))
    }

    /// The squares of a cell by the rule of highest degree.
    fn squares_by(
        &self,
        of: &Measure<'_, '_, '_, D>,
        integrand: &CellIntegrand<'_, D>,
    ) -> Result<Squares, Error> {
        let corners = self.mesh.corners(integrand.cell);
        let CellTable { points, basis, weights } = &of.table;
        let mut sums = Squares::default();
        for ((point, basis), &weight) in points.iter().zip(basis).zip(weights) {
            integrand.add(&mut sums, (point, &in_space(point, &corners)), weight, basis);
        }
        integrand.checked(sums, || points.iter().map(|p| in_space(p, &corners)).collect())
    }

    /// The squares of a cell, on pieces if kinks cut it, and by the rule for smooth errors elsewhere, with the share
    /// that is not smooth; zero if it is known that another rule does no better.
    fn squares_in(
        &self,
        of: &Measure<'_, '_, '_, D>,
        integrand: &CellIntegrand<'_, D>,
    ) -> Result<(f64, Squares), Error> {
        let corners = self.mesh.corners(integrand.cell);
        if let Some(squares) = self.squares_on_pieces(of, integrand, &corners) {
            return Ok((0.0, squares?));
        }
        if self.has_no_error(of, integrand) {
            return Ok((0.0, Squares::default()));
        }
        let touches_in_piece = || {
            let admissible = integrand.admissible.as_ref();
            admissible.is_some_and(|function| function.touches_in_piece(&corners))
        };
        let data = [integrand.coefficient, integrand.reaction];
        let Some(SmoothRule { table, n, polynomials }) = of
            .smooth
            .as_ref()
            .filter(|_| data.into_iter().all(|datum| !may_jump(datum, &corners)))
            .filter(|_| !touches_in_piece())
        else {
            return Ok((0.0, self.squares_by(of, integrand)?));
        };
        let n_fluxes = 1 + usize::from(integrand.admissible.is_some());
        let (mut sums, mut rough) = (Squares::default(), Roughness::new(*n, n_fluxes));
        let points = table.points.iter().zip(&table.basis).zip(&table.weights);
        for (((point, basis), &weight), polynomials) in points.zip(polynomials) {
            let x = in_space(point, &corners);
            let fluxes = integrand.add(&mut sums, (point, &x), weight, basis);
            rough.add(weight, &fluxes, polynomials);
        }
        let points = || table.points.iter().map(|p| in_space(p, &corners)).collect();
        Ok((rough.share(), integrand.checked(sums, points)?))
    }

    /// Whether discrete and exact solution are the same linear function in a cell that no kink cuts: in contact with a
    /// linear obstacle, and equal at the corners and at the barycentre, with the gradient there.
    fn has_no_error(&self, of: &Measure<'_, '_, '_, D>, integrand: &CellIntegrand<'_, D>) -> bool {
        let (Some(contact), Some(exact)) = (&of.contact_at_vertices, &of.at_vertices) else {
            return false;
        };
        let cell = integrand.cell;
        let is_equal = |discrete: &LocalFunction<D>| {
            let values = &discrete.values[..=D];
            let corners = self.mesh.cell(cell).iter().map(|&v| v as usize);
            corners
                .zip(values)
                .all(|(v, value)| contact[v] > 0.0 && exact[v] - integrand.constant == *value)
                && {
                    let (x, mean) =
                        (self.mesh.barycentre(cell), values.iter().sum::<f64>() / (D + 1) as f64);
                    of.exact.value(cell, &x, integrand.constant) == mean
                        && discrete.slope == Some(of.exact.gradient(cell, &x))
                }
        };
        let has_obstacle = [&self.data.lower, &self.data.upper]
            .iter()
            .any(|obstacle| obstacle.of(self.mesh.region(cell)).is_some());
        // obstacles are linear where the discrete function is known to be admissible
        has_obstacle && integrand.is_admissible && integrand.discrete.as_ref().is_some_and(is_equal)
    }

    /// The squares of a cell that kinks of the exact solution cut.
    fn squares_on_pieces(
        &self,
        of: &Measure<'_, '_, '_, D>,
        integrand: &CellIntegrand<'_, D>,
        corners: &[Point<D>; 4],
    ) -> Option<Result<Squares, Error>> {
        let (rules, cell) = (of.cut_rules.as_ref()?, integrand.cell);
        let kinks = &of.kinks[self.mesh.region(cell)];
        let of_first = of.contact_at_vertices.as_ref().map(|values| self.at_corners(values, cell));
        if kinks.are_far(&corners[..=D], of_first) {
            return None;
        }
        let level = kinks.level_in(&rules[0], self.mesh, cell)?;
        if !rules[0].cuts(self.mesh, cell, &level) {
            return None;
        }
        let is_linear = self.basis_degree == 1 && self.has_linear_obstacles(cell);
        let rule = &rules[usize::from(is_linear)];
        let mut sums = Squares::default();
        rule.visit(corners, &level, &mut |point, weight| {
            let x = in_space(point, corners);
            integrand.add(&mut sums, (point, &x), weight, &self.basis_at(point));
        });
        let points = || {
            let mut points = Vec::new();
            rule.visit(corners, &level, &mut |point, _| points.push(in_space(point, corners)));
            points
        };
        Some(integrand.checked(sums, points))
    }

    /// The largest error at the nodes of a cell.
    fn largest_at_nodes(
        &self,
        of: &Measure<'_, '_, '_, D>,
        integrand: &CellIntegrand<'_, D>,
    ) -> Result<f64, Error> {
        let (Some(discrete), cell) = (&integrand.discrete, integrand.cell) else { return Ok(0.0) };
        let mut largest = 0.0_f64;
        for (i, (node, terms)) in self.nodes.iter().zip(&of.nodes).enumerate() {
            let at = |(point, weight): &([f64; 4], f64)| {
                weight * of.exact.value(cell, &self.cell_point(point, cell), integrand.constant)
            };
            let value: f64 = match (&of.at_vertices, node.entity()) {
                (Some(values), Entity::Vertex(k)) => {
                    values[self.mesh.cell(cell)[k] as usize] - integrand.constant
                }
                _ => terms.iter().map(at).sum(),
            };
            let value = match value.is_finite() {
                true => value,
                false => {
                    checks::finite(value, "exact solution", &self.node_point(cell, node), cell)?
                }
            };
            let error = (discrete.values[i] - value).abs();
            largest = maximum(largest, error);
        }
        Ok(largest)
    }
}
