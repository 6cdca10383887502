//! Conditions on the sides of the domain.

use super::probe::Probe;
use super::samples::{Side, in_box, sides};
use super::{Condition, Violation};
use crate::mesh::BoundaryPart;
use crate::real::Point;

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
    for side in sides(&probe.scene.domain) {
        for x in in_box(&probe.scene.domain).take(samples) {
            let x = side.project(&x);
            check_limit(probe, &side, &x)?;
            let outflow = probe.flux(&x).dot(&side.normal);
            match (side.part, &problem.neumann, &problem.gap) {
                (BoundaryPart::Dirichlet, _, _) => {
                    let error = (problem.dirichlet_at(&x) - probe.value(&x)).abs();
                    probe.require(Condition::Dirichlet, &x, error, value)?;
                }
                (BoundaryPart::Neumann, Some(q), _) => {
                    let error = (q(&x, &side.normal) - outflow).abs();
                    probe.require(Condition::Neumann, &x, error, flux)?;
                }
                (BoundaryPart::Contact, _, Some(g)) => {
                    let above = probe.value(&x) - g(&x);
                    probe.require(Condition::Gap, &x, -above, value)?;
                    probe.require(Condition::ContactFlux, &x, -outflow, flux)?;
                    if above > value {
                        probe.require(Condition::ContactComplementarity, &x, outflow, flux)?;
                    }
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// Value and gradient do not change abruptly between the boundary, a point just inside and points
/// that rounding makes of one on the boundary.
fn check_limit<const D: usize>(
    probe: &Probe<'_, D>,
    side: &Side<D>,
    x: &Point<f64, D>,
) -> Result<(), Violation> {
    let length = probe.scales.length;
    let (value, gradient) = (probe.value(x), probe.gradient(x));
    let inside = x - side.normal * (CLOSE * length);
    for y in side.rounded(x, length).into_iter().chain([inside]) {
        let jump =
            (probe.value(&y) - value).abs().max(length * (probe.gradient(&y) - gradient).norm());
        probe.require(Condition::BoundaryLimit, &y, jump, JUMP * length * probe.scales.slope)?;
    }
    Ok(())
}
