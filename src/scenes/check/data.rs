//! Conditions on the data alone, with or without an exact solution.

use super::samples::{BoundaryPoint, boundary, lattice};
use super::violation::{Condition, Violation};
use crate::mesh::BoundaryCondition;
use crate::real::Point;
use crate::scenes::scene::Scene;

/// Data finite, coefficient and reaction of the right sign, bounds in order, gap present.
pub(super) fn check<const D: usize>(
    scene: &Scene<D>,
    inside: &[Point<D>],
    samples: usize,
) -> Result<(), Violation> {
    let domain = &scene.domain;
    for x in inside.iter().copied().chain(lattice(domain)) {
        check_at(scene, &x)?;
    }
    for BoundaryPoint { x, normal, condition } in boundary(domain, samples) {
        check_at(scene, &x)?;
        match condition {
            BoundaryCondition::Dirichlet => check_dirichlet(scene, &x)?,
            BoundaryCondition::Contact if !scene.problem.has_gap() => {
                return Err(Violation::new(&scene.name, Condition::GapGiven, &x, f64::NAN, 0.0));
            }
            BoundaryCondition::Neumann => {
                if let Some(q) = &scene.problem.neumann.everywhere {
                    finite(scene, "neumann", &x, q.at(&x, &normal))?;
                }
            }
            BoundaryCondition::Contact => {}
        }
    }
    Ok(())
}

fn finite<const D: usize>(
    scene: &Scene<D>,
    datum: &'static str,
    x: &Point<D>,
    value: f64,
) -> Result<(), Violation> {
    if value.is_finite() {
        return Ok(());
    }
    Err(Violation::new(&scene.name, Condition::Finite(datum), x, value, 0.0))
}

fn check_at<const D: usize>(scene: &Scene<D>, x: &Point<D>) -> Result<(), Violation> {
    let problem = &scene.problem;
    for (name, datum) in [
        ("coefficient", &problem.coefficient),
        ("lower obstacle", &problem.lower),
        ("upper obstacle", &problem.upper),
        ("gap", &problem.gap),
        ("source", &problem.source),
        ("reaction", &problem.reaction),
    ] {
        if let Some(datum) = &datum.everywhere {
            finite(scene, name, x, datum.at(x))?;
        }
    }
    if let Some(exact) = &problem.exact {
        finite(scene, "solution", x, exact.value.at(x))?;
        for &component in &(exact.gradient)(x) {
            finite(scene, "gradient", x, component)?;
        }
    }
    let alpha = problem.coefficient.everywhere.as_ref().map_or(1.0, |alpha| alpha.at(x));
    let reaction = problem.reaction.everywhere.as_ref().map_or(0.0, |c| c.at(x));
    for (value, passes) in [(alpha, alpha > 0.0), (reaction, reaction >= 0.0)] {
        if !passes {
            return Err(Violation::new(&scene.name, Condition::Ellipticity, x, value, 0.0));
        }
    }
    let (lower, upper) = bounds(scene, x);
    in_order(scene, x, lower, upper)
}

fn check_dirichlet<const D: usize>(scene: &Scene<D>, x: &Point<D>) -> Result<(), Violation> {
    let datum = scene.problem.dirichlet_at(x);
    finite(scene, "dirichlet", x, datum)?;
    let (lower, upper) = bounds(scene, x);
    in_order(scene, x, lower, datum)?;
    in_order(scene, x, datum, upper)
}

fn bounds<const D: usize>(scene: &Scene<D>, x: &Point<D>) -> (f64, f64) {
    let lower = scene.problem.lower.everywhere.as_ref().map_or(f64::NEG_INFINITY, |psi| psi.at(x));
    let upper = scene.problem.upper.everywhere.as_ref().map_or(f64::INFINITY, |psi| psi.at(x));
    (lower, upper)
}

/// `a <= b` up to rounding of the larger.
fn in_order<const D: usize>(
    scene: &Scene<D>,
    x: &Point<D>,
    a: f64,
    b: f64,
) -> Result<(), Violation> {
    if a <= b {
        return Ok(());
    }
    let allowed = 1e-12 * a.abs().max(b.abs());
    if a - b <= allowed {
        return Ok(());
    }
    Err(Violation::new(&scene.name, Condition::Admissible, x, a - b, allowed))
}
