//! Integrals of a pair over cells and the boundary.

use std::f64::consts::PI;

use super::{NoBound, PrimalDualPair};
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::assemble::space::{Place, Space};
use crate::measure::Admissible;
use crate::mesh::{BoundaryPart, edge_vertices};
use crate::problem::{DatumRef, Field};
use crate::quadrature::facet_to_cell;
use crate::real::{Point, Real, point_f64};

/// A negative contact force below this share of the largest one is rounding.
const FORCE_ROUNDING: f64 = 1e-8;

/// Integrals over one cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellTerms {
    /// The square of the mismatch.
    pub mismatch: f64,
    /// The square of the mismatch with the oscillation added: if what the flux leaves is a force of an
    /// obstacle, and if the solver left it.
    pub with_oscillation: [f64; 2],
    /// Twice the complementarity of obstacles, if what the flux leaves is a force.
    pub obstacle: f64,
    /// The complementarity divided by the square that the cell adds if the solver left the mean: infinite where
    /// no obstacle presses in the direction of the mean, zero where no constant of Friedrichs' inequality is known.
    pub ratio: f64,
    /// Twice the complementarity of contact.
    pub contact: f64,
    /// The mean of what the flux leaves.
    pub unbalanced: f64,
    /// The square of the distance of the two functions.
    pub distance: f64,
    /// The least value of the coefficient.
    pub least_coefficient: f64,
    /// The least value of the reaction.
    pub least_reaction: f64,
    /// The volume of the cell.
    pub volume: f64,
}

/// The flux in a cell: `q = sum_j lambda_j (s_j x - o_j) / (D |K|)` with one term, without `lambda_j`, where
/// the density is constant on facets.
struct CellFlux<const D: usize> {
    /// Number of terms: one, or that of the vertices.
    n: usize,
    /// `sum_F c_Fj`.
    sums: [f64; 4],
    /// `sum_F c_Fj a_F`.
    origins: [Point<f64, D>; 4],
    /// `1 / (D |K|)`.
    per_volume: f64,
    /// `D |K| div q`: at the vertices; constant for one term.
    divergence: [f64; 4],
}

impl<const D: usize> CellFlux<D> {
    /// The factors of the terms at a point.
    fn shares<'p>(&self, point: &'p [f64; 4]) -> &'p [f64] {
        if self.n == 1 { &[1.0] } else { &point[..=D] }
    }
    /// The value at a point, by barycentric coordinates and in space.
    fn at(&self, point: &[f64; 4], x: &Point<f64, D>) -> Point<f64, D> {
        if self.n == 1 {
            return (x * self.sums[0] - self.origins[0]) * self.per_volume;
        }
        let mut q = Point::zeros();
        for (k, share) in point.iter().enumerate().take(self.n) {
            q += (x * self.sums[k] - self.origins[k]) * *share;
        }
        q * self.per_volume
    }
    /// The mean of the square of the norm of a constant less the flux with one term, by the corners of the cell.
    fn mean_square_of_difference(
        &self,
        gradient: Point<f64, D>,
        corners: impl Iterator<Item = Point<f64, D>> + Clone,
    ) -> f64 {
        let d = D as f64;
        let middle = corners.clone().sum::<Point<f64, D>>() / (d + 1.0);
        let squares: f64 = corners.map(|x| (x - middle).norm_squared()).sum();
        let slope = self.sums[0] * self.per_volume;
        let at_middle = (middle * self.sums[0] - self.origins[0]) * self.per_volume;
        let of_slope = slope * slope * squares / ((d + 1.0) * (d + 2.0));
        (gradient - at_middle).norm_squared() + of_slope
    }
    /// What the flux leaves of a load, by the means of the load less a constant times each factor of a
    /// term, and the square of its norm.
    fn balance(&self, volume: f64, means: &[f64; 4], square: f64, constant: f64) -> Balance {
        if self.n == 1 {
            let mean = -self.sums[0] / volume - means[0] - constant;
            let rest = (square - volume * means[0] * means[0]).max(0.0);
            return Balance { mean, values: [mean; 4], variation: 0.0, rest };
        }
        let d = D as f64;
        let sum: f64 = means.iter().sum();
        let projection = means.map(|m| (d + 1.0) * ((d + 2.0) * m - sum));
        let products: f64 = projection.iter().zip(means).take(self.n).map(|(p, m)| p * m).sum();
        let mut values = [0.0; 4];
        for k in 0..self.n {
            values[k] = -self.divergence[k] * self.per_volume - projection[k] - constant;
        }
        let mean = values.iter().sum::<f64>() / (d + 1.0);
        let squares: f64 = values[..self.n].iter().map(|v| (v - mean).powi(2)).sum();
        let variation = volume * squares / ((d + 1.0) * (d + 2.0));
        Balance { mean, values, variation, rest: (square - volume * products).max(0.0) }
    }
}

