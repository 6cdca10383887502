//! One assembler for every scheme.
//!
//! A [`Discretisation`] joins scheme, problem and mesh. Its matrix is made in one of two ways, which
//! the element's layout decides, not the scheme's name: rows of a broken space belong to one cell,
//! which writes them in place; rows of a space that shares unknowns are gathered from local
//! matrices. Both are parallel, without locks, and give the same bits for any number of threads.

mod coercivity_margin;
pub(crate) mod count;
mod facet_coefficients;
mod jump_products;
pub(crate) mod load;
pub(crate) mod local;
mod owned_rows;
mod penalised;
mod shared_rows;
pub(crate) mod space;

use std::sync::OnceLock;

use crate::algebra::{Bound, Inequality, SparseMatrix, Start, Support};
use crate::element::ReferenceElement;
use crate::error::Error;
use crate::facet::FacetForm;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::{DirichletBy, Scheme};
pub use coercivity_margin::CoercivityMargin;
use facet_coefficients::FacetCoefficients;
use space::Space;
use space::metric::Metrics;

/// Degrees of the quadrature rules for data, beyond what the forms need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataQuadrature {
    /// Degree of the cell rule for loads that vary.
    pub cell: usize,
    /// Degree of the facet rule for Dirichlet and Neumann data.
    pub facet: usize,
}

impl Default for DataQuadrature {
    /// Loads to degree 5, which leaves an error of higher order than linear and quadratic elements
    /// have; boundary data to degree 15, because there are few boundary facets and the weak
    /// Dirichlet data of an over-penalised scheme weigh much.
    fn default() -> Self {
        Self { cell: 5, facet: 15 }
    }
}

/// A scheme applied to a problem on a mesh.
pub struct Discretisation<'a, T: Real, const D: usize, S: Scheme<T, D>> {
    pub(crate) space: Space<'a, T, D>,
    pub(crate) form: S::Facet,
    /// What facet forms need of cells and facets, computed when first needed.
    prepared: OnceLock<(Metrics<T>, FacetCoefficients<T>)>,
}

impl<'a, T: Real, const D: usize, S: Scheme<T, D>> Discretisation<'a, T, D, S> {
    const N: usize = <S::Element as ReferenceElement<T, D>>::N;
    pub(crate) const COUPLES: bool = <S::Facet as FacetForm<T, D>>::COUPLES;
    /// Whether each row belongs to one cell, which then writes it in place.
    const OWNS_ROWS: bool =
        Self::COUPLES && <S::Element as ReferenceElement<T, D>>::LAYOUT.is_broken();

    /// Joins scheme, problem and mesh; builds facets only if the scheme needs them.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::NothingToBound`].
    pub fn new(
        scheme: &S,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<T, D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let pins = matches!(S::DIRICHLET, DirichletBy::Pinning);
        let bounded = scheme.bounded_nodes();
        let space =
            Space::new::<S::Element>(problem, mesh, quadrature, Self::COUPLES, pins, bounded)?;
        Ok(Self { space, form: scheme.facet(mesh), prepared: OnceLock::new() })
    }

    /// Number of unknowns, Dirichlet ones included.
    pub fn unknowns(&self) -> usize {
        self.space.dofs.size()
    }
    /// The facet form in force.
    pub fn form(&self) -> &S::Facet {
        &self.form
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T, D> {
        self.space.mesh
    }
    /// The pattern of the matrix, with values zero.
    pub fn pattern(&self) -> SparseMatrix<T> {
        if Self::OWNS_ROWS {
            owned_rows::pattern(&self.space, S::Facet::LIFTED)
        } else {
            shared_rows::pattern(self)
        }
    }
    /// Overwrites the values of a matrix that has this discretisation's pattern.
    ///
    /// # Panics
    /// If it has another.
    pub fn fill(&self, matrix: &mut SparseMatrix<T>) {
        const {
            assert!(
                !S::Facet::LIFTED || (Self::OWNS_ROWS && S::Element::DEGREE <= 2),
                "lifts of jumps are made for broken elements of degree one and two"
            );
            assert!(
                !Self::OWNS_ROWS || !S::Facet::USES_FLUX || S::Element::DEGREE <= [9, 9, 3, 2][D],
                "fluxes have more moments than rows are made for"
            );
        }
        if Self::OWNS_ROWS {
            let (metrics, weights) = self.prepared();
            owned_rows::fill(&self.space, &self.form, metrics, weights, matrix);
        } else {
            shared_rows::fill(self, matrix);
        }
    }
    fn prepared(&self) -> &(Metrics<T>, FacetCoefficients<T>) {
        self.prepared.get_or_init(|| {
            let metrics = Metrics::of(self.space.mesh);
            let weights = FacetCoefficients::of(&self.space, &self.form, &metrics);
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
        let (load, own_load, data) = self.loads()?;
        let bounds = self.bounds()?;
        let matrix = self.matrix();
        let factored = own_load.map(|own_load| {
            let (metrics, weights) = self.prepared();
            penalised::factored(&self.space, &self.form, (metrics, weights), own_load, data)
        });
        // the loops that fill the matrix cannot fail: whoever is to blame is sought afterwards
        if let Some(reaction) = space::data::ReactionTerm::new(&self.space)
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
            points: if D == 3 || Self::OWNS_ROWS { self.space.vertex_points() } else { Vec::new() },
            start: Start::Cold,
            penalised: factored,
        })
    }
    /// The load; if the matrix is kept factored too, the load without Dirichlet data, and these.
    fn loads(&self) -> Result<penalised::Loads<T>, Error> {
        let is_factored = Self::OWNS_ROWS && penalised::applies::<T, D, _>(&self.form);
        let mut own = None;
        let (load, data) =
            self.space.load_and_data(&self.form, &|| &self.prepared().0, &mut |by_cell| {
                own = is_factored.then(|| by_cell.to_vec());
            })?;
        Ok((load, own, data))
    }
    /// The bounds of all unknowns.
    ///
    /// Of the unknowns in the scheme's constraint set, obstacles bind every one at its node: a
    /// vertex, the midpoint of an edge or the barycentre of a facet; means over a cell against the
    /// mean of the obstacle. The Signorini condition binds those of contact facets on the cell that
    /// has the facet: point values against the gap there, facet means against the mean of the gap.
    /// An unknown pinned by Dirichlet data is not constrained besides.
    ///
    /// # Errors
    /// [`Error::EmptyConstraint`], [`Error::DataNotFinite`].
    pub fn bounds(&self) -> Result<Vec<Bound<T>>, Error> {
        self.space.bounds()
    }
    /// Where each unknown lives.
    pub fn supports(&self) -> Vec<Support> {
        self.space.supports()
    }
    /// The discrete function at the vertices of each cell, `D + 1` values for each.
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn vertex_values(&self, u: &[T]) -> Vec<f64> {
        self.space.vertex_values(u)
    }
    /// Facets whose weight lies below what the form needs to be provably coercive: how many, and
    /// the one that misses by the largest factor. Nothing if the form promises none.
    pub fn coercivity_margin(&self) -> Option<CoercivityMargin> {
        self.space.coercivity_margin(&self.form)
    }
    /// The load of all unknowns.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn load(&self) -> Result<Vec<T>, Error> {
        self.space.load(&self.form, &|| &self.prepared().0)
    }
}
