//! Integrals of a pair over cells and the boundary: what each cell adds to the bound.
//!
//! With `w` the discrete function, `m = alpha^-1/2 (alpha grad v - q)`, `z = c^1/2 (w - v)` in the cell beside
//! `k^1/2 (w - v)` on Robin sides, `r = f - c w + div q` less what a multiplier takes, `t` what `q.n` lacks on Neumann
//! and contact facets, and least values `alpha_K`, `c_K` in the cell,
//!
//! ```text
//! mismatch           |m|_K^2 + |z|_K^2
//! with oscillation   (|m|_K + R_K + T_K)^2 + |z|_K^2
//! from midpoint      (|alpha^-1/2 ((alpha grad v + q) / 2 - alpha grad w)|_K + (R_K + T_K) / 2)^2 + |z|_K^2 / 4
//! obstacle           2 (|mu|, distance of v from the obstacle)_K
//! contact            2 int s (v - g) over the contact facets of the cell
//!
//! R_K = h_K / pi alpha_K^-1/2 |r|_K
//! T_K = sum_F (|F| / |K| (1/pi^2 + 2/(pi D)))^1/2 h_K alpha_K^-1/2 |t|_F
//! ```
//!
//! with the tensor `T = L L^T` of the coefficient, `L^T` times gradients, `L^-1` times fluxes and the diameter in the
//! coordinates `L^-1 x`; and `c_K^-1/2 |r|_K` beside `|z|_K` in place of `R_K` where that is smaller, on a Robin side
//! `|k^-1/2 t|_F` in place of the term of `T_K`. The multiplier `mu` is the mean of what the flux leaves, where an obstacle presses in its direction, with the share of the linear rest that keeps its sign
//! ([`share_of_one_sign`]); elsewhere the mean is what the solver left ([`Totals::of_solver`]).

mod boundary;
mod cell_flux;
mod totals;

use std::f64::consts::PI;
use std::slice::from_ref;

use boundary::BoundaryTerms;
use cell_flux::CellFlux;
pub(super) use totals::Totals;

use super::PrimalDualPair;
use super::flux::share_of_one_sign;
use crate::arrays::{array_of, map_entries};
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::Space;
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::element::MAX_BASIS;
use crate::measure::Admissible;
use crate::mesh::edge_vertices;
use crate::problem::{Datum, Field};
use crate::quadrature::vertex_point;
use crate::real::Point;

/// Where forces on facets took the multiplier, what remains up to this share of the fluxes through facets is an error of the
/// solver: without it the bound of ridge-2d is 1e-7, with a tenth of it 2e-6 at 64, where all else is zero.
const ROUNDING: f64 = 1e-8;

/// The data that the integrals of a cell read.
struct CellInputs<'a, const D: usize> {
    flux: CellFlux<D>,
    admissible: Admissible<'a, D>,
    /// The values of the discrete function at the unknowns of the cell.
    values: [f64; MAX_BASIS],
    /// The gradient of the discrete function, where it is linear.
    slope: Option<Point<D>>,
    coefficient: Option<&'a Datum<D>>,
    reaction: Option<&'a Datum<D>>,
    source: Option<&'a Datum<D>>,
    volume: f64,
}

/// Integrals over one cell.
#[derive(Default)]
struct CellIntegrals {
    /// The square of the difference of gradient and flux.
    mismatch: f64,
    /// The square of the difference of the two functions, times the reaction.
    from_values: f64,
    /// The square of the difference of the gradients of the two functions, times the coefficient.
    distance: f64,
    /// The square of the difference of the mean of gradient and flux and the gradient of the discrete function.
    from_midpoint: f64,
    /// The load at the first point, less the reaction. The balance is summed from it, so that a constant has no
    /// oscillation.
    first_load: Option<f64>,
    /// The means of the load, less that at the first point, times barycentric coordinates.
    means: [f64; 4],
    /// The square of the load, less that at the first point.
    square: f64,
    /// The distances from the lower and the upper obstacle, times barycentric coordinates.
    gaps: [[f64; 4]; 2],
    least_coefficient: f64,
    /// The least value of the reaction at points.
    least_reaction: f64,
    /// A bound from below for a reaction of degree two.
    reaction_from_below: f64,
}

/// An integral of squares: corrections of rules along curved zeros have weights of both signs, so that the sum of
/// values at rounding may be negative.
fn integral_of_square(sum: f64) -> f64 {
    if sum < 0.0 { 0.0 } else { sum }
}

/// The square of two norms, by their squares, to which a share of two others is added.
fn with_share(squares: [f64; 2], share: f64, others: [f64; 2]) -> f64 {
    squares.iter().zip(others).map(|(square, other)| (square.sqrt() + share * other).powi(2)).sum()
}

