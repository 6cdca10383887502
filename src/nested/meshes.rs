//! The meshes of a problem.

use std::sync::Arc;

use super::hierarchy::Hierarchy;
use crate::linear::Prolongation;
use crate::mesh::{Mesh, Refinement};
use crate::real::Real;

/// The meshes of a problem: one mesh, or nested ones.
#[derive(Debug)]
#[non_exhaustive]
pub enum Meshes<'a, T, const D: usize> {
    /// One mesh.
    Flat(&'a Mesh<T, D>),
    /// Nested meshes, of which the solution on a coarser one is the start on the next finer one.
    Nested(&'a Hierarchy<T, D>),
}

impl<'a, T, const D: usize> From<&'a Mesh<T, D>> for Meshes<'a, T, D> {
    fn from(mesh: &'a Mesh<T, D>) -> Self {
        Self::Flat(mesh)
    }
}

impl<'a, T, const D: usize> From<&'a Hierarchy<T, D>> for Meshes<'a, T, D> {
    fn from(hierarchy: &'a Hierarchy<T, D>) -> Self {
        Self::Nested(hierarchy)
    }
}

impl<'a, T: Real, const D: usize> Meshes<'a, T, D> {
    /// Number of meshes.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Flat(_) => 1,
            Self::Nested(hierarchy) => hierarchy.n_meshes(),
        }
    }
    /// A mesh by its position, zero for the coarsest.
    pub(super) fn mesh(&self, position: usize) -> &'a Mesh<T, D> {
        match self {
            Self::Flat(mesh) => mesh,
            Self::Nested(hierarchy) => hierarchy.mesh(position),
        }
    }
    /// The refinement of the next coarser mesh and its prolongation, if there is one.
    pub(super) fn refinement(
        &self,
        position: usize,
    ) -> Option<(&'a Refinement, &'a Arc<Prolongation<T>>)> {
        match self {
            Self::Flat(_) => None,
            Self::Nested(hierarchy) => hierarchy.refinement(position),
        }
    }
}
