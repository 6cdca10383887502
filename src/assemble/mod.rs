//! One assembler for every scheme.
//!
//! A [`Discretisation`] joins scheme, problem and mesh. Its matrix is made in one of two ways, which
//! the element's layout decides, not the scheme's name: rows of a broken space belong to one cell,
//! which writes them in place; rows of a space that shares unknowns are gathered from local
//! matrices. Both are parallel, without locks, and give the same bits for any number of threads.

mod bounds;
mod broken;
pub(crate) mod count;
mod data;
mod dofs;
mod fields;
mod gather;
mod load;
mod local;
mod norms;
mod parallel;
pub(crate) mod tables;

use crate::algebra::{Inequality, Place, SparseMatrix, Start};
use crate::element::{Node, ReferenceElement};
use crate::error::Error;
use crate::facet::{FacetForm, FacetView};
use crate::mesh::{BoundaryPart, Facets, Mesh, Neighbour, Neighbours};
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::{DirichletBy, Scheme};
use dofs::Dofs;
use local::{CellSide, FacetGeometry};

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
    form: S::Facet,
    problem: &'a Problem<D>,
    mesh: &'a Mesh<T, D>,
    quadrature: DataQuadrature,
    neighbours: Option<Neighbours>,
    dofs: Dofs<'a>,
    coefficients: Option<Vec<T>>,
}

impl<'a, T: Real, const D: usize, S: Scheme<T, D>> Discretisation<'a, T, D, S> {
    const N: usize = <S::Element as ReferenceElement<T, D>>::N;
    const BROKEN: bool = <S::Element as ReferenceElement<T, D>>::LAYOUT.is_broken();
    const COUPLES: bool = <S::Facet as FacetForm<T, D>>::COUPLES;

    /// Joins scheme, problem and mesh; builds facets only if the scheme needs them.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`].
    pub fn new(
        scheme: &S,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<T, D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let layout = <S::Element as ReferenceElement<T, D>>::LAYOUT;
        let neighbours = (Self::COUPLES || layout.facet > 0).then(|| {
            count::facet_topologies(1);
            Neighbours::of(mesh)
        });
        let dofs = match &neighbours {
            _ if layout.is_broken() => Dofs::broken(Self::N, mesh.n_cells()),
            Some(neighbours) if layout.facet > 0 => {
                let facets = Facets::of(mesh, neighbours);
                Dofs::shared(facets.numbers::<D>(mesh.n_cells()), Self::N, facets.len())
            }
            _ => Dofs::vertices(mesh),
        };
        let coefficients = data::coefficients(problem, mesh)?;
        let form = scheme.facet(mesh);
        Ok(Self { form, problem, mesh, quadrature, neighbours, dofs, coefficients })
    }

    /// Number of unknowns, Dirichlet ones included.
    pub fn unknowns(&self) -> usize {
        self.dofs.size()
    }
    /// The facet form in force.
    pub fn form(&self) -> &S::Facet {
        &self.form
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T, D> {
        self.mesh
    }
    /// Where the scheme imposes bounds: `vertices` or `facet-means`.
    pub fn constraint_name() -> &'static str {
        match <S::Element as ReferenceElement<T, D>>::node(0) {
            Node::Vertex(_) => "vertices",
            Node::FacetMean(_) => "facet-means",
        }
    }

