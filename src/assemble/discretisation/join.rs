//! Element, facet form, problem and mesh made into a discretisation, if they fit.

use std::sync::OnceLock;

use super::Discretisation;
use crate::assemble::chosen_element::ChosenElement;
use crate::assemble::data_quadrature::DataQuadrature;
use crate::assemble::local::MAX_FLUX_MOMENTS;
use crate::assemble::shared_rows::SharedRows;
use crate::assemble::space::{AnyElement, Space};
use crate::element::ReferenceElement;
use crate::error::Error;
use crate::facet::{DirichletBy, FacetForm};
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::problem::Problem;

impl<'a, const D: usize> Discretisation<'a, D> {
    /// Joins an element and a facet form with a problem and a mesh; builds facets only if they are
    /// needed.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::NothingToBound`], [`Error::UnsupportedForm`],
    /// [`Error::Parameter`] for a penalty factor that makes no penalty.
    pub(crate) fn of<E: ReferenceElement<D>>(
        form: Box<dyn FacetForm<D>>,
        dirichlet: DirichletBy,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let pins = matches!(dirichlet, DirichletBy::Pinning);
        let element = ChosenElement::of::<E>(problem.constraint_set());
        let parts = Parts { element, form, pins };
        compiled!(const D: for<'p> fn(
                Parts<D>,
                &'p Problem<D>,
                &'p Mesh<D>,
                DataQuadrature,
            ) -> Result<Discretisation<'p, D>, Error>
                = |parts, problem, mesh, quadrature| parts.join(problem, mesh, quadrature)
        )(parts, problem, mesh, quadrature)
    }
}

/// What a scheme brings to a discretisation.
struct Parts<const D: usize> {
    element: ChosenElement<D>,
    form: Box<dyn FacetForm<D>>,
    /// Whether Dirichlet data are pinned.
    pins: bool,
}

impl<const D: usize> Parts<D> {
    fn join<'a>(
        self,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Discretisation<'a, D>, Error> {
        let Self { element: ChosenElement { element, offered }, form, pins } = self;
        check_form::<D>(&element, &*form)?;
        let space = Space::new(element, problem, mesh, quadrature, form.couples(), pins, offered)?;
        space.check_penalty_factor(&*form)?;
        Ok(Discretisation {
            space,
            form,
            shared_rows: SharedRows::default(),
            prepared: OnceLock::new(),
            contradictions: OnceLock::new(),
        })
    }
}

/// The number of polynomials of a degree in some variables that are linearly independent.
fn polynomials(variables: usize, degree: usize) -> usize {
    (1..=variables).fold(1, |count, k| count * (degree + k) / k)
}

/// Refuses forms that the loops over owned rows have no tables for.
fn check_form<const D: usize>(element: &AnyElement, form: &dyn FacetForm<D>) -> Result<(), Error> {
    let refuse = |requested, allowed| Err(Error::UnsupportedForm { requested, allowed });
    let owns_rows = form.couples() && element.layout.is_broken();
    if form.is_lifted() && !(owns_rows && element.basis_degree <= 2) {
        return refuse("lifts of jumps", "broken elements of degree one and two");
    }
    if owns_rows
        && form.uses_flux()
        && polynomials(D - 1, element.basis_degree - 1) > MAX_FLUX_MOMENTS
    {
        return refuse(
            "fluxes",
            "broken elements with basis functions of degree at most 10 in the plane and 4 in space",
        );
    }
    Ok(())
}
