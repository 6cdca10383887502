//! Values that another program found, with certificate, errors and totals.

use super::iteration::NestedIteration;
use super::solved::Solved;
use super::system::System;
use crate::error::Error;
use crate::inequality::{Outcome, Solution};
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
        self.judge_beside(position, scheme, (values, None))
    }
    /// As [`Self::judge_on`] for values less constants: those that are given, an empty list for zeros, else those of the
    /// [discretisation](crate::assemble::Discretisation::constants).
    ///
    /// # Errors
    /// Those of [`Self::judge_on`], and [`Error::Parameter`] for another number of constants.
    pub(crate) fn judge_beside(
        &self,
        position: usize,
        scheme: &dyn Scheme<D>,
        values: (&[f64], Option<&[f64]>),
    ) -> Result<Solved<'a, D>, Error> {
        self.check_position(position)?;
        compiled!(const D: for<'n, 'p, 's, 'v> fn(
                &'n NestedIteration<'p, D>,
                usize,
                &'s dyn Scheme<D>,
                (&'v [f64], Option<&'v [f64]>),
            ) -> Result<Solved<'p, D>, Error>
                = |nested, position, scheme, values| nested.judge_values(position, scheme, values)
        )(self, position, scheme, values)
    }
    fn judge_values(
        &self,
        position: usize,
        scheme: &dyn Scheme<D>,
        (values, constants): (&[f64], Option<&[f64]>),
    ) -> Result<Solved<'a, D>, Error> {
        let mut system = System::new(scheme, self.p1.problem, self.p1.place(position)?)?;
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
        if let Some(n) = constants.map(<[f64]>::len).filter(|&n| n > 0 && n != values.len()) {
            let allowed = format!("{}, that of the values", values.len());
            return Err(Error::parameter("number of constants", n, allowed));
        }
        let values = match constants {
            Some(constants) => system.with_own_constants(values, constants),
            None => values.to_vec(),
        };
        system.inequality.turn_to(&values);
        let inequality = system.inequality();
        let solution = Solution::of_values(inequality, values, Vec::new(), Outcome::Converged);
        let mut solution = solution.linear_solver("none");
        solution.precision = self.p1.solver.precision();
        let hierarchy = self.hierarchy().map(|hierarchy| (hierarchy, position));
        let mut solved = Solved::new(system, solution, hierarchy);
        if solved.outcome() == Outcome::Stalled {
            solved.solution.outcome = Outcome::NotASolution;
        }
        Ok(solved)
    }
}
