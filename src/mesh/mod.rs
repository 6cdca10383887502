//! Simplicial meshes in one, two and three dimensions.
//!
//! # Conventions
//!
//! * The vertices of a cell are listed in ascending global number. Facet `i` of a cell is opposite
//!   its vertex `i`; its vertices are the others, still ascending. So both cells of a facet see its
//!   vertices in the same order, and no orientation is ever stored.
//! * Barycentric coordinate `i` of a cell has gradient `g_i`; the outward normal of facet `i` is
//!   `-g_i / |g_i|`, the height over it `1 / |g_i|`, its measure `D |K| |g_i|`. In one dimension a
//!   facet is a vertex and its measure is one.
//! * A mesh is immutable once made, and what [`Mesh::new`] accepts carries a finite element space.

mod domain;
mod edges;
mod error;
mod facets;
mod geometry;
pub mod gmsh;
mod refine;
mod sweep;
mod validate;

pub use domain::{BoxDomain, Domain};
pub use edges::{EDGE_VERTICES, Edges, edge_vertices};
pub use error::MeshError;
pub use facets::{Facets, Neighbour, Neighbours};
pub use geometry::CellGeometry;
pub use refine::Refinement;
pub use validate::TaggedFacet;
pub(crate) use validate::describe_point;

use crate::real::{Point, Real, point_f64};

/// The part of the boundary a facet belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BoundaryPart {
    /// Values are given.
    Dirichlet,
    /// The flux is given.
    Neumann,
    /// The Signorini condition holds.
    Contact,
}

impl BoundaryPart {
    /// The name of the physical group in a mesh file.
    pub fn name(self) -> &'static str {
        match self {
            BoundaryPart::Dirichlet => "dirichlet",
            BoundaryPart::Neumann => "neumann",
            BoundaryPart::Contact => "contact",
        }
    }
    /// The part a physical group names.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Dirichlet, Self::Neumann, Self::Contact].into_iter().find(|p| p.name() == name)
    }
}

/// A facet of the boundary: its cell, its number in the cell, its part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// The cell.
    pub cell: u32,
    /// The facet is opposite this vertex of the cell.
    pub local: u8,
    /// The part of the boundary.
    pub part: BoundaryPart,
}

/// A conforming simplicial mesh of a domain in `D` dimensions (1, 2 or 3).
#[derive(Clone, Debug)]
pub struct Mesh<T, const D: usize> {
    vertices: Vec<Point<T, D>>,
    cells: Vec<u32>,
    boundary: Vec<BoundaryFacet>,
}

impl<T: Real, const D: usize> Mesh<T, D> {
    /// Number of vertices of a cell.
    pub const CELL_VERTICES: usize = {
        assert!(D >= 1 && D <= 3, "simplices of dimension 1, 2 and 3 only");
        D + 1
    };

    /// Coordinates of the vertices.
    pub fn vertices(&self) -> &[Point<T, D>] {
        &self.vertices
    }
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.cells.len() / Self::CELL_VERTICES
    }
    /// Vertices of a cell, ascending.
    #[inline(always)]
    pub fn cell(&self, c: usize) -> &[u32] {
        &self.cells[c * Self::CELL_VERTICES..(c + 1) * Self::CELL_VERTICES]
    }
    /// Vertices of all cells, `D + 1` for each.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }
    /// Facets of the boundary, by cell and number in the cell.
    pub fn boundary(&self) -> &[BoundaryFacet] {
        &self.boundary
    }
    /// Whether some facet belongs to a part of the boundary.
    pub fn has_part(&self, part: BoundaryPart) -> bool {
        self.boundary.iter().any(|f| f.part == part)
    }
    /// Vertices of facet `local` of a cell, ascending: `D` of them.
    pub fn facet_vertices(&self, c: usize, local: usize) -> impl Iterator<Item = u32> + '_ {
        self.cell(c).iter().enumerate().filter(move |(i, _)| *i != local).map(|(_, &v)| v)
    }
    /// The barycentre of a cell.
    pub fn barycentre(&self, c: usize) -> Point<T, D> {
        let sum = self
            .cell(c)
            .iter()
            .fold(Point::zeros(), |s: Point<T, D>, &v| s + self.vertices[v as usize]);
        sum / T::lit(Self::CELL_VERTICES as f64)
    }
    /// The largest distance of two vertices of a cell.
    pub fn cell_diameter(&self, c: usize) -> T {
        let cell = self.cell(c);
        let mut largest = T::lit(0.0);
        for (i, &a) in cell.iter().enumerate() {
            for &b in &cell[..i] {
                let d = (self.vertices[a as usize] - self.vertices[b as usize]).norm_squared();
                largest = if d > largest { d } else { largest };
            }
        }
        nalgebra::ComplexField::sqrt(largest)
    }
    /// The smallest distance of two vertices of a cell.
    pub fn shortest_edge(&self) -> f64 {
        let mut shortest = f64::INFINITY;
        for cell in self.cells.chunks_exact(D + 1) {
            for (i, &a) in cell.iter().enumerate() {
                for &b in &cell[..i] {
                    let edge = self.vertices[a as usize] - self.vertices[b as usize];
                    shortest = shortest.min(edge.norm_squared().to_f64());
                }
            }
        }
        shortest.sqrt()
    }
    /// The largest cell diameter.
    pub fn mesh_size(&self) -> f64 {
        (0..self.n_cells()).map(|c| self.cell_diameter(c).to_f64()).fold(0.0, f64::max)
    }
    /// The diagonal of the smallest box around the mesh: the length that makes WOPSIP's penalty
    /// factor dimensionless.
    pub fn domain_diameter(&self) -> f64 {
        let first = point_f64(&self.vertices[0]);
        let (mut low, mut high) = (first, first);
        for x in &self.vertices {
            let x = point_f64(x);
            low = low.zip_map(&x, f64::min);
            high = high.zip_map(&x, f64::max);
        }
        (high - low).norm()
    }
}