impl<const D: usize> Space<'_, D> {
    /// The admissible function in a cell.
    #[inline(always)]
    pub(super) fn admissible_in(&self, pair: &PrimalDualPair<D>, cell: usize) -> Admissible<'_, D> {
        let (geometry, region) = (self.mesh.geometry(cell), self.mesh.region(cell));
        let (mut values, mut gradients) = ([0.0; 4], [Point::zeros(); 4]);
        let mut gradient = Point::zeros();
        for (k, &v) in self.mesh.cell(cell).iter().enumerate() {
            values[k] = pair.function[v as usize];
            gradients[k] = *geometry.gradient(k);
            gradient += gradients[k] * (values[k] - values[0]);
        }
        let bounds = [self.data.lower.of(region), self.data.upper.of(region)];
        let excess = (pair.degree > 1).then(|| {
            let midpoints = &pair.function[self.mesh.vertices().len()..];
            let ends = edge_vertices(D);
            let edges = &pair.edges[cell * ends.len()..];
            let mut excess = [0.0; 6];
            for ((excess, &[a, b]), &edge) in excess.iter_mut().zip(ends).zip(edges) {
                *excess = 4.0 * midpoints[edge as usize] - 2.0 * (values[a] + values[b]);
            }
            excess
        });
        let place = (self.mesh, cell);
        Admissible { place, values, gradient, excess, gradients, bounds }
    }

    /// The gradients of the function of a pair at the vertices of a cell, without obstacles.
    pub(super) fn gradients_at_vertices(
        &self,
        pair: &PrimalDualPair<D>,
        cell: usize,
    ) -> [Point<D>; 4] {
        let function = Admissible { bounds: [None, None], ..self.admissible_in(pair, cell) };
        match pair.degree {
            1 => [function.gradient; 4],
            _ => array_of(|k| match k <= D {
                true => function.at(&vertex_point(k), &Point::zeros()).1,
                false => Point::zeros(),
            }),
        }
    }

    /// Calls a function with the points of a rule on a cell, divided where a level has zeros: with barycentric
    /// coordinates, coordinates in space, weight and the basis.
    fn visit_points(
        &self,
        cell: usize,
        table: &CellTable,
        cut: Option<(&CutRule, &Field<D>)>,
        mut visit: impl FnMut(&[f64; 4], &Point<D>, f64, &BasisAt),
    ) {
        let is_cut = cut.is_some_and(|(rule, level)| {
            rule.visit_if_cut(self.mesh, cell, from_ref(level), &mut |point, x, weight| {
                visit(point, x, weight, &self.basis_at(point));
            })
        });
        if !is_cut {
            for ((point, basis), &weight) in
                table.points.iter().zip(&table.basis).zip(&table.weights)
            {
                visit(point, &self.cell_point(point, cell), weight, basis);
            }
        }
    }

    /// The means of the distances of a linear function from the obstacles, by the corners or at the points of a rule;
    /// none if it leaves one of them at a point.
    fn gaps_of_linear(
        &self,
        function: &Admissible<'_, D>,
        (cell, corners): (usize, &[Point<D>; 4]),
        table: &CellTable,
    ) -> Option<[f64; 2]> {
        let mut gaps = [0.0; 2];
        if function.bounds.iter().all(Option::is_none) {
            return Some(gaps);
        }
        if function.is_linear(corners) {
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let gap = |bound: &Datum<D>| {
                    let at_corners = corners[..=D].iter().zip(&function.values);
                    let distance = |(x, value): (&Point<D>, &f64)| value - self.at(bound, cell, x);
                    at_corners.map(|corner| sign * distance(corner)).sum::<f64>()
                };
                gaps[k] = function.bounds[k].map_or(0.0, gap) / (D + 1) as f64;
            }
            return Some(gaps);
        }
        for (point, weight) in table.points.iter().zip(&table.weights) {
            let x = in_space(point, corners);
            let value: f64 = function.values.iter().zip(point).map(|(v, b)| v * b).sum();
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let gap = function.bounds[k]
                    .map_or(0.0, |bound| sign * (value - self.at(bound, cell, &x)));
                if gap < 0.0 {
                    return None;
                }
                gaps[k] += weight * gap;
            }
        }
        Some(gaps)
    }

    /// The integrals of a cell where everything but the obstacles is a polynomial: coefficient and load constant, no
    /// reaction, functions linear. None elsewhere, and where the function leaves an obstacle.
    fn integrals_of_constants(
        &self,
        cell: usize,
        data: &CellInputs<'_, D>,
        table: &CellTable,
    ) -> Option<CellIntegrals> {
        let constant_of =
            |datum: Option<&Datum<D>>, absent| datum.map_or(Some(absent), |d| d.constant());
        let alpha = constant_of(data.coefficient, 1.0)?;
        let load = constant_of(data.source, 0.0)?;
        let slope = data.slope.filter(|_| data.reaction.is_none() && !self.has_tensor())?;
        let corners = self.mesh.corners(cell);
        let distances = self.gaps_of_linear(&data.admissible, (cell, &corners), table)?;
        let gradient = data.admissible.gradient;
        let constants = [gradient * alpha, (slope * 2.0 - gradient) * alpha];
        let [mismatch, from_midpoint] = data.flux.mean_squares_of_differences(constants, &corners);
        let [lower, upper] = distances.map(|mean| data.volume * mean);
        Some(CellIntegrals {
            mismatch: data.volume / alpha * mismatch,
            from_midpoint: 0.25 * data.volume / alpha * from_midpoint,
            distance: data.volume * alpha * (gradient - slope).norm_squared(),
            first_load: Some(load),
            gaps: [[lower, 0.0, 0.0, 0.0], [upper, 0.0, 0.0, 0.0]],
            least_coefficient: alpha,
            ..CellIntegrals::default()
        })
    }

    /// The integrals of a cell by a rule.
    fn integrals_at_points(
        &self,
        cell: usize,
        data: &CellInputs<'_, D>,
        table: &CellTable,
        cut: Option<&CutRule>,
    ) -> CellIntegrals {
        let [least_reaction, reaction_from_below] =
            data.reaction.map_or([0.0; 2], |c| self.least_values(cell, c));
        let mut sums = CellIntegrals {
            least_coefficient: f64::INFINITY,
            least_reaction,
            reaction_from_below,
            ..CellIntegrals::default()
        };
        let admissible = &data.admissible;
        let cut = cut.zip(data.source.and_then(|f| f.level()));
        self.visit_points(cell, table, cut, |point, x, weight, basis| {
            let weight = weight * data.volume;
            let alpha = data.coefficient.map_or(1.0, |alpha| self.at(alpha, cell, x));
            let reaction = data.reaction.map_or(0.0, |c| self.at(c, cell, x));
            let (value, gradient) = admissible.at(point, x);
            let q = data.flux.at(point, x);
            let tensor = self.tensor_at(cell, x);
            let of_gradient = |g: Point<D>| tensor.as_ref().map_or(g, |tensor| tensor.gradient(&g));
            let q = tensor.as_ref().map_or(q, |tensor| tensor.vector(&q));
            let gradient = of_gradient(gradient);
            sums.mismatch += weight * (gradient * alpha - q).norm_squared() / alpha;
            let discrete = basis.value(&data.values);
            sums.from_values += weight * reaction * (discrete - value).powi(2);
            let slope =
                data.slope.unwrap_or_else(|| basis.gradient(&data.values, &admissible.gradients));
            let slope = of_gradient(slope);
            sums.distance += weight * alpha * (gradient - slope).norm_squared();
            let from_midpoint = (gradient * alpha + q) * 0.5 - slope * alpha;
            sums.from_midpoint += weight * from_midpoint.norm_squared() / alpha;
            let load = data.source.map_or(0.0, |f| self.at(f, cell, x)) - reaction * discrete;
            let load = load - *sums.first_load.get_or_insert(load);
            sums.square += weight * load * load;
            let differences = map_entries([0, 1], |k| {
                let sign = [1.0, -1.0][k];
                admissible.bounds[k]
                    .map_or(0.0, |bound| weight * sign * (value - self.at(bound, cell, x)))
            });
            for (k, share) in data.flux.shares(point).iter().enumerate() {
                sums.means[k] += weight * load / data.volume * share;
                sums.gaps[0][k] += differences[0] * share;
                sums.gaps[1][k] += differences[1] * share;
            }
            sums.least_coefficient = sums.least_coefficient.min(alpha);
            sums.least_reaction = sums.least_reaction.min(reaction);
        });
        sums
    }

    /// The terms of a cell.
    pub(super) fn cell_terms(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
        cell: usize,
        (table, cut): (&CellTable, Option<&CutRule>),
        boundary: &BoundaryTerms,
    ) -> Totals {
        let data = self.cell_inputs(pair, u, cell, table);
        let sums = self
            .integrals_of_constants(cell, &data, table)
            .unwrap_or_else(|| self.integrals_at_points(cell, &data, table, cut));
        let from_values = sums.from_values + self.distance_on_sides(cell, &data);
        let [mismatch, from_values, from_midpoint] =
            map_entries([sums.mismatch, from_values, sums.from_midpoint], integral_of_square);
        let by_gradient = self.isotropic_diameter(cell) / (PI * sums.least_coefficient.sqrt());
        let by_value = sums.reaction_from_below.max(0.0).sqrt().recip();
        let load = sums.first_load.unwrap_or(0.0);
        let left = data.flux.left_of_load(data.volume, &sums.means, sums.square, load);
        let side = usize::from(left.mean < 0.0);
        // without an obstacle in its direction the mean is what the solver left; and where forces on facets took the
        // multiplier, its rounding
        let fluxes = || (0..=D).map(|facet| pair.flux.through(cell, facet).abs()).sum::<f64>();
        let is_rounding =
            boundary.has_rounding && left.mean.abs() * data.volume <= ROUNDING * fluxes();
        let has_obstacle = data.admissible.bounds[side].is_some() && !is_rounding;
        let share = match has_obstacle {
            true => share_of_one_sign(left.mean, &left.values[..data.flux.n]),
            false => 0.0,
        };
        let mut obstacle = 0.0;
        if has_obstacle {
            for (value, gap) in left.values.iter().zip(sums.gaps[side]).take(data.flux.n) {
                let multiplier = left.mean + share * (value - left.mean);
                obstacle += 2.0 * multiplier.abs() * gap;
            }
        }
        obstacle += boundary.obstacle.get(cell).map_or(0.0, |on_facets| 2.0 * on_facets);
        let integral = if has_obstacle { 0.0 } else { left.mean * data.volume };
        let of_trace = boundary.traces.get(cell).map_or(0.0, |n| n / sums.least_coefficient.sqrt());
        let of_load = (left.rest + (1.0 - share).powi(2) * left.variation).sqrt();
        let of_sides = boundary.robin.get(cell).map_or(0.0, |square| square.sqrt());
        let oscillation = match by_value < by_gradient {
            true => [of_trace, by_value * of_load + of_sides],
            false => [by_gradient * of_load + of_trace, of_sides],
        };
        Totals {
            mismatch: mismatch + from_values,
            with_oscillation: with_share([mismatch, from_values], 1.0, oscillation),
            from_midpoint: with_share([from_midpoint, 0.25 * from_values], 0.5, oscillation),
            obstacle,
            contact: boundary.contact.get(cell).map_or(0.0, |c| 2.0 * c),
            unbalanced: integral * integral / data.volume,
            distance: integral_of_square(sums.distance) + from_values,
            least_coefficient: sums.least_coefficient * self.least_of_tensor(cell),
            least_reaction: sums.least_reaction,
            reaction_from_below: sums.reaction_from_below.min(sums.least_reaction),
        }
    }

    /// The square of the difference of the two functions, times the coefficients of Robin sides.
    fn distance_on_sides(&self, cell: usize, data: &CellInputs<'_, D>) -> f64 {
        let mut sum = 0.0;
        if let Some(reaction) = self.reaction.as_ref().filter(|_| self.data.robin.is_given()) {
            reaction.visit_sides(self.mesh, cell, &mut |point, x, weight| {
                let discrete = self.basis_at(point).value(&data.values);
                sum += weight * (discrete - data.admissible.at(point, x).0).powi(2);
            });
        }
        sum
    }

    /// The least value of a datum at vertices and midpoints of edges and, for a datum of degree two, its least
    /// Bernstein coefficient, which is a bound from below.
    fn least_values(&self, cell: usize, datum: &Datum<D>) -> [f64; 2] {
        if let Some(constant) = datum.constant() {
            return [constant; 2];
        }
        let corners = self.mesh.corners(cell);
        let at = |x: &Point<D>| self.at(datum, cell, x);
        let mut at_corners = [f64::INFINITY; 4];
        (0..D + 1).for_each(|k| at_corners[k] = at(&corners[k]));
        let least = at_corners.into_iter().fold(f64::INFINITY, f64::min);
        let edges = edge_vertices(D).iter().map(|&[a, b]| {
            let middle = at(&((corners[a] + corners[b]) * 0.5));
            [middle, 2.0 * middle - 0.5 * (at_corners[a] + at_corners[b])]
        });
        edges.fold([least; 2], |[least, from_below], [middle, coefficient]| {
            [least.min(middle), from_below.min(coefficient)]
        })
    }

    /// The data that the integrals of a cell read.
    #[inline(always)]
    fn cell_inputs(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
        cell: usize,
        table: &CellTable,
    ) -> CellInputs<'_, D> {
        let volume = self.mesh.geometry(cell).volume;
        let region = self.mesh.region(cell);
        let [coefficient, reaction, source] =
            map_entries([&self.data.coefficient, &self.data.reaction, &self.data.source], |data| {
                data.of(region)
            });
        let (admissible, values) = (self.admissible_in(pair, cell), self.local_values(cell, u));
        // linear functions have one basis function for each vertex, with the same derivatives at all points
        let slope = || table.basis[0].gradient(&values[..D + 1], &admissible.gradients);
        let slope = (pair.degree == 1).then(slope);
        let flux = self.flux_in(pair, cell, volume);
        CellInputs { flux, admissible, values, slope, coefficient, reaction, source, volume }
    }
}
