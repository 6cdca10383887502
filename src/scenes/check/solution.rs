//! The conditions that an exact solution satisfies at a point.

use super::violation::Violation;
use crate::mesh::BoundaryCondition;
use crate::problem::{Datum, Exact, Problem};
use crate::real::Point;

/// Distance to an obstacle that counts as contact, relative to the largest value.
const TOUCHING: f64 = 1e-8;
/// Error allowed in derivatives and in data on the boundary, relative to their scales: vertices of mesh files are rounded.
const ERROR: f64 = 1e-6;
/// Largest difference of derivatives by two steps that agree, relative to the scale of the derivative.
const SETTLED: f64 = 1e-7;
/// Largest step of differences, relative to the diameter of the domain.
const STEP: f64 = 2e-4;

const CONTACT_SET: &str = "contact inside the stated contact set and nowhere else";

/// Largest absolute values at the points; tolerances are multiples of them.
#[derive(Clone, Copy, Default)]
pub(super) struct Scales {
    /// Diameter of the domain.
    pub length: f64,
    pub value: f64,
    /// Of the gradient, at least value over length.
    pub slope: f64,
    /// Of `alpha grad u`, at least coefficient times value over length.
    pub flux: f64,
    /// Of load and reaction times value, at least flux over length.
    pub force: f64,
}

/// The exact solution of a problem, whose data are those without a name.
pub(super) struct Solution<'a, const D: usize> {
    /// The name of the scene.
    pub name: &'a str,
    pub problem: &'a Problem<D>,
    pub exact: &'a Exact<D>,
    pub scales: Scales,
}

