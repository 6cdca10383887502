//! Values that another program found, with certificate, errors and totals.

use super::iteration::NestedIteration;
use super::solved::Solved;
use super::system::System;
use crate::error::Error;
use crate::inequality::{Outcome, Solution, contact_of};
use crate::instances::compiled;
use crate::scheme::Scheme;

impl<'a, const D: usize> NestedIteration<'a, D> {
    /// The result on a mesh, by its position, for values that another program found for the inequality: certificate,
    /// errors and totals. Its outcome is `converged` if the certificate is within its limits, else `not-a-solution`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such mesh, another number of values than of unknowns, or a value
    /// that is not finite, and those of assembly.
    pub fn judge_on(
        &self,
        position: usize,
        scheme: &dyn Scheme<D>,
        values: &[f64],
    ) -> Result<Solved<'a, D>, Error> {
        self.check_position(position)?;
        compiled!(const D: for<'n, 'p, 's, 'v> fn(
                &'n NestedIteration<'p, D>,
                usize,
                &'s dyn Scheme<D>,
                &'v [f64],
            ) -> Result<Solved<'p, D>, Error>
                = |nested, position, scheme, values| nested.judge_values(position, scheme, values)
        )(self, position, scheme, values)
    }
    /// As [`Self::judge_on`] for values to which other constants are to be added than to those of this
    /// [discretisation](crate::assemble::Discretisation::constants); an empty list stands for zeros.
    ///
    /// # Errors
    /// Those of [`Self::judge_on`], and [`Error::Parameter`] for another number of constants.
    pub(crate) fn judge_beside(
        &self,
        position: usize,
        scheme: &dyn Scheme<D>,
        (values, constants): (&[f64], &[f64]),
    ) -> Result<Solved<'a, D>, Error> {
        let system = System::new(scheme, self.p1.problem, self.p1.place(position)?)?;
        let own = system.discretisation().constants();
        if !constants.is_empty() && constants.len() != values.len() {
            let allowed = format!("{}, that of the values", values.len());
            return Err(Error::parameter("number of constants", constants.len(), allowed));
        }
        let at = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
        let moved = |(i, value): (usize, &f64)| value + (at(constants, i) - at(&own, i));
        let values: Vec<f64> = values.iter().enumerate().map(moved).collect();
        self.judge_on(position, scheme, &values)
    }
    fn judge_values(
        &self,
        position: usize,
        scheme: &dyn Scheme<D>,
        values: &[f64],
    ) -> Result<Solved<'a, D>, Error> {
        let system = System::new(scheme, self.p1.problem, self.p1.place(position)?)?;
        let inequality = system.inequality();
        if values.len() != inequality.size() {
            let allowed =
                format!("{} has {} unknowns on this mesh", scheme.name(), inequality.size());
            return Err(Error::parameter("number of values", values.len(), allowed));
        }
        if let Some(k) = values.iter().position(|x| !(*x).is_finite()) {
            let value = format!("{} at position {k}, from zero", values[k]);
            return Err(Error::parameter("values", value, "finite numbers"));
        }
        let contact = contact_of(inequality, values);
        let mut solution =
            Solution::new(values.to_vec(), contact, Outcome::Converged).linear_solver("none");
        solution.precision = self.p1.solver.precision();
        let hierarchy = self.hierarchy().map(|hierarchy| (hierarchy, position));
        let mut solved = Solved::new(system, solution, hierarchy);
        if solved.outcome() == Outcome::Stalled {
            solved.solution.outcome = Outcome::NotASolution;
        }
        Ok(solved)
    }
}
