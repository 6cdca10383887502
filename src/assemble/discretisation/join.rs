//! Element, facet form, problem and mesh made into a discretisation, if they fit.

use std::sync::{Arc, OnceLock};

use super::Discretisation;
use crate::assemble::data_quadrature::DataQuadrature;
use crate::assemble::shared_rows::SharedRows;
use crate::assemble::space::Space;
use crate::assemble::trace::MAX_FLUX_MOMENTS;
use crate::element::{Element, MAX_BASIS};
use crate::error::Error;
use crate::facet::{DirichletBy, FacetForm};
use crate::mesh::Mesh;
use crate::problem::{BodyConstants, Problem};

impl<'a, const D: usize> Discretisation<'a, D> {
    /// As [`Discretisation::new`], from the parts of a scheme: its element, its facet form, and how it imposes Dirichlet
    /// data; and with the constants of bodies.
    pub(crate) fn of(
        (element, form, dirichlet): (Arc<dyn Element<D>>, Box<dyn FacetForm<D>>, DirichletBy),
        data: (&'a Problem<D>, Arc<BodyConstants>),
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        check_fit(&*element, &*form)?;
        check_size(mesh.n_cells(), &*element, &*form)?;
        let pins = matches!(dirichlet, DirichletBy::Pinning);
        let space = Space::new(element, data, mesh, quadrature, form.couples(), pins)?;
        space.check_penalty_factor(&*form)?;
        Ok(Discretisation {
            space,
            form,
            shared_rows: SharedRows::default(),
            prepared: OnceLock::new(),
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
    let refuse = |requested, allowed| {
        Err(Error::UnsupportedForm(format!("{requested} are made for {allowed} only")))
    };
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

/// The most entries that a matrix may have: as many as 32-bit numbers count.
const MOST_ENTRIES: f64 = u32::MAX as f64;

/// A number that the entries of the matrix on so many cells do not exceed: each cell has at most the products of its
/// unknowns with those of the cells that the form couples to it.
fn entries_at_most<const D: usize>(
    n_cells: f64,
    element: &dyn Element<D>,
    form: &dyn FacetForm<D>,
) -> f64 {
    let coupled = match form.couples() {
        true if form.is_lifted() => 1 + (D + 1) * (D + 1),
        true => D + 2,
        false => 1,
    };
    n_cells * (element.per_cell().pow(2) * coupled) as f64
}

/// Refuses a matrix whose entries may be too many, before anything is allocated.
fn check_size<const D: usize>(
    n_cells: usize,
    element: &dyn Element<D>,
    form: &dyn FacetForm<D>,
) -> Result<(), Error> {
    let entries = entries_at_most(n_cells as f64, element, form);
    if entries <= MOST_ENTRIES {
        return Ok(());
    }
    let allowed = format!("at most {MOST_ENTRIES}; choose a coarser mesh or a lower degree");
    Err(Error::parameter("entries of the matrix", entries, allowed))
}
