//! Integrals of a pair over cells and the boundary.

use std::f64::consts::PI;

use super::{NoBound, PrimalDualPair};
use crate::assemble::cut_simplices::CutRule;
use crate::assemble::space::Space;
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::mesh::BoundaryPart;
use crate::problem::{DataByGroup, DatumRef, Field};
use crate::quadrature::facet_to_cell;
use crate::real::{Point, Real, point_f64};

/// The step of difference quotients of obstacles, as a share of the diameter of the cell.
const STEP: f64 = 1e-5;

/// Integrals over one cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellTerms {
    /// The square of the mismatch.
    pub mismatch: f64,
    /// The square of the mismatch with the oscillation added.
    pub with_oscillation: f64,
    /// Twice the complementarity of obstacles.
    pub obstacle: f64,
    /// Twice the complementarity of contact.
    pub contact: f64,
    /// What the flux does not balance, of either sign.
    pub unbalanced: f64,
    /// The square of the distance of the two functions.
    pub distance: f64,
    /// The least value of the coefficient.
    pub least_coefficient: f64,
    /// The least value of the reaction.
    pub least_reaction: f64,
}

/// A function of a quadrature point of a cell: barycentric coordinates, coordinates in space, weight and values
/// of the basis.
pub(super) type Visit<'v, const D: usize> =
    &'v mut dyn FnMut(&[f64; 4], &Point<f64, D>, f64, &BasisAt<f64>);

/// The admissible function in a cell.
pub(super) struct Admissible<'d, const D: usize> {
    /// At the vertices.
    values: [f64; 4],
    /// The gradient of the interpolant.
    gradient: Point<f64, D>,
    /// The obstacles, lower and upper one.
    bounds: [Option<DatumRef<'d, D>>; 2],
    /// The step of difference quotients.
    step: f64,
}

impl<const D: usize> Admissible<'_, D> {
    /// Value and gradient at a point, by barycentric coordinates and in space.
    pub(super) fn at(&self, point: &[f64; 4], x: &Point<f64, D>) -> (f64, Point<f64, D>) {
        let mut value = self.values.iter().zip(point).map(|(v, b)| v * b).sum();
        let mut gradient = self.gradient;
        for (bound, sign) in self.bounds.iter().zip([1.0, -1.0]) {
            let Some(bound) = bound else { continue };
            let at = bound.at(x);
            if sign * (at - value) > 0.0 {
                value = at;
                gradient = Point::from_fn(|axis, _| {
                    let (mut ahead, mut behind) = (*x, *x);
                    ahead[axis] += self.step;
                    behind[axis] -= self.step;
                    (bound.at(&ahead) - bound.at(&behind)) / (2.0 * self.step)
                });
            }
        }
        (value, gradient)
    }
}

