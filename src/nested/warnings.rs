//! What a solve warns of.

use crate::constraint::CellMeans;
use crate::inequality::{Outcome, Solution};
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::AnyScheme;

/// More outer steps than a solve takes on any scene but with bounds at nodes of broken quadratics.
const MANY_ACTIVE_SETS: usize = 28;

/// Edges shorter than a limit, on meshes that were not refined locally: conditions of matrices on bisected meshes depend on
/// the number of cells, but for a logarithm not on the smallest one (R. E. Bank, L. R. Scott, SIAM J. Numer. Anal. 26
/// (1989), 1383-1394).
pub(super) fn short_edges<T: Real, const D: usize>(
    mesh: &Mesh<T, D>,
    limit: f64,
) -> Option<String> {
    let shortest = mesh.shortest_edge();
    (shortest < limit).then(|| {
        format!(
            "edges of length {shortest:.1e} are below {limit:.1e}, where rounding in {} may outweigh the discretisation error",
            T::NAME
        )
    })
}

/// What helps a solution that took many active sets, or whose active sets changed to the end.
pub(super) fn active_sets<T: Real, const D: usize>(
    solution: &Solution<T>,
    problem: &Problem<D>,
    scheme: &dyn AnyScheme<T, D>,
) -> Option<String> {
    let returns =
        matches!(solution.outcome, Outcome::IterationLimit | Outcome::Cycling | Outcome::Stalled);
    let are_many = solution.outer > MANY_ACTIVE_SETS || returns;
    are_many.then(|| advice_on_bounds(problem, scheme)).flatten()
}

/// What helps a scheme whose obstacle takes many active sets: bounds on cell means, where its element has
/// them and nothing else is bound.
fn advice_on_bounds<T: Real, const D: usize>(
    problem: &Problem<D>,
    scheme: &dyn AnyScheme<T, D>,
) -> Option<String> {
    let set = problem.constraint_set();
    let present = scheme.constraint_on(set)?;
    let means = scheme.constraint_on(&CellMeans)?;
    (problem.has_obstacle() && !problem.has_gap() && present != means).then(|| {
        format!("bounds at {present} take many active sets with quadratics: bounds on {means} take fewer")
    })
}
