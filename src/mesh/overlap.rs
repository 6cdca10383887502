//! Cells that overlap, and facets of the boundary that lie on others: of bodies that were meshed apart, each with nodes
//! of its own.

use super::components::Components;
use super::error::{MeshError, MeshErrorKind};
use super::facets::{HalfFacet, Neighbour, Neighbours};
use super::geometry::describe_point;
use super::simplicial::Mesh;
use crate::real::Point;

/// What to do with facets that lie on each other.
pub(super) const UNITE: &str = "let bodies that were meshed apart share their nodes (in Gmsh by BooleanFragments or Coherence before meshing)";

/// A point lies in a cell if its barycentric coordinates are above this, on the boundary of the cell if the least is
/// not below minus this.
const INSIDE: f64 = 1e-6;

impl<const D: usize> Mesh<D> {
    /// Refuses two cells on the same side of the facet that they share. `is_positive` has the sign of the
    /// determinant of the edges of each cell; `neighbours` is without boundary conditions.
    pub(super) fn check_folds(
        &self,
        neighbours: &Neighbours,
        is_positive: &[bool],
    ) -> Result<(), MeshError> {
        for (cell, local) in (0..self.n_cells()).flat_map(|c| (0..D + 1).map(move |k| (c, k))) {
            if neighbours.is_unmatched(cell, local) {
                continue;
            }
            let Neighbour::Cell { cell: other, local: there } = neighbours.across(cell, local)
            else {
                continue;
            };
            // the vertices ascend in both cells: the sign of the one opposite the facet alternates
            // with its number
            let alternates = (local + there as usize) % 2 == 1;
            if (is_positive[cell] == is_positive[other as usize]) != alternates {
                let vertices: Vec<u32> = self.facet_vertices(cell, local).collect();
                let message = format!(
                    "cells {cell} and {other} lie on the same side of their common facet {vertices:?}: the mesh folds over there; correct the coordinates or the cells"
                );
                let error = MeshError::new(MeshErrorKind::FoldedCells, message);
                return Err(error.of_cells([cell, other as usize]));
            }
        }
        Ok(())
    }

    /// Of these facets of the boundary the positions of those whose middle lies on the boundary of another cell than
    /// their own. Where it lies in another cell, or the middle of their cell does, the mesh is refused. In a mesh
    /// that is connected through facets nothing is looked for.
    pub(super) fn lie_on_others(
        &self,
        facets: &[HalfFacet],
        components: &mut Components,
    ) -> Result<Vec<usize>, MeshError> {
        let mut coincident = Vec::new();
        if (0..self.n_cells()).all(|cell| components.find(cell) == 0) {
            return Ok(coincident);
        }
        let search = self.cell_search(INSIDE);
        // the other cell in which a point lies deepest
        let other_at = |x: &Point<D>, own: usize| {
            let depth = |cell: usize| {
                self.barycentric(cell, x)[..=D].iter().copied().fold(f64::INFINITY, f64::min)
            };
            let others = search.candidates(x).filter(|&cell| cell != own);
            others.map(|cell| (depth(cell), cell)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        for (position, &(cell, local)) in facets.iter().enumerate() {
            let middle = self.facet_barycentre(cell, local);
            for x in [middle, self.barycentre(cell)] {
                if let Some((_, other)) = other_at(&x, cell).filter(|(depth, _)| *depth > INSIDE) {
                    let message = format!(
                        "cells {cell} and {other} overlap at {}: bodies of the mesh lie on each other; leave one of them out, or mesh their union",
                        describe_point(&x)
                    );
                    let error = MeshError::new(MeshErrorKind::OverlappingCells, message);
                    return Err(error.of_cells([cell, other]));
                }
            }
            if other_at(&middle, cell).is_some_and(|(depth, _)| depth >= -INSIDE) {
                coincident.push(position);
            }
        }
        Ok(coincident)
    }

    /// How many facets of the boundary lie on others with different nodes.
    pub(super) fn n_coincident_facets(&self) -> usize {
        let facets = self.boundary.iter().map(|f| (f.cell as usize, usize::from(f.local)));
        let facets: Vec<HalfFacet> = facets.collect();
        let components = &mut Components::of_cells(&Neighbours::new(self));
        // a mesh that has been made has no overlaps
        self.lie_on_others(&facets, components).map_or(0, |found| found.len())
    }
}
