//! The mesh: vertices, cells and boundary facets.

use std::ops::Range;
use std::sync::Arc;

use super::boundary::{BoundaryCondition, BoundaryFacet};
use super::geometry::simplex::{fold_edges, longest_edge};
use super::groups::Groups;
use super::part::extent::Extent;
use super::shapes::shape::Shapes;
use crate::parallel::cells;
use crate::real::{Point, box_around};

/// A conforming simplicial mesh of a domain in `D` dimensions (1, 2 or 3).
///
/// # Panics
/// A method that takes the number of a cell panics if the mesh has no such cell.
#[derive(Clone, Debug)]
pub struct Mesh<const D: usize> {
    pub(in crate::mesh) vertices: Vec<Point<D>>,
    pub(in crate::mesh) cells: Vec<u32>,
    pub(in crate::mesh) boundary: Vec<BoundaryFacet>,
    /// Whether every component of the mesh, connected through facets, has a Dirichlet facet.
    pub(in crate::mesh) is_supported: bool,
    /// The names of regions and boundary groups.
    pub(in crate::mesh) groups: Arc<Groups>,
    /// The number of the region of each cell; empty if all cells are in the first.
    pub(in crate::mesh) cell_regions: Vec<u16>,
    /// The extent of the mesh of which this one is a part.
    pub(in crate::mesh) whole: Option<Extent<D>>,
    /// The shapes of boundary groups.
    pub(in crate::mesh) shapes: Shapes<D>,
}

impl<const D: usize> Mesh<D> {
    /// Coordinates of the vertices.
    pub fn vertices(&self) -> &[Point<D>] {
        &self.vertices
    }
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        const { assert!(D >= 1 && D <= 3, "simplices of dimension 1, 2 and 3 only") };
        self.cells.len() / (D + 1)
    }
    /// Vertices of a cell, ascending.
    #[inline(always)]
    pub fn cell(&self, c: usize) -> &[u32] {
        &self.cells[c * (D + 1)..(c + 1) * (D + 1)]
    }
    /// The points of the vertices of a cell, zero beyond the last.
    pub(crate) fn corners(&self, cell: usize) -> [Point<D>; 4] {
        let mut corners = [Point::zeros(); 4];
        for (corner, &v) in corners.iter_mut().zip(self.cell(cell)) {
            *corner = self.vertices[v as usize];
        }
        corners
    }
    /// Vertices of all cells, `D + 1` for each.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }
    /// Facets of the boundary, by cell and number in the cell.
    pub fn boundary(&self) -> &[BoundaryFacet] {
        &self.boundary
    }
    /// Whether this condition holds on some facet of the boundary.
    pub fn has_condition(&self, condition: BoundaryCondition) -> bool {
        self.boundary.iter().any(|f| f.condition == condition)
    }
    /// Whether every component of the mesh, connected through facets, has a Dirichlet facet; of a part, whether
    /// every component of the whole mesh has one.
    pub fn is_supported(&self) -> bool {
        self.is_supported
    }
    /// Vertices of facet `local` of a cell, ascending: `D` of them.
    pub fn facet_vertices(&self, c: usize, local: usize) -> impl Iterator<Item = u32> + '_ {
        self.cell(c).iter().enumerate().filter(move |(i, _)| *i != local).map(|(_, &v)| v)
    }
    /// The number in a cell of a vertex that the cell has.
    pub(crate) fn number_in(&self, c: usize, vertex: u32) -> usize {
        let number = self.cell(c).iter().position(|&v| v == vertex);
        number.expect("the cell has the vertex")
    }
    /// The barycentre of a cell.
    pub fn barycentre(&self, c: usize) -> Point<D> {
        let sum = self
            .cell(c)
            .iter()
            .fold(Point::zeros(), |s: Point<D>, &v| s + self.vertices[v as usize]);
        sum / (D + 1) as f64
    }
    /// The largest distance of two vertices of a cell.
    pub fn cell_diameter(&self, c: usize) -> f64 {
        let cell = self.cell(c);
        longest_edge(|k| self.vertices[cell[k] as usize], None)
    }
    /// The largest ratio of the diameter of a cell to its least height.
    pub(crate) fn largest_aspect(&self) -> f64 {
        let of_cell = |cell: usize| {
            let geometry = self.geometry(cell);
            let largest = (0..D + 1).map(|local| geometry.facet_measure(local)).fold(0.0, f64::max);
            self.cell_diameter(cell) * largest / (D as f64 * geometry.volume)
        };
        (0..self.n_cells()).map(of_cell).fold(0.0, f64::max)
    }
    /// The smallest distance of two vertices of a cell.
    pub fn shortest_edge(&self) -> f64 {
        let shortest_of = |cells: Range<usize>| {
            cells.fold(f64::INFINITY, |shortest, c| {
                let cell = self.cell(c);
                fold_edges(|k| self.vertices[cell[k] as usize], None, shortest, f64::min)
            })
        };
        let shortest = cells::map(self.n_cells(), &shortest_of);
        shortest.into_iter().fold(f64::INFINITY, f64::min).sqrt()
    }
    /// Whether the mesh is a [part](super::Part) of another one.
    pub fn is_part(&self) -> bool {
        self.whole.is_some()
    }
    /// The mesh as a part of one with this extent.
    ///
    /// The mesh size of a part that was refined is not known, because cells of other parts may be larger: it is
    /// found by merging the extents of all parts.
    #[must_use]
    pub fn with_extent(self, whole: Extent<D>) -> Self {
        Self { whole: Some(whole), ..self }
    }
    /// The largest cell diameter; on a part that of the whole mesh.
    pub fn mesh_size(&self) -> f64 {
        match &self.whole {
            Some(whole) => whole.mesh_size,
            None => self.largest_cell_diameter(),
        }
    }
    /// The diagonal of the smallest box around the mesh, on a part around the whole mesh: the length that makes
    /// WOPSIP's penalty factor dimensionless.
    pub fn domain_diameter(&self) -> f64 {
        match &self.whole {
            Some(whole) => whole.diameter(),
            None => {
                let [lower, upper] = self.own_box();
                (upper - lower).norm()
            }
        }
    }
    pub(in crate::mesh) fn largest_cell_diameter(&self) -> f64 {
        (0..self.n_cells()).map(|c| self.cell_diameter(c)).fold(0.0, f64::max)
    }
    /// The ends of the smallest box around the vertices.
    pub(in crate::mesh) fn own_box(&self) -> [Point<D>; 2] {
        box_around(&self.vertices)
    }
}
