//! Solvers by name.

use super::{ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid, in_precision};
use crate::linear::LinearMethod;
use crate::real::Precision;

/// The options of the solvers that [`solver_by_name`] returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SolverOptions {
    /// The method for the linear systems, in solvers that have more than one.
    pub linear: LinearMethod,
    /// The precision in which the solver computes.
    pub precision: Precision,
}

impl SolverOptions {
    /// Sets the method for the linear systems.
    #[must_use]
    pub fn linear(mut self, linear: LinearMethod) -> Self {
        self.linear = linear;
        self
    }
    /// Sets the precision in which the solver computes.
    #[must_use]
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }
}

/// Defines [`SOLVERS`] and [`solver_by_name`] from one list of names, summaries and constructors.
macro_rules! solvers_by_name {
    ($options:ident: $($name:literal, $summary:literal => $solver:expr;)*) => {
        /// Names of the solvers, with one line each.
        pub const SOLVERS: &[(&str, &str)] = &[$(($name, $summary)),*];

        /// The solver of this name; `None` if there is none.
        pub fn solver_by_name(
            name: &str,
            $options: &SolverOptions,
        ) -> Option<Box<dyn InequalitySolver<f64>>> {
            match name {
                $($name => Some(in_precision($options.precision, $solver)),)*
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
