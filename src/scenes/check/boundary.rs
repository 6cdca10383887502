//! Conditions on the sides of the domain.

use super::evaluator::Evaluator;
use super::samples::{BoundaryPoint, boundary};
use super::violation::{Condition, Violation};
use crate::mesh::{BoundaryCondition, Domain};

/// Error allowed in boundary conditions, relative to the scales of value and flux.
const EXACT: f64 = 1e-8;
/// Distance from which the limit at the boundary is taken, relative to the shortest side.
const CLOSE: f64 = 1e-9;
/// Change of the gradient over that distance that counts as a jump, between that of a square root and
/// that across a branch cut.
const JUMP: f64 = 1e-3;

impl<const D: usize> Evaluator<'_, D> {
    /// Boundary data are those of the solution, and contact sides satisfy the Signorini conditions.
    pub(super) fn check_boundary(
        &self,
        domain: &Domain<D>,
        samples: usize,
    ) -> Result<(), Violation> {
        for point in boundary(domain, samples) {
            self.check_limit(&point)?;
            self.check_boundary_at(&point, EXACT)?;
        }
        Ok(())
    }

    /// The condition at a point of the boundary, up to this share of the scales of value and flux.
    pub(super) fn check_boundary_at(
        &self,
        &BoundaryPoint { x, normal, condition }: &BoundaryPoint<D>,
        exact: f64,
    ) -> Result<(), Violation> {
        let (value, flux) = (exact * self.scales.value, exact * self.scales.flux);
        let problem = self.problem;
        let outflow = self.flux(&x).dot(&normal);
        match (condition, &problem.neumann.everywhere, &problem.gap.everywhere) {
            (BoundaryCondition::Dirichlet, _, _) => {
                let error = (problem.dirichlet_at(&x) - self.value(&x)).abs();
                self.require(Condition::Dirichlet, &x, error, value)?;
            }
            (BoundaryCondition::Neumann, Some(q), _) => {
                let error = (q.at(&x, &normal) - outflow).abs();
                self.require(Condition::Neumann, &x, error, flux)?;
            }
            (BoundaryCondition::Contact, _, Some(g)) => {
                let above = self.value(&x) - g.at(&x);
                self.require(Condition::Gap, &x, -above, value)?;
                self.require(Condition::ContactFlux, &x, -outflow, flux)?;
                if above > value {
                    self.require(Condition::ContactComplementarity, &x, outflow, flux)?;
                }
                self.check_stated_on_boundary(&x, above, outflow)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Value and gradient do not change abruptly between the boundary, a point just inside and points
    /// that rounding makes of one on the boundary.
    fn check_limit(&self, point: &BoundaryPoint<D>) -> Result<(), Violation> {
        let length = self.scales.length;
        let (value, gradient) = (self.value(&point.x), self.gradient(&point.x));
        let inside = point.x - point.normal * (CLOSE * length);
        for y in point.rounded(length).into_iter().chain([inside]) {
            let turn = length * (self.gradient(&y) - gradient).norm();
            let jump = (self.value(&y) - value).abs().max(turn);
            let allowed = JUMP * length * self.scales.slope;
            self.require(Condition::BoundaryLimit, &y, jump, allowed)?;
        }
        Ok(())
    }
}
