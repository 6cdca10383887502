//! Solvers by name.

use super::{ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid};
use crate::instances::compiled;
use crate::linear::LinearMethod;
use crate::real::Real;

/// The options of the solvers that [`solver_by_name`] returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SolverOptions {
    /// The method for the linear systems, in solvers that have more than one.
    pub linear: LinearMethod,
}

impl SolverOptions {
    /// Sets the method for the linear systems.
    #[must_use]
    pub fn linear(mut self, linear: LinearMethod) -> Self {
        self.linear = linear;
        self
    }
}

/// Defines [`SOLVERS`] and the function `new_solver` from one list of names, summaries and constructors.
macro_rules! solvers_by_name {
    ($options:ident: $($name:literal, $summary:literal => $solver:expr;)*) => {
        /// Names of the solvers, with one line each.
        pub const SOLVERS: &[(&str, &str)] = &[$(($name, $summary)),*];

        fn new_solver<T: Real>(
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

// one entry for each solver: name, summary, constructor from the options
solvers_by_name! { options:
    "active-set", "primal-dual active set, started from coarser levels in conforming P1"
        => ActiveSet::default().linear(options.linear);
    "monotone-multigrid", "truncated nonsmooth Newton multigrid, not for over-penalty with bounds at vertices"
        => MonotoneMultigrid::default();
    "interior-point", "predictor-corrector interior point method, with factors"
        => InteriorPoint;
}

/// The solver of this name; `None` if there is none.
pub fn solver_by_name<T: Real>(
    name: &str,
    options: &SolverOptions,
) -> Option<Box<dyn InequalitySolver<T>>> {
    compiled!(
        T: fn(&str, &SolverOptions) -> Option<Box<dyn InequalitySolver<T>>>
            = new_solver
    )(name, options)
}
