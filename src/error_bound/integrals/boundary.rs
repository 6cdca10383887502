//! Integrals of a pair over the boundary.

use std::borrow::Cow;
use std::f64::consts::PI;

use crate::assemble::space::Space;
use crate::error_bound::flux::share_of_one_sign;
use crate::error_bound::friedrichs::FriedrichsData;
use crate::error_bound::quadratics::vertices_of;
use crate::error_bound::{NoBound, PrimalDualPair};
use crate::measure::Admissible;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::quadrature::{Rule, facet_to_cell};

/// A negative contact force below this share of the largest one is rounding.
const FORCE_ROUNDING: f64 = 1e-8;

/// A distance from an obstacle of this many units of rounding of value and data is zero on a facet: without it the bound of
/// ridge-2d is 2e-8 where all else is zero.
const ROUNDINGS: f64 = 4.0;

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
        let vertices = || (0..dimension + 1).filter(|&k| k != self.local);
        // the value at the vertex opposite the facet does not count
        values[self.local] = mean;
        let share = share_of_one_sign(mean, &values[..=dimension]);
        let squares: f64 = values[..=dimension].iter().map(|v| (v - mean).powi(2)).sum();
        vertices().for_each(|k| values[k] = mean + share * (values[k] - mean));
        values[self.local] = 0.0;
        let left = (1.0 - share).powi(2) * squares / (d * (d + 1.0));
        (Self { values: Some(values), ..self }, left)
    }
}

/// Integrals over the boundary, by cell; empty where there are none.
pub(in crate::error_bound) struct BoundaryTerms {
    /// Norms of what Neumann data and contact forces have besides those of the pair, with the constant of the
    /// trace inequality.
    pub(super) traces: Vec<f64>,
    /// On Robin sides the squares of `k^-1/2 t` where that is smaller than the term with the constant.
    pub(super) robin: Vec<f64>,
    /// The complementarity of contact.
    pub(super) contact: Vec<f64>,
    /// The complementarity of obstacles on facets, half to each cell.
    pub(super) obstacle: Vec<f64>,
    /// Whether multipliers that are rounding count as the residual of the solver: where forces act on facets, and
    /// Friedrichs' constant is known.
    pub(super) has_rounding: bool,
}