/// What the flux of a cell leaves of the load.
struct Balance {
    /// Its mean.
    mean: f64,
    /// Its projection on the linear functions, at the vertices; the mean where the flux has one term.
    values: [f64; 4],
    /// The square of the norm of the projection less the mean.
    variation: f64,
    /// The square of the norm of the rest.
    rest: f64,
}

/// The measure of a facet times `q.n` on it.
#[derive(Clone, Copy)]
struct FacetFlux {
    /// A factor.
    scale: f64,
    /// The values at the vertices of the cell over the factor, zero at that opposite the facet; one if it is
    /// constant.
    values: Option<[f64; 4]>,
    /// The number of the facet.
    local: usize,
}

impl FacetFlux {
    /// The value, over the factor, at a point of the facet by its barycentric coordinates in the cell.
    fn at(&self, point: &[f64; 4]) -> f64 {
        self.values.map_or(1.0, |values| values.iter().zip(point).map(|(v, b)| v * b).sum())
    }
    /// The integral over the facet.
    fn integral(&self, dimension: usize) -> f64 {
        self.scale * self.values.map_or(1.0, |values| values.iter().sum::<f64>() / dimension as f64)
    }
    /// A flux that is nowhere negative with the same integral, and the mean of the square of the
    /// difference.
    fn limited(self, dimension: usize) -> (Self, f64) {
        // a negative integral is rounding: other pairs give no bound
        let Some(mut values) = self.values else {
            return (Self { scale: self.scale.max(0.0), ..self }, 0.0);
        };
        let d = dimension as f64;
        let mean = (values.iter().sum::<f64>() / d).max(0.0);
        let vertices = || (0..=dimension).filter(|&k| k != self.local);
        // the value at the vertex opposite the facet does not count
        values[self.local] = mean;
        let share = limit(mean, &values[..=dimension]);
        let squares: f64 = values[..=dimension].iter().map(|v| (v - mean).powi(2)).sum();
        vertices().for_each(|k| values[k] = mean + share * (values[k] - mean));
        values[self.local] = 0.0;
        let left = (1.0 - share).powi(2) * squares / (d * (d + 1.0));
        (Self { values: Some(values), ..self }, left)
    }
}

/// How far a linear function with these values at vertices can be taken from its mean, at most all the way,
/// with the sign of the mean everywhere.
pub(super) fn limit(mean: f64, values: &[f64]) -> f64 {
    let deepest = values.iter().map(|v| mean.signum() * (mean - v)).fold(0.0, f64::max);
    if deepest > mean.abs() { mean.abs() / deepest } else { 1.0 }
}

/// An integral of squares: corrections of rules along curved zeros have weights of both signs, so that the sum of
/// values at rounding may be negative.
fn integral_of_square(sum: f64) -> f64 {
    if sum < 0.0 { 0.0 } else { sum }
}

