//! Uniform refinement of a part, by itself: what the refined whole has there.

use super::{Across, Layers, Part, numbers_of_taken};
use crate::mesh::error::MeshError;
use crate::mesh::part::extent::Extent;
use crate::mesh::refine::Refinement;
use crate::mesh::simplicial::Mesh;

/// Numbers of cells in the whole mesh are below this one, so that numbers of the unknowns of cells have 64 bits.
const CELL_LIMIT: u64 = 1 << 56;

impl Layers {
    /// How many layers across `across` a part with these layers has after uniform refinement.
    ///
    /// The children of a cell are no further apart than their parents, so that none is lost. In two dimensions
    /// a child at a corner of its parent has midpoints of edges with this corner alone, so that the children
    /// of one layer across vertices make two; so do intervals. In space a midpoint of an inner child may lie on
    /// an edge opposite the corner. Two facets of a cell have a vertex in common in two and three
    /// dimensions, so that two steps across facets stay within one across vertices.
    fn refined(self, dimension: usize, across: Across) -> usize {
        match (dimension, self.across, across) {
            (1, _, _) | (2, Across::Vertices, _) | (_, Across::Vertices, Across::Facets) => {
                2 * self.count
            }
            (_, Across::Facets, Across::Vertices) => 0,
            _ => self.count,
        }
    }
}

impl<const D: usize> Part<D> {
    /// The part of the refined mesh with the children of own cells and layers of others, and the parents of its
    /// vertices in this part. It is what [`Mesh::part`] takes of the refined whole: child `k` of the cell
    /// with the number `c` has the number `c 2^D + k`, owner and boundary are inherited.
    ///
    /// A part finds it by itself, but for the mesh size: see [`Part::with_extent`].
    ///
    /// ```
    /// use unilateral::mesh::Layers;
    /// use unilateral::prelude::*;
    ///
    /// let square = BoxDomain::dirichlet(Point::from([0.0, 0.0]), Point::from([1.0, 1.0]));
    /// let whole = Mesh::<2>::kuhn_box(&square, [8, 8])?;
    /// let layers = Layers::across_vertices(1);
    /// let part = whole.part(&whole.partition(2)?, 0, layers)?;
    /// let (fine, refinement) = part.refine(layers)?;
    /// assert_eq!(refinement.parents.len(), fine.mesh.vertices().len());
    /// assert_eq!(fine.cells[0], 4 * part.cells[0]);
    /// // without peeling it would have 4 (64 + 16) cells
    /// assert_eq!(fine.mesh.n_cells(), 4 * 64 + 32);
    /// # Ok::<(), unilateral::mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for more layers than the children of this part make: as many as it has; twice as
    /// many across vertices in one and two dimensions, and across facets where it has layers across vertices.
    /// `MeshErrorKind::TooLarge`.
    pub fn refine(&self, layers: Layers) -> Result<(Self, Refinement), MeshError> {
        self.check_refinement(layers)?;
        Ok(self.peel(self.mesh.refine()?, layers))
    }

    /// The part as one of a mesh with this extent. A refined part does not know the mesh size of the whole, on
    /// a disc and with a shape not its box either: the [extents](Extent::of) of all parts merge into that of the whole.
    #[must_use]
    pub fn with_extent(self, whole: Extent<D>) -> Self {
        Self { mesh: self.mesh.with_extent(whole), ..self }
    }

    /// Refuses more layers than there are after refinement, and numbers of cells that are too large.
    pub(in crate::mesh) fn check_refinement(&self, layers: Layers) -> Result<(), MeshError> {
        let most = self.layers.refined(D, layers.across);
        if layers.count > most {
            let allowed = format!("at most {most}; take more layers of the coarse mesh");
            return Err(MeshError::parameter("layers of a refined part", layers.count, allowed));
        }
        let last = self.cells.last().map_or(0, |&cell| cell);
        if last >= CELL_LIMIT >> D {
            let limit = CELL_LIMIT as usize;
            let count = last.saturating_mul(1 << D) as usize;
            return Err(MeshError::too_large("cells", count, limit));
        }
        Ok(())
    }

    /// The children of own cells and layers of others, of the refinement of the mesh of this part.
    pub(in crate::mesh) fn peel(
        &self,
        (mesh, refinement): (Mesh<D>, Refinement),
        layers: Layers,
    ) -> (Self, Refinement) {
        let is_own = |cell: usize| self.owns(cell >> D);
        let mut is_taken: Vec<bool> = (0..mesh.n_cells()).map(is_own).collect();
        mesh.add_layers(&mut is_taken, layers);
        let cells = numbers_of_taken(&is_taken);
        let (mesh, vertices) = mesh.submesh(&cells);
        let parents = || cells.iter().map(|&cell| cell as usize >> D);
        let child = |(&cell, parent): (&u32, usize)| {
            (self.cells[parent] << D) + u64::from(cell & ((1 << D) - 1))
        };
        let fine = Self {
            number: self.number,
            layers,
            mesh,
            owners: parents().map(|parent| self.owners[parent]).collect(),
            cells: cells.iter().zip(parents()).map(child).collect(),
        };
        let parents = vertices.iter().map(|&v| refinement.parents[v as usize]).collect();
        (fine, Refinement { parents })
    }
}
