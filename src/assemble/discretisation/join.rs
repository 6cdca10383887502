//! Element, facet form, problem and mesh made into a discretisation, if they fit.

use std::sync::{Arc, OnceLock};

use super::Discretisation;
use crate::assemble::data_quadrature::DataQuadrature;
use crate::assemble::local::MAX_FLUX_MOMENTS;
use crate::assemble::shared_rows::SharedRows;
use crate::assemble::space::Space;
use crate::element::{Element, MAX_BASIS};
use crate::error::Error;
use crate::facet::{DirichletBy, FacetForm};
use crate::mesh::Mesh;
use crate::problem::Problem;

impl<'a, const D: usize> Discretisation<'a, D> {
    /// Joins an element and a facet form with a problem and a mesh; builds facets only if they are
    /// needed.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::NothingToBound`], [`Error::UnsupportedForm`],
    /// [`Error::Parameter`] for a penalty factor that makes no penalty.
    pub(crate) fn of(
        (element, form, dirichlet): (Arc<dyn Element<D>>, Box<dyn FacetForm<D>>, DirichletBy),
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        check_fit(&*element, &*form)?;
        let pins = matches!(dirichlet, DirichletBy::Pinning);
        let space = Space::new(element, problem, mesh, quadrature, form.couples(), pins)?;
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

/// Refuses elements and forms that the loops over cells have no tables for.
fn check_fit<const D: usize>(
    element: &dyn Element<D>,
    form: &dyn FacetForm<D>,
) -> Result<(), Error> {
    let refuse = |requested, allowed| Err(Error::UnsupportedForm { requested, allowed });
    if element.per_cell() > MAX_BASIS {
        return refuse("matrices of cells", "elements with at most 20 unknowns in a cell");
    }
    let owns_rows = form.couples() && element.layout().is_broken();
    if form.is_lifted() && !(owns_rows && element.basis_degree() <= 2) {
        return refuse("lifts of jumps", "broken elements of degree one and two");
    }
    if owns_rows
        && form.uses_flux()
        && polynomials(D - 1, element.basis_degree() - 1) > MAX_FLUX_MOMENTS
    {
        return refuse(
            "fluxes",
            "broken elements with basis functions of degree at most 10 in the plane and 4 in space",
        );
    }
    Ok(())
}
