//! A scheme applied to a problem on a mesh: unknowns, matrix and what is known of them.

mod inequality;
mod join;

use std::sync::OnceLock;

use super::facet_coefficients::FacetCoefficients;
use super::owned_rows;
use super::penalty_below_bound::PenaltyBelowBound;
use super::shared_rows::SharedRows;
use super::space::Space;
use super::space::metric::Metrics;
use crate::algebra::{DofLocation, SparseMatrix};
use crate::error::Error;
use crate::facet::FacetForm;
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::parallel::once;
use crate::problem::{DiscreteFunction, Problem};

/// A scheme applied to a problem on a mesh.
///
/// The type names no scheme: element and facet form are held without their types, so that what it
/// does is compiled once for each dimension.
///
/// # Panics
/// A method that takes a vector of unknowns or a solution panics unless this has one value for each unknown; one that
/// returns an [`Error`] returns [`Error::Parameter`]. A method that takes the number of a cell panics if there is no such
/// cell.
pub struct Discretisation<'a, const D: usize> {
    pub(crate) space: Space<'a, D>,
    form: Box<dyn FacetForm<D>>,
    shared_rows: SharedRows,
    /// The data of cells and facets that facet forms need, computed when first needed.
    prepared: OnceLock<(Metrics, FacetCoefficients)>,
}

impl<'a, const D: usize> Discretisation<'a, D> {
    /// Number of unknowns, Dirichlet ones included.
    pub fn unknowns(&self) -> usize {
        self.space.dofs.size()
    }
    /// Largest degree of which the element contains all polynomials.
    pub fn degree(&self) -> usize {
        self.space.degree
    }
    /// The facet form in force.
    pub fn form(&self) -> &dyn FacetForm<D> {
        &*self.form
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<D> {
        self.space.mesh
    }
    /// The problem.
    pub fn problem(&self) -> &'a Problem<D> {
        self.space.problem
    }
    /// Whether a form acts on a broken space: each row belongs to one cell, which writes it in place.
    pub(crate) fn owns_rows(&self) -> bool {
        self.form.couples() && self.space.broken
    }
    /// The pattern of the matrix, with values zero.
    pub fn pattern(&self) -> SparseMatrix<f64> {
        compiled!(const D: fn(&Discretisation<'_, D>) -> SparseMatrix<f64>
                = |of| match of.owns_rows() {
                    true => owned_rows::pattern(&of.space, of.form()),
                    false => of.shared_rows.pattern(&of.space, of.form()),
                }
        )(self)
    }
    /// Overwrites the values of a matrix that has this discretisation's pattern.
    ///
    /// # Panics
    /// If it has another.
    pub fn fill(&self, matrix: &mut SparseMatrix<f64>) {
        compiled!(const D: fn(&Discretisation<'_, D>, &mut SparseMatrix<f64>)
                = |of, matrix| match of.owns_rows() {
                    true => {
                        let (metrics, weights) = of.prepared();
                        owned_rows::fill(&of.space, of.form(), metrics, weights, matrix);
                    }
                    false => of.shared_rows.fill(&of.space, of.form(), matrix),
                }
        )(self, matrix)
    }
    /// Drops what facet forms need of cells and facets, and the load by cells: a tenth of the memory of a solve. It is
    /// computed again when needed.
    pub(crate) fn forget_prepared(&mut self) {
        self.prepared.take();
        self.space.load_by_cell.take();
    }
    /// The data of cells and facets that facet forms need. Loops over cells ask for them before they begin.
    pub(super) fn prepared(&self) -> &(Metrics, FacetCoefficients) {
        once(&self.prepared, || {
            let metrics = Metrics::of(self.mesh().n_cells(), |cell| self.space.metric(cell));
            let weights = FacetCoefficients::of(&self.space, self.form(), &metrics);
            (metrics, weights)
        })
    }
    /// The matrix from nothing.
    pub fn matrix(&self) -> SparseMatrix<f64> {
        let mut matrix = self.pattern();
        self.fill(&mut matrix);
        matrix
    }
    /// The location of each unknown.
    pub fn locations(&self) -> Vec<DofLocation> {
        self.space.locations()
    }
    /// The constants of bodies that were taken off the data, one number for each unknown; empty if all are zero. A vector of
    /// the inequality plus these numbers is the function of the problem. Methods of a discretisation take vectors of the
    /// inequality; discrete functions and values at points that they return have the constants added. The constants depend
    /// on the mesh on which the data are looked at, in nested iterations the coarsest one: a vector belongs to the
    /// discretisation of its own result.
    pub fn constants(&self) -> Vec<f64> {
        self.space.constants_of_unknowns()
    }
    /// Refuses a vector that has not one value for each unknown.
    pub(crate) fn check_length(&self, u: &[f64]) -> Result<(), Error> {
        match self.unknowns() {
            n if n == u.len() => Ok(()),
            n => {
                let allowed = format!("one for each of the {n} unknowns");
                Err(Error::parameter("number of values", u.len(), allowed))
            }
        }
    }
    /// As [`Self::check_length`], where no error can be returned.
    #[track_caller]
    pub(crate) fn demand_length(&self, u: &[f64]) {
        self.check_length(u).unwrap_or_else(|error| panic!("{error}"));
    }
    /// The discrete function, which is a datum of other problems.
    pub fn function(&self, u: &[f64]) -> DiscreteFunction<D> {
        self.demand_length(u);
        self.space.function(u)
    }
    /// The discrete function at the vertices of each cell, `D + 1` values for each.
    pub fn vertex_values(&self, u: &[f64]) -> Vec<f64> {
        self.demand_length(u);
        self.space.vertex_values(u)
    }
    /// The facets whose penalty lies below the bound that proves coercivity: their number and the
    /// one with the smallest quotient of penalty and bound; none if no penalty lies below its bound
    /// or the form has no such bound.
    pub fn penalty_below_bound(&self) -> Option<PenaltyBelowBound> {
        compiled!(const D: fn(&Discretisation<'_, D>) -> Option<PenaltyBelowBound>
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
    /// The unknowns of a cell, in the order of the element's nodes.
    pub fn unknowns_of(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.space.per_cell()).map(move |i| self.space.dofs.of(cell, i))
    }
    /// The number of the part that owns each unknown: the lowest of the parts that own its cells, given the
    /// [owner of each cell](crate::mesh::Part::owners).
    ///
    /// Of an unknown of own cells this is the owner on the whole mesh, if the part has as many layers as the
    /// scheme [needs](crate::scheme::Scheme#method.layers). The others are none of the part's own either
    /// way.
    ///
    /// # Panics
    /// If there are fewer owners than cells.
    pub fn owners(&self, of_cells: &[u32]) -> Vec<u32> {
        let mut owners = vec![u32::MAX; self.unknowns()];
        for (cell, &owner) in of_cells[..self.mesh().n_cells()].iter().enumerate() {
            for unknown in self.unknowns_of(cell) {
                owners[unknown] = owners[unknown].min(owner);
            }
        }
        owners
    }
}

impl<const D: usize> std::fmt::Debug for Discretisation<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Discretisation")
            .field("unknowns", &self.unknowns())
            .field("degree", &self.degree())
            .finish_non_exhaustive()
    }
}