impl<const D: usize> Space<'_, D> {
    /// The constant of the trace inequality on a facet: for `w` with mean zero in a cell the divergence theorem for
    /// `w^2 (x - a_F)` and the inequality of Payne and Weinberger give
    /// `|w|_F^2 <= |F| / |K| (1/pi^2 + 2/(pi D)) h_K^2 |grad w|_K^2`. With a tensor `T = L L^T` the inequality is that in
    /// the coordinates `L^-1 x`: `h_K` is the diameter of the cell there, `L^T grad w` the gradient.
    pub(in crate::error_bound) fn constant_of_trace(&self, facet: HalfFacet) -> f64 {
        let volume = self.mesh.geometry(facet.0).volume;
        let square = self.facet_measure(facet) / volume * (1.0 / (PI * PI) + 2.0 / (PI * D as f64));
        square.sqrt() * self.isotropic_diameter(facet.0)
    }

    /// The rule for the square of Neumann data less the flux, and for contact forces times distances from the gap:
    /// exact for polynomial data.
    fn rule_of_facets(&self, of_pair: usize) -> Cow<'_, Rule> {
        let of_gap = self.degree_of(&self.data.gap).unwrap_or_default();
        let of_neumann = 2 * self.neumann_degree().unwrap_or_default().max(of_pair - 1);
        let degree = of_neumann.max(of_pair - 1 + of_gap.max(of_pair));
        match self.facet_rule.moments(D - 1, degree).all(|moment| moment.is_exact()) {
            true => Cow::Borrowed(&self.facet_rule),
            false => Cow::Owned(Rule::new(D - 1, degree)),
        }
    }

    /// The terms of the boundary.
    pub(in crate::error_bound) fn boundary_terms(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
    ) -> Result<BoundaryTerms, NoBound> {
        let n_cells = self.mesh.n_cells();
        let zeros = |is_needed: bool| vec![0.0; if is_needed { n_cells } else { 0 }];
        // without data a flux of degree zero is zero there
        let has_fluxes = (self.problem.has_neumann_data() || pair.degree > 1)
            && self.mesh.has_condition(BoundaryCondition::Neumann);
        let (has_gap, has_friction) = (self.problem.has_gap(), self.data.friction.is_given());
        let rule = self.rule_of_facets(pair.degree);
        let mut terms = BoundaryTerms {
            traces: zeros(has_fluxes || has_friction || has_gap && pair.degree > 1),
            robin: zeros(self.data.robin.is_given()),
            contact: zeros(has_gap || has_friction),
            obstacle: self.facet_obstacle_terms(pair)?,
            has_rounding: !pair.forces.is_empty()
                && FriedrichsData::of(self.mesh).constant().is_some(),
        };
        if has_fluxes {
            let with_friction = |group: usize| self.data.friction.of(group).is_some();
            let facets = self.grouped_facets_of(BoundaryCondition::Neumann);
            for (facet, group) in facets.filter(|(_, group)| !with_friction(*group)) {
                let measure = self.facet_measure(facet);
                let flux = self.flux_on(pair, facet);
                let force = pair.forces.binary_search_by_key(&facet, |force| force.facet);
                let force = force.map_or([0.0; 4], |k| pair.forces[k].densities);
                let mut square = 0.0;
                for (point, weight) in rule.iter() {
                    let in_cell = facet_to_cell(point, facet.1);
                    let force: f64 = force.iter().zip(&in_cell).map(|(s, b)| s * b).sum();
                    let datum = self.neumann_at(facet, group, point, Some(u))? + force / measure;
                    let flux = flux.scale * flux.at(&in_cell) / measure;
                    square += weight * measure * (datum - flux).powi(2);
                }
                let of_trace = self.constant_of_trace(facet) * square.sqrt();
                let least =
                    self.data.robin.of(group).map_or(0.0, |side| {
                        self.least_values(facet.0, &side.coefficient)[1].max(0.0)
                    });
                match square < least * of_trace.powi(2) / self.alpha(facet.0) {
                    true => terms.robin[facet.0] += square / least,
                    false => terms.traces[facet.0] += of_trace,
                }
            }
        }
        if has_friction {
            self.add_friction_terms(pair, &mut terms)?;
        }
        let (mut least, mut largest) = (0.0_f64, 0.0_f64);
        for (facet, group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            let admissible = self.admissible_in(pair, facet.0);
            let flux = self.flux_on(pair, facet);
            let integral = flux.integral(D);
            (least, largest) = (least.min(integral), largest.max(integral));
            let (force, left) = flux.limited(D);
            let mut sum = 0.0;
            for (point, weight) in rule.iter() {
                let x = self.facet_point(point, facet.0, facet.1);
                let point = facet_to_cell(point, facet.1);
                let (value, _) = admissible.at(&point, &x);
                sum += weight * force.at(&point) * (value - self.at(gap, facet.0, &x)).max(0.0);
            }
            terms.contact[facet.0] += force.scale * sum;
            if pair.degree > 1 {
                let measure = self.facet_measure(facet);
                terms.traces[facet.0] += self.constant_of_trace(facet) * (left / measure).sqrt();
            }
        }
        match -least > FORCE_ROUNDING * largest {
            true => Err(NoBound::NegativeForce),
            false => Ok(terms),
        }
    }

    /// Adds the terms of friction: `int g |v| + mu v` with a multiplier `mu`, `|mu| <= g`, that has the integral of the flux
    /// over the facet, where `|v|` is at most the sum of `|v_j| lambda_j` over the vertices for linears; and the norm of `mu`
    /// less the flux with the constant of the trace inequality. The multiplier is the threshold times a linear function
    /// within one at the vertices, as near to that of the flux as these allow.
    fn add_friction_terms(
        &self,
        pair: &PrimalDualPair<D>,
        terms: &mut BoundaryTerms,
    ) -> Result<(), NoBound> {
        for (facet, group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
            if self.data.friction.of(group).is_none() {
                continue;
            }
            let (flux, measure) = (self.flux_on(pair, facet), self.facet_measure(facet));
            // the threshold tested with one and with barycentric coordinates
            let (mut most, mut tested) = (0.0, [0.0; 4]);
            self.visit_friction(facet, group, &mut |point, weight| {
                most += weight;
                tested.iter_mut().zip(point).for_each(|(sum, b)| *sum += weight * b);
            })?;
            let integral = flux.integral(D);
            if integral.abs() > (1.0 + FORCE_ROUNDING) * most {
                return Err(NoBound::NegativeForce);
            }
            let mut shares = [0.0; 4];
            if most > 0.0 {
                let mean = (integral / most).clamp(-1.0, 1.0);
                let rest_of = |values: [f64; 4]| values.map(|value| (value - integral) / most);
                let rests = flux.values.map_or([0.0; 4], rest_of);
                let shift: f64 = tested.iter().zip(&rests).map(|(t, rest)| t * rest).sum();
                let rests = rests.map(|rest| rest - shift / most);
                let allowed = |j: usize| match rests[j] {
                    rest if rest > 0.0 => (1.0 - mean) / rest,
                    rest if rest < 0.0 => -(1.0 + mean) / rest,
                    _ => 1.0,
                };
                let step = vertices_of::<D>(facet.1).map(allowed).fold(1.0, f64::min);
                shares = rests.map(|rest| mean + step * rest);
            }
            let admissible = self.admissible_in(pair, facet.0);
            let constant = self.body_constants.of_cell(facet.0);
            let (mut sum, mut square) = (0.0, 0.0);
            let mut rule = self.facet_rule.weights.iter();
            self.visit_friction(facet, group, &mut |point, weight| {
                let value = admissible.at(point, &self.cell_point(point, facet.0)).0 + constant;
                let at_vertices = admissible.values.iter().zip(point);
                let above = match pair.degree {
                    1 => at_vertices.map(|(v, b)| (v + constant).abs() * b).sum(),
                    _ => value.abs(),
                };
                let of_point = rule.next().expect("the rule has a weight a point") * measure;
                let share: f64 = shares.iter().zip(point).map(|(share, b)| share * b).sum();
                let rest = flux.scale * flux.at(point) / measure - share * weight / of_point;
                sum += weight * (above + share * value);
                square += of_point * rest.powi(2);
            })?;
            terms.contact[facet.0] += sum.max(0.0);
            terms.traces[facet.0] += self.constant_of_trace(facet) * square.sqrt();
        }
        Ok(())
    }

    /// By cell the integrals of the forces of obstacles on facets times the distance from the obstacle: of the two sides
    /// of a facet the smaller one, half to each cell. Empty without forces.
    fn facet_obstacle_terms(&self, pair: &PrimalDualPair<D>) -> Result<Vec<f64>, NoBound> {
        let mut terms = vec![0.0; if pair.forces.is_empty() { 0 } else { self.mesh.n_cells() }];
        let degrees = [&self.data.lower, &self.data.upper].map(|psi| self.degree_of(psi));
        let of_obstacle = degrees.into_iter().flatten().fold(pair.degree, usize::max);
        let rule = Rule::new(D - 1, pair.degree - 1 + of_obstacle);
        for force in &pair.forces {
            let (cell, local) = force.facet;
            let mean: f64 = force.densities.iter().sum();
            let (k, sign) = if mean < 0.0 { (1, -1.0) } else { (0, 1.0) };
            if vertices_of::<D>(local).any(|j| sign * force.densities[j] < 0.0) {
                return Err(NoBound::NegativeForce);
            }
            // the function has the same values from both sides
            let function = Admissible { bounds: [None; 2], ..self.admissible_in(pair, cell) };
            let on_side = |(side, _): HalfFacet| {
                let obstacle = [&self.data.lower, &self.data.upper][k];
                let obstacle = obstacle.of(self.mesh.region(side))?;
                let mut sum = 0.0;
                for (point, weight) in rule.iter() {
                    let x = self.facet_point(point, cell, local);
                    let point = facet_to_cell(point, local);
                    let density: f64 = force.densities.iter().zip(&point).map(|(s, b)| s * b).sum();
                    let (value, _) = function.at(&point, &x);
                    let at = self.at(obstacle, side, &x);
                    let rounding = f64::EPSILON * (value.abs() + at.abs()) + obstacle.rounding();
                    let distance = sign * (value - at);
                    // a distance that is not finite counts
                    let is_zero = rounding.is_finite() && distance <= ROUNDINGS * rounding;
                    sum += weight * density.abs() * if is_zero { 0.0 } else { distance };
                }
                Some(sum)
            };
            let least = force.sides().filter_map(on_side).reduce(f64::min);
            let term = least.ok_or(NoBound::NegativeForce)?;
            let n_sides = force.sides().count() as f64;
            force.sides().for_each(|(cell, _)| terms[cell] += term / n_sides);
        }
        Ok(terms)
    }

    /// The flux of a pair through a facet.
    fn flux_on(&self, pair: &PrimalDualPair<D>, (cell, local): HalfFacet) -> FacetFlux {
        if pair.flux.degree() == 0 {
            return FacetFlux { scale: pair.flux.through(cell, local), values: None, local };
        }
        let mut values = [0.0; 4];
        vertices_of::<D>(local).for_each(|j| values[j] = pair.flux.density(cell, local, j));
        FacetFlux { scale: 1.0, values: Some(values), local }
    }
}
