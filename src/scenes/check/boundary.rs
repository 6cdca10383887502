//! Conditions on the sides of the domain.

use super::evaluator::Evaluator;
use super::samples::{BoundaryPoint, boundary};
use super::stated;
use super::violation::{Condition, Violation};
use crate::mesh::{BoundaryCondition, Domain};

/// Error allowed in boundary conditions, relative to the scales of value and flux.
const EXACT: f64 = 1e-8;
/// Distance from which the limit at the boundary is taken, relative to the shortest side.
const CLOSE: f64 = 1e-9;
/// Change of the gradient over that distance that counts as a jump, between that of a square root and
/// that across a branch cut.
const JUMP: f64 = 1e-3;

/// Boundary data are those of the solution, and contact sides satisfy the Signorini conditions.
pub(super) fn check<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    domain: &Domain<D>,
    samples: usize,
) -> Result<(), Violation> {
    for point in boundary(domain, samples) {
        check_limit(evaluator, &point)?;
        check_at(evaluator, &point, EXACT)?;
    }
    Ok(())
}

/// The condition at a point of the boundary, up to this share of the scales of value and flux.
pub(super) fn check_at<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    &BoundaryPoint { x, normal, condition }: &BoundaryPoint<D>,
    exact: f64,
) -> Result<(), Violation> {
    let (value, flux) = (exact * evaluator.scales.value, exact * evaluator.scales.flux);
    let problem = evaluator.problem;
    let outflow = evaluator.flux(&x).dot(&normal);
    match (condition, &problem.neumann.everywhere, &problem.gap.everywhere) {
        (BoundaryCondition::Dirichlet, _, _) => {
            let error = (problem.dirichlet_at(&x) - evaluator.value(&x)).abs();
            evaluator.require(Condition::Dirichlet, &x, error, value)?;
        }
        (BoundaryCondition::Neumann, Some(q), _) => {
            let error = (q.at(&x, &normal) - outflow).abs();
            evaluator.require(Condition::Neumann, &x, error, flux)?;
        }
        (BoundaryCondition::Contact, _, Some(g)) => {
            let above = evaluator.value(&x) - g.at(&x);
            evaluator.require(Condition::Gap, &x, -above, value)?;
            evaluator.require(Condition::ContactFlux, &x, -outflow, flux)?;
            if above > value {
                evaluator.require(Condition::ContactComplementarity, &x, outflow, flux)?;
            }
            stated::check_on_boundary(evaluator, &x, above, outflow)?;
        }
        _ => {}
    }
    Ok(())
}

/// Value and gradient do not change abruptly between the boundary, a point just inside and points
/// that rounding makes of one on the boundary.
fn check_limit<const D: usize>(
    evaluator: &Evaluator<'_, D>,
    point: &BoundaryPoint<D>,
) -> Result<(), Violation> {
    let length = evaluator.scales.length;
    let (value, gradient) = (evaluator.value(&point.x), evaluator.gradient(&point.x));
    let inside = point.x - point.normal * (CLOSE * length);
    for y in point.rounded(length).into_iter().chain([inside]) {
        let jump = (evaluator.value(&y) - value)
            .abs()
            .max(length * (evaluator.gradient(&y) - gradient).norm());
        evaluator.require(
            Condition::BoundaryLimit,
            &y,
            jump,
            JUMP * length * evaluator.scales.slope,
        )?;
    }
    Ok(())
}
