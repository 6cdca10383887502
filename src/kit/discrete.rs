//! The discrete inequalities and solutions that the laws ask of a scheme.

use std::ops::Deref;
use std::sync::Arc;

use super::error::{Fault, KitErrorKind};
use super::meshes::Sample;
use crate::algebra::Inequality;
use crate::assemble::DataQuadrature;
use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, Outcome};
use crate::measure::Errors;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::scheme::Scheme;

/// A scheme under test with its constraint set.
pub(super) struct Tested<'s, const D: usize> {
    pub scheme: &'s dyn Scheme<D>,
    pub set: Arc<dyn ConstraintSet>,
}

impl<'s, const D: usize> Tested<'s, D> {
    /// The problem with the constraint set.
    fn problem(&self, problem: &Problem<D>) -> Problem<D> {
        problem.clone().on(self.set.clone())
    }
}

impl<'s, const D: usize> Deref for Tested<'s, D> {
    type Target = dyn Scheme<D> + 's;

    fn deref(&self) -> &Self::Target {
        self.scheme
    }
}

/// Rules for data: what a source that belongs to a polynomial of the element's degree needs, and
/// what keeps the quadrature of a smooth one out of the orders.
fn quadrature(degree: usize) -> DataQuadrature {
    DataQuadrature::default().cell((2 * degree + 2).max(5))
}

/// The inequality of a problem on a mesh.
pub(super) fn assemble<const D: usize>(
    scheme: &Tested<'_, D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Result<Inequality<f64>, Error> {
    scheme.inequality(&scheme.problem(problem), mesh, quadrature(scheme.degree()))
}

/// The solution of a linear problem.
pub(super) fn solve<const D: usize>(
    inequality: &Inequality<f64>,
    sample: &Sample<D>,
) -> Result<Vec<f64>, Fault> {
    let solution = ActiveSet::default().solve(inequality);
    match solution.outcome {
        Outcome::Converged => Ok(solution.values),
        outcome => {
            let message = format!("the linear problem on {} ended as {outcome}", sample.name);
            Err(Fault::new(KitErrorKind::NotSolved, message))
        }
    }
}

/// The errors of the discrete solution of a linear problem, and this solution at the vertices of each cell.
pub(super) fn solve_and_judge<const D: usize>(
    scheme: &Tested<'_, D>,
    problem: &Problem<D>,
    sample: &Sample<D>,
) -> Result<(Errors, Vec<f64>), Fault> {
    let inequality = assemble(scheme, problem, &sample.mesh)?;
    let u = solve(&inequality, sample)?;
    let problem = scheme.problem(problem);
    let quadrature = quadrature(scheme.degree());
    let discretisation = scheme.discretise(&problem, &sample.mesh, quadrature)?;
    Ok((discretisation.errors(&u)?, discretisation.vertex_values(&u)))
}