impl<const D: usize> Solution<'_, D> {
    fn value(&self, x: &Point<D>) -> f64 {
        self.exact.value.at(x)
    }
    fn coefficient(&self, x: &Point<D>) -> f64 {
        self.problem.coefficient.everywhere.as_ref().map_or(1.0, |alpha| alpha.at(x))
    }
    /// `alpha T grad u` with the tensor `T`.
    fn flux(&self, x: &Point<D>) -> Point<D> {
        let gradient = (self.exact.gradient)(x) * self.coefficient(x);
        self.problem.tensor.everywhere.as_ref().map_or(gradient, |tensor| tensor.at(x) * gradient)
    }
    fn source(&self, x: &Point<D>) -> f64 {
        self.problem.source.everywhere.as_ref().map_or(0.0, |f| f.at(x))
    }
    /// The reaction times the solution.
    fn held(&self, x: &Point<D>) -> f64 {
        self.problem.reaction.everywhere.as_ref().map_or(0.0, |c| c.at(x) * self.value(x))
    }
    /// `u - psi` above the lower obstacle and `psi - u` below the upper one, infinite without obstacle.
    fn gaps(&self, x: &Point<D>) -> [f64; 2] {
        let Problem { lower, upper, .. } = self.problem;
        let above = |psi: &Datum<D>| self.value(x) - psi.at(x);
        let [lower, upper] = [lower, upper].map(|of| of.everywhere.as_ref().map(above));
        [lower.unwrap_or(f64::INFINITY), upper.map_or(f64::INFINITY, |above| -above)]
    }

    /// The scales, with those of a point.
    pub fn scales_with(&self, x: &Point<D>) -> Scales {
        let Scales { length, value, slope, flux, force } = self.scales;
        let own = self.value(x).abs();
        let value = value.max(own);
        let slope = slope.max((self.exact.gradient)(x).norm()).max(value / length);
        let flux = flux.max(self.flux(x).norm()).max(self.coefficient(x) * value / length);
        let force = force.max(self.source(x).abs()).max(self.held(x).abs()).max(flux / length);
        Scales { length, value, slope, flux, force }
    }

    /// A violation unless `by <= allowed`; a violation if `by` is not a number.
    pub fn require(
        &self,
        condition: &str,
        at: &Point<D>,
        by: f64,
        allowed: f64,
    ) -> Result<(), Violation> {
        match by <= allowed {
            true => Ok(()),
            false => Err(Violation::new(self.name, condition, at, by, allowed)),
        }
    }

    /// Obstacles, gradient, equation and multiplier at a point of this distance from where other data begin. Returns
    /// whether the derivatives are known there.
    pub fn check_inside(&self, x: &Point<D>, depth: f64) -> Result<bool, Violation> {
        let scales = &self.scales;
        let touching = TOUCHING * scales.value;
        let [above, below] = self.gaps(x);
        self.require("solution above the lower obstacle", x, -above, touching)?;
        self.require("solution below the upper obstacle", x, -below, touching)?;
        let step = (STEP * scales.length).min(0.4 * depth);
        let stated = (self.exact.gradient)(x);
        let mut divergence = 0.0;
        for axis in 0..D {
            let value = |x: &Point<D>| self.value(x);
            let Some(slope) = derivative(value, x, axis, step, SETTLED * scales.slope) else {
                return Ok(false);
            };
            let condition = "gradient equal to the derivative of the value";
            self.require(condition, x, (slope - stated[axis]).abs(), ERROR * scales.slope)?;
            let flux = |x: &Point<D>| self.flux(x)[axis];
            let Some(change) = derivative(flux, x, axis, step, SETTLED * scales.force) else {
                return Ok(false);
            };
            divergence += change;
        }
        let multiplier = self.held(x) - divergence - self.source(x);
        let allowed = ERROR * scales.force;
        let sign = "sign of the multiplier on contact";
        match (above <= touching, below <= touching) {
            (false, false) => {
                let condition = "-div(alpha grad u) + c u = f off contact";
                self.require(condition, x, multiplier.abs(), allowed)?;
            }
            (true, false) => self.require(sign, x, -multiplier, allowed)?,
            (false, true) => self.require(sign, x, multiplier, allowed)?,
            (true, true) => {}
        }
        if self.problem.has_obstacle() {
            self.check_stated(x, above.min(below), multiplier, allowed)?;
        }
        Ok(true)
    }

    /// The multiplier is the one stated. Inside the stated contact set a bound is active; outside the gap is positive and
    /// the multiplier vanishes.
    fn check_stated(
        &self,
        x: &Point<D>,
        gap: f64,
        multiplier: f64,
        allowed: f64,
    ) -> Result<(), Violation> {
        if let Some(stated) = &self.exact.multiplier {
            let condition = "stated multiplier equal to that of the solution";
            self.require(condition, x, (multiplier - stated(x)).abs(), allowed)?;
        }
        match self.exact.contact.as_ref().map(|contact| (contact.indicator)(x)) {
            Some(indicator) if indicator < 0.0 => {
                self.require(CONTACT_SET, x, multiplier.abs(), allowed)?;
                self.require(CONTACT_SET, x, -gap, -f64::MIN_POSITIVE)
            }
            Some(indicator) if indicator != 0.0 => {
                self.require(CONTACT_SET, x, gap, TOUCHING * self.scales.value)
            }
            _ => Ok(()),
        }
    }

    /// The indicator of the contact set vanishes on the stated free boundary.
    pub fn check_free_boundary(
        &self,
        points: &mut dyn Iterator<Item = &Point<D>>,
    ) -> Result<(), Violation> {
        let Some(contact) = &self.exact.contact else { return Ok(()) };
        let size = |x: &Point<D>| (contact.indicator)(x).abs();
        let largest = points.map(size).fold(0.0, f64::max);
        let condition = "free boundary between contact and no contact";
        let mut of_contact = contact.free_boundary.iter();
        of_contact.try_for_each(|x| self.require(condition, x, size(x), 1e-9 * largest))
    }

    /// The boundary data are those of the solution, and contact sides satisfy the Signorini conditions: at a point with
    /// this outward unit normal.
    pub fn check_boundary(
        &self,
        x: &Point<D>,
        normal: &Point<D>,
        condition: BoundaryCondition,
    ) -> Result<(), Violation> {
        let (value, flux) = (ERROR * self.scales.value, ERROR * self.scales.flux);
        let (problem, u, outflow) = (self.problem, self.value(x), self.flux(x).dot(normal));
        match condition {
            BoundaryCondition::Dirichlet => {
                let error = (problem.dirichlet_at(x) - u).abs();
                self.require("Dirichlet data equal to the solution", x, error, value)
            }
            BoundaryCondition::Contact => {
                let Some(gap) = &problem.gap.everywhere else { return Ok(()) };
                let above = u - gap.at(x);
                self.require("u >= g on the contact boundary", x, -above, value)?;
                self.require("alpha du/dn >= 0 on the contact boundary", x, -outflow, flux)?;
                if above > value {
                    let condition = "u = g or alpha du/dn = 0 on the contact boundary";
                    self.require(condition, x, outflow, flux)?;
                }
                self.check_stated(x, above, outflow, flux)
            }
            BoundaryCondition::Neumann => {
                if let Some(g) = &problem.friction.everywhere {
                    let g = g.at(x);
                    self.require("|alpha du/dn| <= g of friction", x, outflow.abs() - g, flux)?;
                    let work = outflow * u + g * u.abs();
                    let most = flux * u.abs() + value * (g + outflow.abs());
                    self.require("alpha du/dn u + g |u| = 0 of friction", x, work, most)
                } else if let Some(side) = &problem.robin.everywhere {
                    let force = side.coefficient.at(x) * (side.value.at(x) - u);
                    let allowed = flux + ERROR * force.abs();
                    self.require("the Robin condition", x, (force - outflow).abs(), allowed)
                } else if let Some(q) = &problem.neumann.everywhere {
                    let error = (q.at(x, normal) - outflow).abs();
                    self.require("Neumann data equal to the flux of the solution", x, error, flux)
                } else {
                    Ok(())
                }
            }
        }
    }
}

/// The derivative of a function along an axis by fourth-order central differences; none where those of half the step
/// disagree.
fn derivative<const D: usize>(
    f: impl Fn(&Point<D>) -> f64,
    x: &Point<D>,
    axis: usize,
    step: f64,
    tolerance: f64,
) -> Option<f64> {
    let at = |by: f64| f(&Point::from_fn(|k, _| if k == axis { x[k] + by } else { x[k] }));
    let by = |h: f64| (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    let (coarse, fine) = (by(step), by(0.5 * step));
    ((fine - coarse).abs() <= tolerance).then_some(fine)
}
