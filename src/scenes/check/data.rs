//! Conditions on the data alone, with or without an exact solution.

use super::samples::{BoundaryPoint, boundary, lattice};
use super::violation::Violation;
use crate::mesh::BoundaryCondition;
use crate::real::Point;
use crate::scenes::scene::Scene;

impl<const D: usize> Scene<D> {
    /// Data finite, coefficient and reaction of the right sign, bounds in order, gap present.
    pub(super) fn check_data(&self, inside: &[Point<D>], samples: usize) -> Result<(), Violation> {
        let domain = &self.domain;
        for x in inside.iter().copied().chain(lattice(domain)) {
            self.check_data_at(&x)?;
        }
        for BoundaryPoint { x, normal, condition } in boundary(domain, samples) {
            self.check_data_at(&x)?;
            match condition {
                BoundaryCondition::Dirichlet => self.check_dirichlet(&x)?,
                BoundaryCondition::Contact if !self.problem.has_gap() => {
                    return Err(Violation::new(
                        &self.name,
                        "a gap for the contact side",
                        &x,
                        f64::NAN,
                        0.0,
                    ));
                }
                BoundaryCondition::Neumann => {
                    if let Some(q) = &self.problem.neumann.everywhere {
                        self.finite("neumann", &x, q.at(&x, &normal))?;
                    }
                }
                BoundaryCondition::Contact => {}
            }
        }
        Ok(())
    }

    fn finite(&self, datum: &'static str, x: &Point<D>, value: f64) -> Result<(), Violation> {
        if value.is_finite() {
            return Ok(());
        }
        Err(Violation::new(&self.name, &format!("{datum} finite"), x, value, 0.0))
    }

    fn check_data_at(&self, x: &Point<D>) -> Result<(), Violation> {
        let problem = &self.problem;
        for (name, datum) in [
            ("coefficient", &problem.coefficient),
            ("lower obstacle", &problem.lower),
            ("upper obstacle", &problem.upper),
            ("gap", &problem.gap),
            ("source", &problem.source),
            ("reaction", &problem.reaction),
        ] {
            if let Some(datum) = &datum.everywhere {
                self.finite(name, x, datum.at(x))?;
            }
        }
        if let Some(exact) = &problem.exact {
            self.finite("solution", x, exact.value.at(x))?;
            for &component in &(exact.gradient)(x) {
                self.finite("gradient", x, component)?;
            }
        }
        let alpha = problem.coefficient.everywhere.as_ref().map_or(1.0, |alpha| alpha.at(x));
        let reaction = problem.reaction.everywhere.as_ref().map_or(0.0, |c| c.at(x));
        for (value, passes) in [(alpha, alpha > 0.0), (reaction, reaction >= 0.0)] {
            if !passes {
                return Err(Violation::new(
                    &self.name,
                    "coefficient positive and reaction not negative",
                    x,
                    value,
                    0.0,
                ));
            }
        }
        let (lower, upper) = self.bounds(x);
        self.in_order(x, lower, upper)
    }

    fn check_dirichlet(&self, x: &Point<D>) -> Result<(), Violation> {
        let datum = self.problem.dirichlet_at(x);
        self.finite("dirichlet", x, datum)?;
        let (lower, upper) = self.bounds(x);
        self.in_order(x, lower, datum)?;
        self.in_order(x, datum, upper)
    }

    fn bounds(&self, x: &Point<D>) -> (f64, f64) {
        let (lower, upper) = (&self.problem.lower.everywhere, &self.problem.upper.everywhere);
        let lower = lower.as_ref().map_or(f64::NEG_INFINITY, |psi| psi.at(x));
        (lower, upper.as_ref().map_or(f64::INFINITY, |psi| psi.at(x)))
    }

    /// `a <= b` up to rounding of the larger.
    fn in_order(&self, x: &Point<D>, a: f64, b: f64) -> Result<(), Violation> {
        let allowed = 1e-12 * a.abs().max(b.abs());
        if a <= b || a - b <= allowed {
            return Ok(());
        }
        Err(Violation::new(
            &self.name,
            "bounds in order and Dirichlet data between them",
            x,
            a - b,
            allowed,
        ))
    }
}
