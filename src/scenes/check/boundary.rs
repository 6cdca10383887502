//! Conditions on the sides of the domain.

use super::evaluator::Evaluator;
use super::samples::{BoundaryPoint, boundary};
use super::violation::Violation;
use crate::mesh::{BoundaryCondition, Domain};

/// Error allowed in boundary conditions, relative to the scales of value and flux.
const EXACT: f64 = 1e-8;

impl<const D: usize> Evaluator<'_, D> {
    /// Boundary data are those of the solution, and contact sides satisfy the Signorini conditions.
    pub(super) fn check_boundary(
        &self,
        domain: &Domain<D>,
        samples: usize,
    ) -> Result<(), Violation> {
        boundary(domain, samples).iter().try_for_each(|point| self.check_boundary_at(point, EXACT))
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
        if let (BoundaryCondition::Neumann, Some(g)) = (condition, &problem.friction.everywhere) {
            let (g, u) = (g.at(&x), self.value(&x));
            self.require("|alpha du/dn| <= g of friction", &x, outflow.abs() - g, flux)?;
            let work = outflow * u + g * u.abs();
            let most = flux * u.abs() + value * (g + outflow.abs());
            return self.require("alpha du/dn u + g |u| = 0 of friction", &x, work, most);
        }
        if let (BoundaryCondition::Neumann, Some(side)) = (condition, &problem.robin.everywhere) {
            let force = side.coefficient.at(&x) * (side.value.at(&x) - self.value(&x));
            let error = (force - outflow).abs();
            return self.require("the Robin condition", &x, error, flux + exact * force.abs());
        }
        match (condition, &problem.neumann.everywhere, &problem.gap.everywhere) {
            (BoundaryCondition::Dirichlet, _, _) => {
                let error = (problem.dirichlet_at(&x) - self.value(&x)).abs();
                self.require("Dirichlet data equal to the solution", &x, error, value)?;
            }
            (BoundaryCondition::Neumann, Some(q), _) => {
                let error = (q.at(&x, &normal) - outflow).abs();
                self.require("Neumann data equal to the flux of the solution", &x, error, flux)?;
            }
            (BoundaryCondition::Contact, _, Some(g)) => {
                let above = self.value(&x) - g.at(&x);
                self.require("u >= g on the contact boundary", &x, -above, value)?;
                self.require("alpha du/dn >= 0 on the contact boundary", &x, -outflow, flux)?;
                if above > value {
                    self.require(
                        "u = g or alpha du/dn = 0 on the contact boundary",
                        &x,
                        outflow,
                        flux,
                    )?;
                }
                self.check_stated_on_boundary(&x, above, outflow)?;
            }
            _ => {}
        }
        Ok(())
    }
}