    /// The pattern of the matrix, with values zero.
    pub fn pattern(&self) -> SparseMatrix<T> {
        match (&self.neighbours, Self::BROKEN) {
            (Some(neighbours), true) => broken::pattern(self, neighbours),
            _ => gather::pattern(self),
        }
    }
    /// Overwrites the values of a matrix that has this discretisation's pattern.
    pub fn fill(&self, matrix: &mut SparseMatrix<T>) {
        match (&self.neighbours, Self::BROKEN) {
            (Some(neighbours), true) => broken::fill(self, neighbours, matrix),
            _ => gather::fill(self, matrix),
        }
    }
    /// The matrix from nothing.
    pub fn matrix(&self) -> SparseMatrix<T> {
        let mut matrix = self.pattern();
        self.fill(&mut matrix);
        matrix
    }
    /// The inequality: matrix, load, bounds, places.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::EmptyConstraint`].
    pub fn inequality(&self) -> Result<Inequality<T>, Error> {
        let load = self.load()?;
        let bounds = self.bounds()?;
        Ok(Inequality {
            matrix: self.matrix(),
            symmetric: <S::Facet as FacetForm<T, D>>::SYMMETRIC,
            load,
            bounds,
            places: self.places(),
            start: Start::Cold,
        })
    }
    /// Where each unknown lives.
    pub fn places(&self) -> Vec<Place> {
        let mut places = vec![Place::new(None, &[]); self.unknowns()];
        for cell in 0..self.mesh.n_cells() {
            let owner = Self::BROKEN.then_some(cell as u32);
            for i in 0..Self::N {
                places[self.dofs.of(cell, i)] = match S::Element::node(i) {
                    Node::Vertex(k) => Place::new(owner, &[self.mesh.cell(cell)[k]]),
                    Node::FacetMean(k) => {
                        let mut vertices = [0; D];
                        let facet = self.mesh.facet_vertices(cell, k);
                        vertices.iter_mut().zip(facet).for_each(|(v, w)| *v = w);
                        Place::new(owner, &vertices)
                    }
                };
            }
        }
        places
    }

    /// Facets whose weight lies below what the form needs to be provably coercive: how many, and
    /// the one that misses by the largest factor. Nothing if the form promises none.
    pub fn penalty_shortfall(&self) -> Option<PenaltyShortfall> {
        let neighbours = self.neighbours.as_ref()?;
        let mut worst: Option<PenaltyShortfall> = None;
        for cell in 0..self.mesh.n_cells() {
            for local in 0..=D {
                if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                    && (other as usize) < cell
                {
                    continue;
                }
                let Some(view) = self.facet_view(neighbours, cell, local) else {
                    continue;
                };
                let needed = self.form.least_penalty(&view)?.to_f64();
                let weight = self.form.penalty(&view).to_f64();
                if weight >= needed {
                    continue;
                }
                let facets = worst.map_or(0, |w| w.facets) + 1;
                let here = PenaltyShortfall { facets, cell, local, weight, needed };
                worst = match worst {
                    Some(w) if w.weight / w.needed <= weight / needed => {
                        Some(PenaltyShortfall { facets, ..w })
                    }
                    _ => Some(here),
                };
            }
        }
        worst
    }

    /// The view of a facet that carries a form, from the cell here.
    fn facet_view(
        &self,
        neighbours: &Neighbours,
        cell: usize,
        local: usize,
    ) -> Option<FacetView<T>> {
        let geometry = self.mesh.geometry(cell);
        let here = CellSide { cell, local, geometry: &geometry, coefficient: self.alpha(cell) };
        match neighbours.across(cell, local) {
            Neighbour::Boundary(BoundaryPart::Dirichlet)
                if S::DIRICHLET == DirichletBy::FacetForm =>
            {
                Some(FacetGeometry::new(self.mesh, &here, None).view)
            }
            Neighbour::Boundary(_) => None,
            Neighbour::Cell { cell: other, local: other_local } => {
                let geometry = self.mesh.geometry(other as usize);
                let there = CellSide {
                    cell: other as usize,
                    local: other_local as usize,
                    geometry: &geometry,
                    coefficient: self.alpha(other as usize),
                };
                Some(FacetGeometry::new(self.mesh, &here, Some(&there)).view)
            }
        }
    }

    /// The diffusion coefficient of a cell.
    #[inline(always)]
    fn alpha(&self, cell: usize) -> T {
        self.coefficients.as_ref().map_or_else(|| T::lit(1.0), |a| a[cell])
    }
}

/// A warning: penalties below the bound that proves coercivity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the penalty of {facets} facets lies below the bound that proves coercivity; worst at facet {local} of cell {cell}: {weight:.3e} where {needed:.3e} is enough"
)]
pub struct PenaltyShortfall {
    /// How many facets lie below.
    pub facets: usize,
    /// Cell of the facet that misses by the largest factor.
    pub cell: usize,
    /// Number of that facet in the cell.
    pub local: usize,
    /// Its weight.
    pub weight: f64,
    /// The weight that is provably enough.
    pub needed: f64,
}
