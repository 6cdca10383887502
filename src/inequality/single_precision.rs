//! A solve in single precision of an inequality in double precision.

use super::{InequalitySolver, InitialGuess, Outcome, Solution};
use crate::algebra::{Inequality, any_part};
use crate::real::Precision;

/// A solver in `f32` for inequalities in `f64`, which shows what rounding does to the solve.
///
/// The inequality, its coarse spaces and the initial guess are rounded once, entry by entry; the values and the jump
/// multipliers of the solution are widened exactly. All rounding errors but those of the data are the solver's. Data
/// that `f32` does not hold have the outcome [`Outcome::OutOfRange`].
///
/// ```
/// use unilateral::inequality::{ActiveSet, SinglePrecision};
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = Hierarchy::<2>::of_domain(&scene.domain, 8)?;
/// let mut nested = NestedIteration::new(&scene.problem, &meshes)
///     .solver(SinglePrecision::new(ActiveSet::default()));
/// let u = nested.solve(&ConformingP1)?;
/// assert!(u.converged() && u.certificate().largest() > 1e-12);
/// # Ok(())
/// # }
/// ```
pub struct SinglePrecision<'a> {
    solver: Box<dyn InequalitySolver<f32> + 'a>,
}

impl<'a> SinglePrecision<'a> {
    /// A solver in single precision.
    #[must_use]
    pub fn new(solver: impl InequalitySolver<f32> + 'a) -> Self {
        Self { solver: Box::new(solver) }
    }
}

impl InequalitySolver<f64> for SinglePrecision<'_> {
    fn name(&self) -> &'static str {
        self.solver.name()
    }
    fn precision(&self) -> Precision {
        Precision::Single
    }
    fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
        self.solve_from(inequality, &InitialGuess::default())
    }
    fn solve_from(&self, inequality: &Inequality<f64>, guess: &InitialGuess<f64>) -> Solution<f64> {
        // collective: every part calls both
        let of_parts = inequality.distribution();
        let is_malformed = any_part(of_parts, !inequality.is_well_formed());
        let is_out_of_range = any_part(of_parts, !inequality.is_in_range_of::<f32>());
        if is_malformed || is_out_of_range {
            let outcome = if is_malformed { Outcome::Malformed } else { Outcome::OutOfRange };
            let mut none = Solution::without_iterate(inequality, outcome);
            none.precision = Precision::Single;
            return none;
        }
        self.solver.solve_from(&inequality.in_precision(), &guess.in_precision()).widened()
    }
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        self.solver.uses_coarse_spaces(unknowns)
    }
}

/// A solver of inequalities in `f64` that computes in a precision.
pub fn in_precision<'a>(
    precision: Precision,
    solver: impl InequalitySolver<f64> + InequalitySolver<f32> + 'a,
) -> Box<dyn InequalitySolver<f64> + 'a> {
    match precision {
        Precision::Double => Box::new(solver),
        Precision::Single => Box::new(SinglePrecision::new(solver)),
    }
}
