//! Solvers by name.

use super::{ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid};
use crate::instances::compiled;
use crate::linear::LinearMethod;
use crate::real::Real;

/// Names of the solvers, with one line each.
pub const SOLVERS: &[(&str, &str)] = &[
    ("active-set", "primal-dual active set, started from coarser levels in conforming P1"),
    (
        "monotone-multigrid",
        "truncated nonsmooth Newton multigrid, not for over-penalty with bounds at vertices",
    ),
    ("interior-point", "predictor-corrector interior point method, with factors"),
];

/// The solver of this name, with a method for the linear systems where it has more than one; `None` if there is none.
pub fn solver_by_name<T: Real>(
    name: &str,
    linear: LinearMethod,
) -> Option<Box<dyn InequalitySolver<T>>> {
    compiled!(
        T: fn(&str, LinearMethod) -> Option<Box<dyn InequalitySolver<T>>>
            = new_solver
    )(name, linear)
}

fn new_solver<T: Real>(name: &str, linear: LinearMethod) -> Option<Box<dyn InequalitySolver<T>>> {
    match name {
        "active-set" => Some(Box::new(ActiveSet::default().linear(linear))),
        "monotone-multigrid" => Some(Box::new(MonotoneMultigrid::default())),
        "interior-point" => Some(Box::new(InteriorPoint)),
        _ => None,
    }
}