/// Integrals over the boundary, by cell; empty where there are none.
pub(super) struct BoundaryTerms {
    /// Norms of what Neumann data and contact forces have besides those of the pair, with the constant of the
    /// trace inequality.
    traces: Vec<f64>,
    /// The complementarity of contact.
    contact: Vec<f64>,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The admissible function in a cell.
    pub(super) fn admissible_in(&self, pair: &PrimalDualPair, cell: usize) -> Admissible<'_, D> {
        let (geometry, region) = (self.mesh.geometry(cell), self.mesh.region(cell));
        let (mut values, mut gradients) = ([0.0; 4], [Point::zeros(); 4]);
        let mut gradient = Point::zeros();
        for (k, &v) in self.mesh.cell(cell).iter().enumerate() {
            values[k] = pair.function[v as usize];
            gradients[k] = point_f64(geometry.gradient(k));
            gradient += gradients[k] * (values[k] - values[0]);
        }
        let diameter = self.mesh.cell_diameter(cell).to_f64();
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
        Admissible { values, gradient, excess, gradients, bounds, diameter }
    }

    /// The flux of a pair in a cell.
    fn flux_in(&self, pair: &PrimalDualPair, cell: usize, volume: f64) -> CellFlux<D> {
        let n = if pair.degree > 1 { D + 1 } else { 1 };
        let flux = &pair.flux[cell * (D + 1) * n..(cell + 1) * (D + 1) * n];
        let per_volume = 1.0 / (D as f64 * volume);
        let (mut sums, mut origins) = ([0.0; 4], [Point::<f64, D>::zeros(); 4]);
        for (&v, flux) in self.mesh.cell(cell).iter().zip(flux.chunks_exact(n)) {
            let opposite = point_f64(&self.mesh.vertices()[v as usize]);
            for (k, flux) in flux.iter().enumerate() {
                sums[k] += flux;
                origins[k] += opposite * *flux;
            }
        }
        let inner: f64 = (0..=D).map(|k| flux[k * (D + 2) % flux.len()]).sum();
        let divergence = match n {
            1 => [D as f64 * sums[0]; 4],
            _ => sums.map(|sum| (D + 1) as f64 * sum - inner),
        };
        CellFlux { n, sums, origins, per_volume, divergence }
    }

    /// Calls a function with the points of a rule on a cell, divided where a level has zeros: with barycentric
    /// coordinates, coordinates in space, weight and the basis.
    fn visit_points(
        &self,
        cell: usize,
        table: &CellTable<f64>,
        cut: Option<(&CutRule, &Field<D>)>,
        mut visit: impl FnMut(&[f64; 4], &Point<f64, D>, f64, &BasisAt<f64>),
    ) {
        let is_cut = cut.is_some_and(|(rule, level)| {
            rule.visit_if_cut(self.mesh, cell, level, &mut |point, x, weight| {
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

    /// The means of the distances of a linear function from the obstacles at the points of a rule; none if it
    /// leaves one of them at a point.
    fn gaps_of_linear(
        &self,
        function: &Admissible<'_, D>,
        cell: usize,
        table: &CellTable<f64>,
    ) -> Option<[f64; 2]> {
        let mut gaps = [0.0; 2];
        if function.bounds.iter().all(Option::is_none) {
            return Some(gaps);
        }
        let corners = self.mesh.corners(cell);
        for (point, weight) in table.points.iter().zip(&table.weights) {
            let x = in_space(point, &corners);
            let value: f64 = function.values.iter().zip(point).map(|(v, b)| v * b).sum();
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                let gap = function.bounds[k].map_or(0.0, |bound| sign * (value - bound.at(&x)));
                if gap < 0.0 {
                    return None;
                }
                gaps[k] += weight * gap;
            }
        }
        Some(gaps)
    }

    /// The terms of a cell.
    pub(super) fn cell_terms(
        &self,
        pair: &PrimalDualPair,
        u: &[T],
        cell: usize,
        (table, cut): (&CellTable<f64>, Option<&CutRule>),
        boundary: &BoundaryTerms,
        friedrichs: Option<f64>,
    ) -> CellTerms {
        let geometry = self.mesh.geometry(cell);
        let (volume, region) = (geometry.volume.to_f64(), self.mesh.region(cell));
        let flux = self.flux_in(pair, cell, volume);
        let local = self.local_values(cell, u);
        let [coefficient, reaction, source] =
            [&self.data.coefficient, &self.data.reaction, &self.data.source]
                .map(|data| data.of(region));
        let admissible = self.admissible_in(pair, cell);
        let gradient_of = |basis: &BasisAt<f64>| {
            let mut gradient = Point::<f64, D>::zeros();
            for k in 0..=D {
                let derivatives = basis.derivatives.iter();
                let slope: f64 = local.iter().zip(derivatives).map(|(c, d)| c * d[k]).sum();
                gradient += admissible.gradients[k] * slope;
            }
            gradient
        };
        // the derivatives of linear functions are those at any point
        let constant = (pair.degree == 1).then(|| gradient_of(&table.basis[0]));
        let mut terms = CellTerms {
            least_coefficient: f64::INFINITY,
            least_reaction: f64::INFINITY,
            volume,
            ..CellTerms::default()
        };
        let (mut mismatch, mut from_values) = (0.0, 0.0);
        // the balance is summed from its value at the first point, so that a constant has no oscillation
        let (mut first, mut means, mut square) = (None, [0.0; 4], 0.0);
        let mut gaps = [[0.0; 4]; 2];
        let constant_of =
            |datum: Option<DatumRef<'_, D>>, absent| datum.map_or(Some(absent), |d| d.constant());
        let constants = constant_of(coefficient, 1.0)
            .zip(constant_of(source, 0.0))
            .filter(|_| pair.degree == 1 && reaction.is_none())
            .and_then(|data| Some((data, self.gaps_of_linear(&admissible, cell, table)?)));
        if let Some(((alpha, load), distances)) = constants {
            // everything but the obstacles is a polynomial
            let corners =
                self.mesh.cell(cell).iter().map(|&v| point_f64(&self.mesh.vertices()[v as usize]));
            let square = flux.mean_square_of_difference(admissible.gradient * alpha, corners);
            mismatch = volume / alpha * square;
            let slope = constant.unwrap_or_else(Point::zeros);
            terms.distance = volume * alpha * (admissible.gradient - slope).norm_squared();
            first = Some(load);
            [gaps[0][0], gaps[1][0]] = distances.map(|mean| volume * mean);
            (terms.least_coefficient, terms.least_reaction) = (alpha, 0.0);
        } else {
            self.visit_points(
                cell,
                table,
                cut.zip(source.and_then(|f| f.level())),
                |point, x, weight, basis| {
                    let weight = weight * volume;
                    let alpha = coefficient.map_or(1.0, |alpha| alpha.at(x));
                    let reaction = reaction.map_or(0.0, |c| c.at(x));
                    let (value, gradient) = admissible.at(point, x);
                    let q = flux.at(point, x);
                    mismatch += weight * (gradient * alpha - q).norm_squared() / alpha;
                    let discrete = basis.value(&local);
                    from_values += weight * reaction * (discrete - value).powi(2);
                    let slope = constant.unwrap_or_else(|| gradient_of(basis));
                    terms.distance += weight * alpha * (gradient - slope).norm_squared();
                    let load = source.map_or(0.0, |f| f.at(x)) - reaction * discrete;
                    let load = load - *first.get_or_insert(load);
                    square += weight * load * load;
                    let differences = [0, 1].map(|k| {
                        let sign = [1.0, -1.0][k];
                        admissible.bounds[k]
                            .map_or(0.0, |bound| weight * sign * (value - bound.at(x)))
                    });
                    for (k, share) in flux.shares(point).iter().enumerate() {
                        means[k] += weight * load / volume * share;
                        gaps[0][k] += differences[0] * share;
                        gaps[1][k] += differences[1] * share;
                    }
                    terms.least_coefficient = terms.least_coefficient.min(alpha);
                    terms.least_reaction = terms.least_reaction.min(reaction);
                },
            );
        }
        let [mismatch, from_values] = [mismatch, from_values].map(integral_of_square);
        terms.distance = integral_of_square(terms.distance) + from_values;
        terms.mismatch = mismatch + from_values;
        let by_gradient = admissible.diameter / (PI * terms.least_coefficient.sqrt());
        let by_value = terms.least_reaction.max(0.0).sqrt().recip();
        let balance = flux.balance(volume, &means, square, first.unwrap_or(0.0));
        let bound = usize::from(balance.mean < 0.0);
        let share = limit(balance.mean, &balance.values[..flux.n]);
        for (value, gap) in balance.values.iter().zip(gaps[bound]).take(flux.n) {
            let multiplier = balance.mean + share * (value - balance.mean);
            terms.obstacle += 2.0 * multiplier.abs() * gap;
        }
        terms.unbalanced = balance.mean;
        let square_of_mean = balance.mean * balance.mean * volume;
        terms.ratio = match (admissible.bounds[bound], friedrichs) {
            (None, _) => f64::INFINITY,
            (Some(_), Some(c)) if square_of_mean > 0.0 => {
                terms.obstacle * terms.least_coefficient / (c * c * square_of_mean)
            }
            _ => 0.0,
        };
        let of_trace =
            boundary.traces.get(cell).map_or(0.0, |n| n / terms.least_coefficient.sqrt());
        terms.with_oscillation = [1.0 - share, 1.0].map(|left| {
            let of_load = (balance.rest + left * left * balance.variation).sqrt();
            let [in_gradient, in_value] = match by_value < by_gradient {
                true => [of_trace, by_value * of_load],
                false => [by_gradient * of_load + of_trace, 0.0],
            };
            (mismatch.sqrt() + in_gradient).powi(2) + (from_values.sqrt() + in_value).powi(2)
        });
        terms.contact = boundary.contact.get(cell).map_or(0.0, |c| 2.0 * c);
        terms
    }

    /// The constant of the trace inequality on a facet: for `w` with mean zero in a cell the divergence theorem for
    /// `w^2 (x - a_F)` and the inequality of Payne and Weinberger give
    /// `|w|_F^2 <= |F| / |K| (1/pi^2 + 2/(pi D)) h_K^2 |grad w|_K^2`.
    pub(super) fn constant_of_trace(&self, place: Place) -> f64 {
        let volume = self.mesh.geometry(place.0).volume.to_f64();
        let square = self.facet_measure(place) / volume * (1.0 / (PI * PI) + 2.0 / (PI * D as f64));
        square.sqrt() * self.mesh.cell_diameter(place.0).to_f64()
    }

    /// The terms of the boundary.
    pub(super) fn boundary_terms(&self, pair: &PrimalDualPair) -> Result<BoundaryTerms, NoBound> {
        let n_cells = self.mesh.n_cells();
        let zeros = |is_needed: bool| vec![0.0; if is_needed { n_cells } else { 0 }];
        let has_fluxes =
            self.problem.has_neumann_data() && self.mesh.has_part(BoundaryPart::Neumann);
        let has_gap = self.problem.has_gap();
        let mut terms = BoundaryTerms {
            traces: zeros(has_fluxes || has_gap && pair.degree > 1),
            contact: zeros(has_gap),
        };
        if has_fluxes {
            for (place, group) in self.grouped_facets_of(BoundaryPart::Neumann) {
                let measure = self.facet_measure(place);
                let flux = self.flux_on(pair, place);
                let mut square = 0.0;
                for (point, weight) in self.facet_rule.iter() {
                    let datum = self.neumann_at(place, group, point)?;
                    let flux = flux.scale * flux.at(&facet_to_cell(point, place.1)) / measure;
                    square += weight * measure * (datum - flux).powi(2);
                }
                terms.traces[place.0] += self.constant_of_trace(place) * square.sqrt();
            }
        }
        let (mut least, mut largest) = (0.0_f64, 0.0_f64);
        for (place, group) in self.grouped_facets_of(BoundaryPart::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            let admissible = self.admissible_in(pair, place.0);
            let flux = self.flux_on(pair, place);
            let integral = flux.integral(D);
            (least, largest) = (least.min(integral), largest.max(integral));
            let (force, left) = flux.limited(D);
            let mut sum = 0.0;
            for (point, weight) in self.facet_rule.iter() {
                let x = self.facet_point(point, place.0, place.1);
                let point = facet_to_cell(point, place.1);
                let (value, _) = admissible.at(&point, &x);
                sum += weight * force.at(&point) * (value - gap.at(&x)).max(0.0);
            }
            terms.contact[place.0] += force.scale * sum;
            if pair.degree > 1 {
                let measure = self.facet_measure(place);
                terms.traces[place.0] += self.constant_of_trace(place) * (left / measure).sqrt();
            }
        }
        match -least > FORCE_ROUNDING * largest {
            true => Err(NoBound::NegativeForce),
            false => Ok(terms),
        }
    }

    /// The flux of a pair through a facet.
    fn flux_on(&self, pair: &PrimalDualPair, (cell, local): Place) -> FacetFlux {
        let place = cell * (D + 1) + local;
        if pair.degree == 1 {
            return FacetFlux { scale: pair.flux[place], values: None, local };
        }
        let mut values = [0.0; 4];
        values[..=D].copy_from_slice(&pair.flux[place * (D + 1)..][..D + 1]);
        values[local] = 0.0;
        FacetFlux { scale: 1.0, values: Some(values), local }
    }
}
