//! A scheme without its type, so that each law is compiled once for a scalar and a dimension.

use super::error::{KitError, Law};
use super::meshes::Sample;
use crate::algebra::Inequality;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::element::ReferenceElement;
use crate::error::Error;
use crate::facet::FacetForm;
use crate::inequality::{ActiveSet, InequalitySolver, Outcome};
use crate::measure::Errors;
use crate::mesh::{BoxDomain, Mesh};
use crate::problem::Problem;
use crate::real::{Point, Real};
use crate::scheme::{ExpectedOrders, Regularity, Scheme, Setting};

/// A discrete solution against the exact one.
pub(super) struct Judged {
    pub errors: Errors,
    /// The discrete solution at the vertices of each cell.
    pub vertex_values: Vec<f64>,
}

/// What the laws ask of a scheme.
pub(super) trait Tested<T: Real, const D: usize> {
    fn name(&self) -> &str;
    fn degree(&self) -> usize;
    fn is_consistent(&self) -> bool;
    fn is_symmetric(&self) -> bool;
    /// The orders that the scheme promises for a smooth solution without inequalities.
    fn promised(&self) -> ExpectedOrders;
    fn assemble(&self, problem: &Problem<D>, mesh: &Mesh<T, D>) -> Result<Inequality<T>, Error>;
    fn judge(&self, problem: &Problem<D>, mesh: &Mesh<T, D>, u: &[T]) -> Result<Judged, Error>;
}

/// A scheme to be tested.
pub(super) struct Of<'a, S>(pub &'a S);

/// Rules for data: what a source that belongs to a polynomial of the element's degree needs, and
/// what keeps the quadrature of a smooth one out of the orders.
fn quadrature(degree: usize) -> DataQuadrature {
    let default = DataQuadrature::default();
    DataQuadrature { cell: default.cell.max(2 * degree + 2), ..default }
}

impl<T: Real, const D: usize, S: Scheme<T, D>> Tested<T, D> for Of<'_, S> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn degree(&self) -> usize {
        <S::Element as ReferenceElement<T, D>>::DEGREE
    }
    fn is_consistent(&self) -> bool {
        S::CONSISTENT
    }
    fn is_symmetric(&self) -> bool {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mesh = Mesh::kuhn_box(&domain, [1; D]);
        mesh.is_ok_and(|mesh| self.0.facet(&mesh).is_symmetric())
    }
    fn promised(&self) -> ExpectedOrders {
        let regularity = Regularity { sobolev: f64::INFINITY, strictly_complementary: true };
        let setting = Setting {
            dimension: D,
            obstacle: false,
            contact: false,
            regularity,
            regular_dual: true,
        };
        self.0.expected_orders(&setting)
    }
    fn assemble(&self, problem: &Problem<D>, mesh: &Mesh<T, D>) -> Result<Inequality<T>, Error> {
        let quadrature = quadrature(Tested::<T, D>::degree(self));
        Discretisation::new(self.0, problem, mesh, quadrature)?.inequality()
    }
    fn judge(&self, problem: &Problem<D>, mesh: &Mesh<T, D>, u: &[T]) -> Result<Judged, Error> {
        let quadrature = quadrature(Tested::<T, D>::degree(self));
        let discretisation = Discretisation::new(self.0, problem, mesh, quadrature)?;
        let errors = discretisation.errors(u)?;
        Ok(Judged { errors, vertex_values: discretisation.vertex_values(u) })
    }
}

/// The inequality of a problem on a mesh.
pub(super) fn assemble<T: Real, const D: usize>(
    law: Law,
    scheme: &dyn Tested<T, D>,
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
) -> Result<Inequality<T>, KitError> {
    scheme.assemble(problem, mesh).map_err(|why| KitError::NotAssembled { law, why })
}

/// The solution of a linear problem.
pub(super) fn solve<T: Real, const D: usize>(
    law: Law,
    inequality: &Inequality<T>,
    sample: &Sample<T, D>,
) -> Result<Vec<T>, KitError> {
    let solution = ActiveSet::default().solve(inequality);
    match solution.outcome {
        Outcome::Converged => Ok(solution.values),
        outcome => Err(KitError::NotSolved { law, mesh: sample.name.to_owned(), outcome }),
    }
}

/// The discrete solution of a linear problem against the exact one.
pub(super) fn solve_and_judge<T: Real, const D: usize>(
    law: Law,
    scheme: &dyn Tested<T, D>,
    problem: &Problem<D>,
    sample: &Sample<T, D>,
) -> Result<Judged, KitError> {
    let inequality = assemble(law, scheme, problem, &sample.mesh)?;
    let u = solve(law, &inequality, sample)?;
    scheme.judge(problem, &sample.mesh, &u).map_err(|why| KitError::NotAssembled { law, why })
}
