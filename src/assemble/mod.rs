//! One assembler for every scheme.
//!
//! A [`Discretisation`] joins element, facet form, problem and mesh; the room
//! [`scheme`](crate::scheme) defines which elements and forms make a scheme. The layout of the
//! element and the form, not the name of the scheme, select one of two ways to compute the matrix.
//! Rows of a broken space belong to one cell and are written in place; rows of a space that shares
//! unknowns are gathered from local matrices. Both ways are parallel, without locks, and give the
//! same bits for any number of threads.

mod chosen_element;
pub(crate) mod count;
pub(crate) mod cut_simplices;
mod data_quadrature;
mod dirichlet_energy;
mod facet_coefficients;
mod facet_fluxes;
mod jump_products;
mod kernel;
pub(crate) mod load;
pub(crate) mod local;
mod owned_rows;
mod penalised;
mod penalty_below_bound;
mod penalty_factor;
mod shared_rows;
pub(crate) mod space;

use std::sync::OnceLock;

use crate::algebra::{Bound, Inequality, SparseMatrix, Start, Support};
use crate::element::ReferenceElement;
use crate::error::Error;
use crate::facet::{DirichletBy, FacetForm};
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
pub(crate) use chosen_element::ChosenElement;
pub use data_quadrature::DataQuadrature;
use facet_coefficients::FacetCoefficients;
pub use penalty_below_bound::PenaltyBelowBound;
use shared_rows::SharedRows;
pub(crate) use space::contradictions::Contradictions;
use space::metric::Metrics;
use space::{AnyElement, Space};

/// A scheme applied to a problem on a mesh.
///
/// The type names no scheme: element and facet form are held without their types, so that what it
/// does is compiled once for each scalar and dimension.
pub struct Discretisation<'a, T: Real, const D: usize> {
    pub(crate) space: Space<'a, T, D>,
    form: Box<dyn FacetForm<T, D>>,
    shared_rows: SharedRows<T, D>,
    /// What facet forms need of cells and facets, computed when first needed.
    prepared: OnceLock<(Metrics<T>, FacetCoefficients<T>)>,
    /// On a part what its bounds, once found, leave to be judged with the data of all parts.
    contradictions: OnceLock<Contradictions<D>>,
}

