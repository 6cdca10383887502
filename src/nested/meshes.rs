//! The meshes of a problem.

use std::sync::Arc;

use super::adaptive_meshes::AdaptiveMeshes;
use super::hierarchy::Hierarchy;
use super::piece::SharedPart;
use crate::element::Layout;
use crate::linear::Prolongation;
use crate::mesh::Mesh;

/// The meshes of a problem: one mesh, or nested ones.
///
/// Of several meshes the solution on a coarser one is the start on the next finer one.
#[derive(Debug)]
#[non_exhaustive]
pub enum Meshes<'a, const D: usize> {
    /// One mesh.
    Flat(&'a Mesh<D>),
    /// Uniform refinements.
    Nested(&'a Hierarchy<D>),
    /// Bisections; the sequence may grow.
    Adaptive(&'a AdaptiveMeshes<D>),
}

impl<'a, const D: usize> From<&'a Mesh<D>> for Meshes<'a, D> {
    fn from(mesh: &'a Mesh<D>) -> Self {
        Self::Flat(mesh)
    }
}

impl<'a, const D: usize> From<&'a Hierarchy<D>> for Meshes<'a, D> {
    fn from(hierarchy: &'a Hierarchy<D>) -> Self {
        Self::Nested(hierarchy)
    }
}

impl<'a, const D: usize> From<&'a AdaptiveMeshes<D>> for Meshes<'a, D> {
    fn from(meshes: &'a AdaptiveMeshes<D>) -> Self {
        Self::Adaptive(meshes)
    }
}

impl<'a, const D: usize> Meshes<'a, D> {
    /// Number of meshes.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Flat(_) => 1,
            Self::Nested(hierarchy) => hierarchy.n_meshes(),
            Self::Adaptive(meshes) => meshes.n_meshes(),
        }
    }
    /// A mesh by its position, zero for the coarsest.
    pub(super) fn mesh(&self, position: usize) -> &'a Mesh<D> {
        match self {
            Self::Flat(mesh) => mesh,
            Self::Nested(hierarchy) => hierarchy.mesh(position),
            Self::Adaptive(meshes) => meshes.mesh(position),
        }
    }
    /// The part of a mesh that this process has; none if it has the whole.
    pub(super) fn shared_part(&self, position: usize) -> Option<SharedPart<'a, D>> {
        match self {
            Self::Nested(hierarchy) => hierarchy.shared_part(position),
            Self::Flat(_) | Self::Adaptive(_) => None,
        }
    }
    /// Seconds in which a mesh and all coarser ones were made; zero for one mesh.
    pub(super) fn seconds(&self, position: usize) -> f64 {
        match self {
            Self::Flat(_) => 0.0,
            Self::Nested(hierarchy) => hierarchy.seconds(position),
            Self::Adaptive(meshes) => meshes.seconds(position),
        }
    }
    /// Continues values at the vertices of the mesh before a position: new vertices have `middle` of the
    /// values of their parents.
    pub(super) fn continued<V: Copy>(
        &self,
        position: usize,
        coarse: &[V],
        middle: impl Fn(V, V) -> V,
    ) -> Vec<V> {
        let between = |&[a, b]: &[u32; 2]| match (coarse[a as usize], coarse[b as usize]) {
            (value, _) if a == b => value,
            (one, other) => middle(one, other),
        };
        match self {
            Self::Flat(_) => unreachable!("one mesh has none before it"),
            Self::Nested(hierarchy) => {
                let refinement = hierarchy.refinement(position);
                let refinement = refinement.expect("a mesh with one before it is its refinement");
                refinement.parents.iter().map(between).collect()
            }
            Self::Adaptive(meshes) => meshes.continued(position, coarse, middle),
        }
    }
    /// The position of the mesh that is the next coarser level of multigrid, and the prolongation of
    /// conforming linear functions from there.
    pub(super) fn coarser_level(&self, position: usize) -> Option<(usize, &'a Arc<Prolongation>)> {
        match self {
            Self::Flat(_) => None,
            Self::Nested(hierarchy) => {
                hierarchy.prolongation(position).map(|by| (position - 1, by))
            }
            Self::Adaptive(meshes) => meshes.coarser_level(position),
        }
    }
}

/// Number of unknowns of a layout on a mesh.
pub(super) fn unknowns<const D: usize>(mesh: &Mesh<D>, layout: Layout) -> usize {
    let facets = ((D + 1) * mesh.n_cells() + mesh.boundary().len()) / 2;
    let (vertices, cells) = (mesh.vertices().len(), mesh.n_cells());
    // in space Euler's formula for a ball, which estimates the number of edges of other domains
    let edges = match D {
        1 => cells,
        2 => facets,
        _ => (vertices + facets).saturating_sub(cells + 1),
    };
    layout.vertex * vertices + layout.edge * edges + layout.facet * facets + layout.cell * cells
}
