//! Solvers by name.

use super::{
    ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid, ProximalPoint, in_precision,
};
use crate::linear::LinearMethod;
use crate::real::Precision;

/// Names of the solvers, with one line each.
pub const SOLVERS: &[(&str, &str)] = &[
    ("active-set", "primal-dual active set, started from coarser levels in conforming P1"),
    (
        "monotone-multigrid",
        "truncated nonsmooth Newton multigrid, not for over-penalty with bounds at vertices",
    ),
    ("interior-point", "predictor-corrector interior point method, with factors"),
    ("proximal", "proximal Galerkin: latent variables, one system a step, with factors"),
];

/// The solver of this name that computes in a precision, with a method for the linear systems where it has more than
/// one; `None` if there is none.
pub fn solver_by_name(
    name: &str,
    linear: LinearMethod,
    precision: Precision,
) -> Option<Box<dyn InequalitySolver<f64>>> {
    match name {
        "active-set" => Some(in_precision(precision, ActiveSet::default().linear(linear))),
        "monotone-multigrid" => Some(in_precision(precision, MonotoneMultigrid::default())),
        "interior-point" => Some(in_precision(precision, InteriorPoint)),
        "proximal" => Some(in_precision(precision, ProximalPoint)),
        _ => None,
    }
}