impl<'a, T: Real, const D: usize> Discretisation<'a, T, D> {
    /// Joins an element and a facet form with a problem and a mesh; builds facets only if they are
    /// needed.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::NothingToBound`], [`Error::UnsupportedForm`],
    /// [`Error::Parameter`] for a penalty factor that makes no penalty.
    pub(crate) fn of<E: ReferenceElement<T, D>>(
        form: Box<dyn FacetForm<T, D>>,
        dirichlet: DirichletBy,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<T, D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let pins = matches!(dirichlet, DirichletBy::Pinning);
        let element = ChosenElement::of::<E>(problem.constraint_set());
        let parts = Parts { element, form, pins };
        compiled!(
            T, D: for<'p> fn(
                Parts<T, D>,
                &'p Problem<D>,
                &'p Mesh<T, D>,
                DataQuadrature,
            ) -> Result<Discretisation<'p, T, D>, Error>
                = |parts, problem, mesh, quadrature| parts.join(problem, mesh, quadrature)
        )(parts, problem, mesh, quadrature)
    }

    /// Number of unknowns, Dirichlet ones included.
    pub fn unknowns(&self) -> usize {
        self.space.dofs.size()
    }
    /// Largest degree of which the element contains all polynomials.
    pub fn degree(&self) -> usize {
        self.space.degree
    }
    /// The facet form in force.
    pub fn form(&self) -> &dyn FacetForm<T, D> {
        &*self.form
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T, D> {
        self.space.mesh
    }
    /// The problem.
    pub fn problem(&self) -> &'a Problem<D> {
        self.space.problem
    }
    /// Whether each row belongs to one cell, which then writes it in place.
    pub(crate) fn owns_rows(&self) -> bool {
        self.form.couples() && self.space.broken
    }
    /// The pattern of the matrix, with values zero.
    pub fn pattern(&self) -> SparseMatrix<T> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> SparseMatrix<T>
                = |of| of.make_pattern()
        )(self)
    }
    fn make_pattern(&self) -> SparseMatrix<T> {
        if self.owns_rows() {
            owned_rows::pattern(&self.space, self.form())
        } else {
            self.shared_rows.pattern(&self.space, self.form())
        }
    }
    /// Overwrites the values of a matrix that has this discretisation's pattern.
    ///
    /// # Panics
    /// If it has another.
    pub fn fill(&self, matrix: &mut SparseMatrix<T>) {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>, &mut SparseMatrix<T>)
                = |of, matrix| of.fill_values(matrix)
        )(self, matrix)
    }
    fn fill_values(&self, matrix: &mut SparseMatrix<T>) {
        if self.owns_rows() {
            let (metrics, weights) = self.prepared();
            owned_rows::fill(&self.space, self.form(), metrics, weights, matrix);
        } else {
            self.shared_rows.fill(&self.space, self.form(), matrix);
        }
    }
    /// Drops what facet forms need of cells and facets, and the load by cells: a tenth of the memory of a solve. It is
    /// computed again when needed.
    pub(crate) fn forget_prepared(&mut self) {
        self.prepared.take();
        self.space.load_by_cell.take();
    }
    fn prepared(&self) -> &(Metrics<T>, FacetCoefficients<T>) {
        self.prepared.get_or_init(|| {
            let metrics = Metrics::of(self.space.mesh);
            let weights = FacetCoefficients::of(&self.space, self.form(), &metrics);
            (metrics, weights)
        })
    }
    /// The matrix from nothing.
    pub fn matrix(&self) -> SparseMatrix<T> {
        let mut matrix = self.pattern();
        self.fill(&mut matrix);
        matrix
    }
    /// The inequality: matrix, load, bounds, supports, points.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::EmptyConstraint`].
    pub fn inequality(&self) -> Result<Inequality<T>, Error> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> Result<Inequality<T>, Error>
                = |of| of.assemble()
        )(self)
    }
    fn assemble(&self) -> Result<Inequality<T>, Error> {
        let (load, own_load, data) = self.loads()?;
        let bounds = self.bounds()?;
        let matrix = self.matrix();
        let dirichlet_energy = (own_load.is_none() && !data.is_empty())
            .then(|| self.space.dirichlet_energy(self.form(), &|| &self.prepared().0, &data));
        let penalised = own_load.map(|own_load| {
            let (metrics, weights) = self.prepared();
            penalised::penalised_matrix(
                &self.space,
                self.form(),
                (metrics, weights),
                own_load,
                data,
            )
        });
        // the loops that fill the matrix return no error: a reaction term that is not finite is
        // detected here
        if let Some(reaction) = &self.space.reaction
            && !matrix.values.iter().all(|v| v.to_f64().is_finite())
        {
            reaction.check(self.mesh())?;
        }
        Ok(Inequality {
            matrix,
            symmetric: self.form.is_symmetric(),
            load,
            bounds,
            supports: self.supports(),
            // in the plane an order found in space is no better for unknowns that cells share
            points: if D == 3 || self.owns_rows() {
                self.space.vertex_points()
            } else {
                Vec::new()
            },
            conforming_linear: self.space.is_conforming_linear(),
            start: Start::Cold,
            penalised,
            dirichlet_energy,
            kernel: self.space.kernel(self.form.couples()),
            is_definite: false,
            distribution: None,
        })
    }
    /// The load; if the penalised form of the matrix is kept too, the load without Dirichlet data,
    /// and the Dirichlet data.
    fn loads(&self) -> Result<penalised::Loads<T>, Error> {
        let is_penalised = self.owns_rows() && penalised::applies(self.form());
        let mut own = None;
        let (load, data) =
            self.space.load_and_data(self.form(), &|| &self.prepared().0, &mut |by_cell| {
                own = is_penalised.then(|| by_cell.to_vec());
            })?;
        Ok((load, own, data))
    }
    /// The bounds of all unknowns.
    ///
    /// Obstacles bind the unknowns of the problem's constraint set, the Signorini condition those of
    /// contact facets on the cell that has the facet; the set says whether a node is bound by the
    /// value of the datum or by its mean. An unknown pinned by Dirichlet data is not constrained besides.
    ///
    /// # Errors
    /// [`Error::EmptyConstraint`], but on a [part](crate::mesh::Part) of a mesh: see
    /// [`check_bounds`](crate::distributed::check_bounds). [`Error::DataNotFinite`].
    pub fn bounds(&self) -> Result<Vec<Bound<T>>, Error> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> Result<Vec<Bound<T>>, Error>
                = |of| of.checked_bounds()
        )(self)
    }
    fn checked_bounds(&self) -> Result<Vec<Bound<T>>, Error> {
        let (bounds, found) = self.space.bounds()?;
        if self.mesh().is_part() {
            self.contradictions.get_or_init(|| Contradictions::new(&bounds, found));
        } else if !found.is_empty() {
            let found = Contradictions::new(&bounds, found);
            found.check(found.size(), &|_| true)?;
        }
        Ok(bounds)
    }
    /// Lower bounds above upper ones. They contradict each other if they do so by more than rounding of the
    /// largest datum, which a [part](crate::mesh::Part) of a mesh need not have.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn contradictions(&self) -> Result<&Contradictions<D>, Error> {
        compiled!(
            T, D: for<'d> fn(&'d Discretisation<'_, T, D>) -> Result<&'d Contradictions<D>, Error>
                = |of| of.find_contradictions()
        )(self)
    }
    fn find_contradictions(&self) -> Result<&Contradictions<D>, Error> {
        if let Some(found) = self.contradictions.get() {
            return Ok(found);
        }
        let (bounds, found) = self.space.bounds()?;
        Ok(self.contradictions.get_or_init(|| Contradictions::new(&bounds, found)))
    }
    /// The support of each unknown.
    pub fn supports(&self) -> Vec<Support> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> Vec<Support>
                = |of| of.space.supports()
        )(self)
    }
    /// The discrete function at the vertices of each cell, `D + 1` values for each.
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn vertex_values(&self, u: &[T]) -> Vec<f64> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>, &[T]) -> Vec<f64>
                = |of, u| of.space.vertex_values(u)
        )(self, u)
    }
    /// The facets whose penalty lies below the bound that proves coercivity: their number and the
    /// one with the smallest quotient of penalty and bound; none if no penalty lies below its bound
    /// or the form has no such bound.
    pub fn penalty_below_bound(&self) -> Option<PenaltyBelowBound> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> Option<PenaltyBelowBound>
                = |of| of.space.penalty_below_bound(of.form())
        )(self)
    }
    /// Whether theory proves the form coercive for penalties above their bound
    /// ([`Discretisation::penalty_below_bound`]), and the reaction is not negative at the points of its
    /// quadrature rule.
    pub fn is_coercive(&self) -> bool {
        let reaction = self.space.reaction.as_ref();
        self.form.theory().is_coercive && reaction.is_none_or(|r| r.is_nonnegative(self.mesh()))
    }
    /// The load of all unknowns.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn load(&self) -> Result<Vec<T>, Error> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>) -> Result<Vec<T>, Error>
                = |of| of.space.load(of.form(), &|| &of.prepared().0)
        )(self)
    }
}

