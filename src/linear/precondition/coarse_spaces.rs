//! The conforming linear functions that are known for an inequality.

use std::borrow::Cow;
use std::sync::Arc;

use super::coarse_level::{CoarseLevel, P1Level};
use super::prolongation::Prolongation;
use crate::algebra::{Bound, DofLocation, Inequality, SparseMatrix, galerkin_product};
use crate::parallel::vectors::all;
use crate::real::Real;

/// Spaces of conforming linear functions for multigrid.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum CoarseSpaces<T> {
    /// No space is known. Iterative solvers construct one from the matrix and the locations of unknowns.
    #[default]
    Unknown,
    /// The unknowns are the vertex values of conforming linear functions, and the space on the next
    /// coarser mesh is known.
    CoarseLevel(CoarseLevel<T>),
    /// The unknowns are those of another finite element, and the conforming linear functions on the
    /// same mesh are known.
    SameMesh(Arc<P1Level<T>>),
}

impl<T: Real> CoarseSpaces<T> {
    /// Whether these are spaces for an inequality: a coarser level whose prolongation has as many fine unknowns as the
    /// inequality, or a level that has all vertices in the locations of the unknowns of the inequality.
    pub(crate) fn fits(&self, inequality: &Inequality<T>) -> bool {
        match self {
            Self::Unknown => false,
            Self::CoarseLevel(coarser) => coarser.prolongation.n_fine() == inequality.size(),
            Self::SameMesh(level) => all(inequality.locations.len(), |i| {
                inequality.locations[i].vertices().iter().all(|&v| (v as usize) < level.size())
            }),
        }
    }

    /// These spaces if they fit an inequality, else spaces constructed from the symmetric part `matrix`
    /// of its matrix and the locations of its unknowns; `None` if the inequality does not have a location
    /// for each unknown, or if no space can be constructed.
    pub(crate) fn complete(
        &self,
        matrix: &SparseMatrix<T>,
        inequality: &Inequality<T>,
    ) -> Option<Cow<'_, Self>> {
        let Inequality { bounds, locations, conforming_linear, .. } = inequality;
        if locations.len() != inequality.size() || locations.is_empty() {
            return None;
        }
        if self.fits(inequality) {
            return Some(Cow::Borrowed(self));
        }
        let fixed: Vec<bool> = bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect();
        Some(Cow::Owned(if *conforming_linear {
            CoarseLevel::aggregated(matrix, &fixed).map_or(Self::Unknown, Self::CoarseLevel)
        } else {
            Self::SameMesh(Arc::new(p1_level(matrix, locations, &fixed)?))
        }))
    }
}

/// The conforming linear functions on the mesh of another finite element, with the Galerkin matrix
/// `P^T A P`: the prolongation `P` sets an unknown of the element to the mean of the values at the vertices of its
/// location. Fixed are the vertices in the locations of fixed unknowns, and those whose diagonal entry
/// is not positive. `None` if a location has no vertex.
fn p1_level<T: Real>(
    matrix: &SparseMatrix<T>,
    locations: &[DofLocation],
    fixed: &[bool],
) -> Option<P1Level<T>> {
    let last = locations.iter().flat_map(|p| p.vertices()).max()?;
    let n = *last as usize + 1;
    let prolongation = Prolongation::to_element(locations, n)?;
    let mut fixed_vertices = vec![false; n];
    for (location, _) in locations.iter().zip(fixed).filter(|(_, fixed)| **fixed) {
        location.vertices().iter().for_each(|&v| fixed_vertices[v as usize] = true);
    }
    let form = galerkin_product(matrix, prolongation.rows(), n);
    for (v, fixed) in fixed_vertices.iter_mut().enumerate() {
        *fixed |= form.get(v, v) <= T::lit(0.0);
    }
    P1Level::new(form, fixed_vertices, None)
}
