//! Conditions on the sides of the domain.

use super::probe::Probe;
use super::samples::{BoundaryPoint, boundary};
use super::{Condition, Violation, stated};
use crate::mesh::BoundaryPart;

/// Error allowed in boundary conditions, relative to the scales of value and flux.
const EXACT: f64 = 1e-8;
/// Distance from which the limit at the boundary is taken, relative to the shortest side.
const CLOSE: f64 = 1e-9;
/// Change of the gradient over that distance that counts as a jump; a branch cut exceeds it, a
/// square root does not.
const JUMP: f64 = 1e-3;

/// Boundary data are those of the solution, and contact sides fulfil the Signorini conditions.
pub(super) fn check<const D: usize>(probe: &Probe<'_, D>, samples: usize) -> Result<(), Violation> {
    let (value, flux) = (EXACT * probe.scales.value, EXACT * probe.scales.flux);
    let problem = &probe.scene.problem;
    for point in boundary(&probe.scene.domain, samples) {
        check_limit(probe, &point)?;
        let BoundaryPoint { x, normal, part } = point;
        let outflow = probe.flux(&x).dot(&normal);
        match (part, &problem.neumann, &problem.gap) {
            (BoundaryPart::Dirichlet, _, _) => {
                let error = (problem.dirichlet_at(&x) - probe.value(&x)).abs();
                probe.require(Condition::Dirichlet, &x, error, value)?;
            }
            (BoundaryPart::Neumann, Some(q), _) => {
                let error = (q(&x, &normal) - outflow).abs();
                probe.require(Condition::Neumann, &x, error, flux)?;
            }
            (BoundaryPart::Contact, _, Some(g)) => {
                let above = probe.value(&x) - g(&x);
                probe.require(Condition::Gap, &x, -above, value)?;
                probe.require(Condition::ContactFlux, &x, -outflow, flux)?;
                if above > value {
                    probe.require(Condition::ContactComplementarity, &x, outflow, flux)?;
                }
                stated::check_on_boundary(probe, &x, above, outflow)?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Value and gradient do not change abruptly between the boundary, a point just inside and points
/// that rounding makes of one on the boundary.
fn check_limit<const D: usize>(
    probe: &Probe<'_, D>,
    point: &BoundaryPoint<D>,
) -> Result<(), Violation> {
    let length = probe.scales.length;
    let (value, gradient) = (probe.value(&point.x), probe.gradient(&point.x));
    let inside = point.x - point.normal * (CLOSE * length);
    for y in point.rounded(length).into_iter().chain([inside]) {
        let jump =
            (probe.value(&y) - value).abs().max(length * (probe.gradient(&y) - gradient).norm());
        probe.require(Condition::BoundaryLimit, &y, jump, JUMP * length * probe.scales.slope)?;
    }
    Ok(())
}