/// Integrals over the boundary, by cell; empty where there are none.
pub(super) struct BoundaryTerms {
    /// Norms of the oscillation of Neumann data with the constant of the trace inequality.
    neumann: Vec<f64>,
    /// The complementarity of contact.
    contact: Vec<f64>,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The admissible function in a cell.
    pub(super) fn admissible_in(&self, pair: &PrimalDualPair, cell: usize) -> Admissible<'_, D> {
        let (geometry, region) = (self.mesh.geometry(cell), self.mesh.region(cell));
        let mut values = [0.0; 4];
        let mut gradient = Point::zeros();
        for (k, &v) in self.mesh.cell(cell).iter().enumerate() {
            values[k] = pair.function[v as usize];
            gradient += point_f64(geometry.gradient(k)) * (values[k] - values[0]);
        }
        let step = STEP * self.mesh.cell_diameter(cell).to_f64();
        let bounds = [self.data.lower.of(region), self.data.upper.of(region)];
        Admissible { values, gradient, bounds, step }
    }

    /// Calls a function with the points of a rule on a cell, divided where a level has zeros.
    pub(super) fn visit_points(
        &self,
        cell: usize,
        table: &CellTable<f64>,
        cut: Option<(&CutRule, &Field<D>)>,
        visit: Visit<'_, D>,
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
        let flux = &pair.flux[cell * (D + 1)..(cell + 1) * (D + 1)];
        let per_volume = 1.0 / (D as f64 * volume);
        let total_flux: f64 = flux.iter().sum();
        // q = sum_F flux_F (x - a_F) / (D |K|)
        let mut origin = Point::<f64, D>::zeros();
        for (&v, flux) in self.mesh.cell(cell).iter().zip(flux) {
            origin += point_f64(&self.mesh.vertices()[v as usize]) * *flux;
        }
        let local = self.local_values(cell, u);
        let datum = |data: &DataByGroup<'_, D>, x: &Point<f64, D>| self.in_region(data, cell, x);
        let admissible = self.admissible_in(pair, cell);
        // the derivatives of linear functions are those at any point
        let mut discrete_gradient = Point::<f64, D>::zeros();
        for k in 0..=D {
            let derivatives = table.basis[0].derivatives.iter();
            let slope: f64 = local.iter().zip(derivatives).map(|(c, d)| c * d[k]).sum();
            discrete_gradient += point_f64(geometry.gradient(k)) * slope;
        }
        let mut terms = CellTerms {
            least_coefficient: f64::INFINITY,
            least_reaction: f64::INFINITY,
            ..CellTerms::default()
        };
        let (mut mismatch, mut from_values) = (0.0, 0.0);
        // the balance is summed from its value at the first point, so that a constant has no oscillation
        let (mut first, mut mean, mut square) = (None, 0.0, 0.0);
        let mut gaps = [0.0; 2];
        let level = self.data.source.of(region).and_then(|f| f.level());
        self.visit_points(cell, table, cut.zip(level), &mut |point, x, weight, basis| {
            let weight = weight * volume;
            let alpha = datum(&self.data.coefficient, x).unwrap_or(1.0);
            let reaction = datum(&self.data.reaction, x).unwrap_or(0.0);
            let (value, gradient) = admissible.at(point, x);
            let q = (x * total_flux - origin) * per_volume;
            mismatch += weight * (gradient * alpha - q).norm_squared() / alpha;
            let discrete = basis.value(&local);
            from_values += weight * reaction * (discrete - value).powi(2);
            terms.distance += weight * alpha * (gradient - discrete_gradient).norm_squared();
            let load = datum(&self.data.source, x).unwrap_or(0.0) - reaction * discrete;
            let load = load - *first.get_or_insert(load);
            mean += weight * load / volume;
            square += weight * load * load;
            for (gap, (bound, sign)) in
                gaps.iter_mut().zip(admissible.bounds.iter().zip([1.0, -1.0]))
            {
                *gap += bound.map_or(0.0, |bound| weight * sign * (value - bound.at(x)));
            }
            terms.least_coefficient = terms.least_coefficient.min(alpha);
            terms.least_reaction = terms.least_reaction.min(reaction);
        });
        terms.distance += from_values;
        terms.mismatch = mismatch + from_values;
        let diameter = self.mesh.cell_diameter(cell).to_f64();
        let by_gradient = diameter / (PI * terms.least_coefficient.sqrt());
        let by_value = terms.least_reaction.max(0.0).sqrt().recip();
        let of_load = (square - volume * mean * mean).max(0.0).sqrt();
        let of_neumann =
            boundary.neumann.get(cell).map_or(0.0, |n| n / terms.least_coefficient.sqrt());
        let [in_gradient, in_value] = match by_value < by_gradient {
            true => [of_neumann, by_value * of_load],
            false => [by_gradient * of_load + of_neumann, 0.0],
        };
        terms.with_oscillation =
            (mismatch.sqrt() + in_gradient).powi(2) + (from_values.sqrt() + in_value).powi(2);
        let multiplier = -total_flux / volume - mean - first.unwrap_or(0.0);
        let bound = usize::from(multiplier < 0.0);
        // what the solver leaves away from contact would count once there, and squared here
        let of_solver = friedrichs.map(|c| c * c * multiplier.abs() / terms.least_coefficient);
        match admissible.bounds[bound] {
            Some(_)
                if of_solver.is_none_or(|of_solver| 2.0 * gaps[bound] <= of_solver * volume) =>
            {
                terms.obstacle = 2.0 * multiplier.abs() * gaps[bound];
            }
            _ => terms.unbalanced = multiplier,
        }
        terms.contact = boundary.contact.get(cell).map_or(0.0, |c| 2.0 * c);
        terms
    }

    /// The terms of the boundary.
    ///
    /// For `w` with mean zero in a cell the divergence theorem for `w^2 (x - a_F)` and the inequality of Payne
    /// and Weinberger give `|w|_F^2 <= |F| / |K| (1/pi^2 + 2/(pi D)) h_K^2 |grad w|_K^2`.
    pub(super) fn boundary_terms(&self, pair: &PrimalDualPair) -> Result<BoundaryTerms, NoBound> {
        let n_cells = self.mesh.n_cells();
        let zeros = |is_needed: bool| vec![0.0; if is_needed { n_cells } else { 0 }];
        let has_fluxes = self.problem.has_neumann_data();
        let mut terms = BoundaryTerms {
            neumann: zeros(has_fluxes && self.mesh.has_part(BoundaryPart::Neumann)),
            contact: zeros(self.problem.has_gap()),
        };
        let place_of = |(cell, local): (usize, usize)| cell * (D + 1) + local;
        if has_fluxes {
            let dimension = D as f64;
            for (place, group) in self.grouped_facets_of(BoundaryPart::Neumann) {
                let geometry = self.mesh.geometry(place.0);
                let measure = geometry.facet_measure(place.1).to_f64();
                let mean = pair.flux[place_of(place)] / measure;
                let mut square = 0.0;
                for (point, weight) in self.facet_rule.iter() {
                    let datum = self.neumann_at(place, group, point)?;
                    square += weight * measure * (datum - mean).powi(2);
                }
                let diameter = self.mesh.cell_diameter(place.0).to_f64();
                let constant = measure / geometry.volume.to_f64()
                    * (1.0 / (PI * PI) + 2.0 / (PI * dimension))
                    * diameter.powi(2);
                terms.neumann[place.0] += (constant * square).sqrt();
            }
        }
        for (place, group) in self.grouped_facets_of(BoundaryPart::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            let admissible = self.admissible_in(pair, place.0);
            let mut mean = 0.0;
            for (point, weight) in self.facet_rule.iter() {
                let x = self.facet_point(point, place.0, place.1);
                let (value, _) = admissible.at(&facet_to_cell(point, place.1), &x);
                mean += weight * (value - gap.at(&x)).max(0.0);
            }
            terms.contact[place.0] += pair.flux[place_of(place)] * mean;
        }
        Ok(terms)
    }
}
