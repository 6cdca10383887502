//! Solvers by the names that users type.

use super::{ActiveSet, InequalitySolver, MonotoneMultigrid};
use crate::instances::compiled;
use crate::linear::LinearMethod;
use crate::real::Real;

/// What a user may choose about solvers by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SolverOptions {
    /// The linear solver inside solvers that have the choice.
    pub linear: LinearMethod,
}

impl SolverOptions {
    /// Sets the linear solver.
    #[must_use]
    pub fn linear(mut self, linear: LinearMethod) -> Self {
        self.linear = linear;
        self
    }
}

/// Makes of one list the names with their summaries, and the function that finds a solver.
macro_rules! solvers_by_name {
    ($options:ident: $($name:literal, $summary:literal => $solver:expr;)*) => {
        /// Names of the solvers, with one line each.
        pub const SOLVERS: &[(&str, &str)] = &[$(($name, $summary)),*];

        fn made<T: Real>(
            name: &str,
            $options: &SolverOptions,
        ) -> Option<Box<dyn InequalitySolver<T>>> {
            match name {
                $($name => Some(Box::new($solver)),)*
                _ => None,
            }
        }
    };
}

// A solver gets its name by one entry here: name, summary, constructor from the options.
solvers_by_name! { options:
    "active-set", "primal-dual active set, started from coarser levels in conforming P1"
        => ActiveSet::default().linear(options.linear);
    "monotone-multigrid", "truncated nonsmooth Newton multigrid, not for over-penalty with bounds at vertices"
        => MonotoneMultigrid::default();
}

/// The solver of this name.
pub fn solver_by_name<T: Real>(
    name: &str,
    options: &SolverOptions,
) -> Option<Box<dyn InequalitySolver<T>>> {
    compiled!(
        T: fn(&str, &SolverOptions) -> Option<Box<dyn InequalitySolver<T>>>
            = made
    )(name, options)
}