impl<T: Real, const D: usize> Discretisation<'_, T, D> {
    /// The unknowns of a cell, in the order of the element's nodes.
    pub fn unknowns_of(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.space.per_cell()).map(move |i| self.space.dofs.of(cell, i))
    }
    /// The number of the part that owns each unknown: the lowest of the parts that own its cells, given the
    /// [owner of each cell](crate::mesh::Part::owners).
    ///
    /// Of an unknown of own cells this is the owner on the whole mesh, if the part has as many layers as the
    /// scheme [needs](crate::scheme::AnyScheme#method.layers). The others are none of the part's own either
    /// way.
    ///
    /// # Panics
    /// If there are fewer owners than cells.
    pub fn owners(&self, of_cells: &[u32]) -> Vec<u32> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>, &[u32]) -> Vec<u32>
                = |of, of_cells| of.owners_of_unknowns(of_cells)
        )(self, of_cells)
    }
    fn owners_of_unknowns(&self, of_cells: &[u32]) -> Vec<u32> {
        let mut owners = vec![u32::MAX; self.unknowns()];
        for (cell, &owner) in of_cells[..self.mesh().n_cells()].iter().enumerate() {
            for unknown in self.unknowns_of(cell) {
                owners[unknown] = owners[unknown].min(owner);
            }
        }
        owners
    }
}

/// What a scheme brings to a discretisation.
struct Parts<T: Real, const D: usize> {
    element: ChosenElement<T, D>,
    form: Box<dyn FacetForm<T, D>>,
    /// Whether Dirichlet data are pinned.
    pins: bool,
}

impl<T: Real, const D: usize> Parts<T, D> {
    fn join<'a>(
        self,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<T, D>,
        quadrature: DataQuadrature,
    ) -> Result<Discretisation<'a, T, D>, Error> {
        let Self { element: ChosenElement { element, loops, offered }, form, pins } = self;
        check_form::<T, D>(&element, &*form)?;
        let space = Space::new(element, problem, mesh, quadrature, form.couples(), pins, offered)?;
        space.check_penalty_factor(&*form)?;
        let shared_rows = SharedRows::new(loops);
        Ok(Discretisation {
            space,
            form,
            shared_rows,
            prepared: OnceLock::new(),
            contradictions: OnceLock::new(),
        })
    }
}

impl<T: Real, const D: usize> std::fmt::Debug for Discretisation<'_, T, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Discretisation")
            .field("unknowns", &self.unknowns())
            .field("degree", &self.degree())
            .finish_non_exhaustive()
    }
}

/// The number of polynomials of a degree in some variables that are linearly independent.
fn polynomials(variables: usize, degree: usize) -> usize {
    (1..=variables).fold(1, |count, k| count * (degree + k) / k)
}

/// Refuses forms that the loops over owned rows have no tables for.
fn check_form<T: Real, const D: usize>(
    element: &AnyElement,
    form: &dyn FacetForm<T, D>,
) -> Result<(), Error> {
    let refuse = |requested, allowed| Err(Error::UnsupportedForm { requested, allowed });
    let owns_rows = form.couples() && element.layout.is_broken();
    if form.is_lifted() && !(owns_rows && element.basis_degree <= 2) {
        return refuse("lifts of jumps", "broken elements of degree one and two");
    }
    if owns_rows
        && form.uses_flux()
        && polynomials(D - 1, element.basis_degree - 1) > local::MAX_FLUX_MOMENTS
    {
        return refuse(
            "fluxes",
            "broken elements with basis functions of degree at most 10 in the plane and 4 in space",
        );
    }
    Ok(())
}
