//! Parts of a mesh: own cells, and layers of the cells of other parts around them.

pub(in crate::mesh) mod extent;
mod partition;
mod refine;

pub use extent::Extent;

use crate::mesh::boundary::BoundaryFacet;
use crate::mesh::error::MeshError;
use crate::mesh::facets::Neighbours;
use crate::mesh::simplicial::Mesh;

/// What neighbouring cells share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// A facet.
    Facets,
    /// A vertex.
    Vertices,
}

/// Layers of cells around some cells: the neighbours, their neighbours and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// How many there are.
    pub count: usize,
    /// What neighbours share.
    pub across: Across,
}

impl Layers {
    /// So many layers of cells that share facets.
    pub const fn across_facets(count: usize) -> Self {
        Self { count, across: Across::Facets }
    }
    /// So many layers of cells that share vertices.
    pub const fn across_vertices(count: usize) -> Self {
        Self { count, across: Across::Vertices }
    }
}

/// A part of a mesh: its own cells, and layers of the cells of other parts.
///
/// The mesh of a part is a mesh as any other, with two differences. It is cut: beyond some facets lie cells
/// that it does not have ([`Neighbour::Cut`](crate::mesh::Neighbour::Cut)). And what schemes read of a mesh as a
/// whole, its diameter and its mesh size, are those of the whole mesh ([`Extent`]). Cells and vertices keep
/// their order, regions and boundary facets their names, so that a scheme has on the part, for the unknowns of
/// own cells, the matrix, load and bounds that it has on the whole mesh, bit for bit, if there are as many
/// layers as [it needs](crate::scheme::Scheme#method.layers).
///
/// ```
/// use unilateral::mesh::Layers;
/// use unilateral::prelude::*;
///
/// let square = BoxDomain::dirichlet(Point::from([0.0, 0.0]), Point::from([1.0, 1.0]));
/// let whole = Mesh::<2>::kuhn_box(&square, [8, 8])?;
/// let owners = whole.partition(2)?;
/// let part = whole.part(&owners, 0, Layers::across_facets(1))?;
/// assert_eq!(part.owners.iter().filter(|&&owner| owner == 0).count(), 64);
/// assert_eq!(part.mesh.n_cells(), 64 + 8);
/// assert_eq!(part.mesh.domain_diameter(), whole.domain_diameter());
/// # Ok::<(), unilateral::mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Part<const D: usize> {
    /// The number of the part.
    pub number: u32,
    /// The mesh of the part.
    pub mesh: Mesh<D>,
    /// The number of the part that owns each cell.
    pub owners: Vec<u32>,
    /// The number of each cell in the whole mesh, ascending.
    pub cells: Vec<u64>,
    /// The layers of cells of other parts.
    pub layers: Layers,
}

impl<const D: usize> Part<D> {
    /// Whether the part owns a cell.
    ///
    /// # Panics
    /// If the mesh of the part has no such cell.
    pub fn owns(&self, cell: usize) -> bool {
        self.owners[cell] == self.number
    }
}

impl<const D: usize> Extent<D> {
    /// The extent of the cells that a mesh has, be it a part or not.
    pub fn of(mesh: &Mesh<D>) -> Self {
        let [lower, upper] = mesh.own_box();
        Self { lower, upper, mesh_size: mesh.largest_cell_diameter() }
    }
}

/// The numbers of the cells that are taken.
fn numbers_of_taken(is_taken: &[bool]) -> Vec<u32> {
    (0..).zip(is_taken).filter(|(_, taken)| **taken).map(|(cell, _)| cell).collect()
}

impl<const D: usize> Mesh<D> {
    /// A part of the mesh, given the number of the part that owns each cell: the cells of one part, and layers
    /// of others.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` unless there is one owner for each cell and the part owns a cell.
    pub fn part(&self, owners: &[u32], number: u32, layers: Layers) -> Result<Part<D>, MeshError> {
        if owners.len() != self.n_cells() {
            let allowed = format!("one for each of {} cells", self.n_cells());
            return Err(MeshError::parameter("numbers of parts of cells", owners.len(), allowed));
        }
        let mut is_taken: Vec<bool> = owners.iter().map(|&owner| owner == number).collect();
        if !is_taken.contains(&true) {
            let allowed = "the number of a part that owns cells";
            return Err(MeshError::parameter("part of a mesh", number, allowed));
        }
        self.add_layers(&mut is_taken, layers);
        let cells = numbers_of_taken(&is_taken);
        let (mesh, _) = self.submesh(&cells);
        let owners = cells.iter().map(|&cell| owners[cell as usize]).collect();
        let cells = cells.into_iter().map(u64::from).collect();
        Ok(Part { number, mesh, owners, cells, layers })
    }

    /// Adds layers of cells around those taken.
    fn add_layers(&self, is_taken: &mut [bool], Layers { count, across }: Layers) {
        let neighbours = (across == Across::Facets).then(|| Neighbours::new(self));
        for _ in 0..count {
            let taken: Vec<usize> = (0..is_taken.len()).filter(|&cell| is_taken[cell]).collect();
            if let Some(neighbours) = &neighbours {
                for cell in taken {
                    neighbours.cells_across(cell).for_each(|other| is_taken[other] = true);
                }
                continue;
            }
            let mut is_touched = vec![false; self.vertices.len()];
            for cell in taken {
                self.cell(cell).iter().for_each(|&v| is_touched[v as usize] = true);
            }
            for (cell, is_taken) in is_taken.iter_mut().enumerate() {
                *is_taken |= self.cell(cell).iter().any(|&v| is_touched[v as usize]);
            }
        }
    }

    /// The mesh of some cells, ascending, and the number of each of its vertices. Facets between cells of
    /// which only one is taken are in no list and so count as cut.
    fn submesh(&self, cells: &[u32]) -> (Self, Vec<u32>) {
        const UNUSED: u32 = u32::MAX;
        let mut corners = Vec::with_capacity(cells.len() * (D + 1));
        for &cell in cells {
            corners.extend_from_slice(self.cell(cell as usize));
        }
        let mut numbers = vec![UNUSED; self.vertices.len()];
        for &v in &corners {
            numbers[v as usize] = 0;
        }
        let mut vertices = Vec::new();
        for (v, number) in (0..).zip(&mut numbers) {
            if *number != UNUSED {
                *number = vertices.len() as u32;
                vertices.push(v);
            }
        }
        for v in &mut corners {
            *v = numbers[*v as usize];
        }
        let mut positions = vec![UNUSED; self.n_cells()];
        for (position, &cell) in cells.iter().enumerate() {
            positions[cell as usize] = position as u32;
        }
        let facets = self.boundary.iter().filter(|f| positions[f.cell as usize] != UNUSED);
        let moved = |f: &BoundaryFacet| BoundaryFacet { cell: positions[f.cell as usize], ..*f };
        // a mesh with one region has no list of them
        let region = |&cell: &u32| self.cell_regions.get(cell as usize).copied();
        let mesh = Self {
            vertices: vertices.iter().map(|&v| self.vertices[v as usize]).collect(),
            cells: corners,
            boundary: facets.map(moved).collect(),
            is_supported: self.is_supported,
            groups: self.groups.clone(),
            cell_regions: cells.iter().filter_map(region).collect(),
            whole: self.whole.or_else(|| Some(Extent::of(self))),
            shapes: self.shapes_of_part(|cell| positions[cell as usize] != UNUSED, &numbers),
        };
        (mesh, vertices)
    }
}
