//! Reference elements on simplices, in barycentric coordinates.

mod broken;
mod crouzeix_raviart;
#[cfg(test)]
mod laws;
mod p1;
mod p2;
mod quadratic_cell_mean;

pub use broken::Broken;
pub use crouzeix_raviart::CrouzeixRaviart;
pub use p1::P1;
pub use p2::P2;
pub use quadratic_cell_mean::QuadraticCellMean;

use crate::real::Real;

/// Largest number of basis functions of an element: quadratics on a tetrahedron.
pub const MAX_BASIS: usize = 10;

/// Unknowns owned by each vertex, edge, facet and cell: all that sets a space apart from its broken
/// or conforming relatives.
///
/// A cell lists its unknowns in this order. Edges are not facets, also where the two coincide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Unknowns at each vertex; vertex `i` of the cell comes `i`-th.
    pub vertex: usize,
    /// Unknowns on each edge, in the order of [`edge_vertices`](crate::mesh::edge_vertices).
    pub edge: usize,
    /// Unknowns on each facet; the facet opposite vertex `i` comes `i`-th.
    pub facet: usize,
    /// Unknowns in each cell, shared with no other.
    pub cell: usize,
}

impl Layout {
    /// All unknowns in the cells.
    pub const fn in_cells(cell: usize) -> Self {
        Self { vertex: 0, edge: 0, facet: 0, cell }
    }
    /// Whether no two cells share an unknown.
    pub const fn is_broken(&self) -> bool {
        self.vertex == 0 && self.edge == 0 && self.facet == 0
    }
    /// Number of unknowns of a cell of this dimension.
    pub const fn per_cell(&self, dimension: usize) -> usize {
        let edges = dimension * (dimension + 1) / 2;
        (self.vertex + self.facet) * (dimension + 1) + self.edge * edges + self.cell
    }
}

/// What an unknown is the value of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// The value at a vertex of the cell.
    Vertex(usize),
    /// The value at the midpoint of an edge of the cell, in the order of
    /// [`edge_vertices`](crate::mesh::edge_vertices).
    Edge(usize),
    /// The mean over the facet opposite a vertex of the cell.
    FacetMean(usize),
    /// The mean over the cell.
    CellMean,
}

/// A finite element on the `D`-simplex.
///
/// Laws, which a test holds every element to: nodes dual to basis functions, partition of unity,
/// derivatives consistent with values, as many functions as the layout owns.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a finite element on a {D}-simplex over `{T}`",
    note = "elements exist on simplices of dimension 1, 2 and 3"
)]
pub trait ReferenceElement<T: Real, const D: usize>: Copy + Send + Sync + 'static {
    /// Number of basis functions, at most [`MAX_BASIS`].
    const N: usize;
    /// Polynomial degree.
    const DEGREE: usize;
    /// Who owns the unknowns.
    const LAYOUT: Layout;
    /// Whether this library has compiled the assembly of the element's shared unknowns; no other
    /// crate sets it.
    #[doc(hidden)]
    const COMPILED: bool = false;
    /// Writes the `N` basis functions at a point; `lambda` has `D + 1` entries.
    fn values(lambda: &[T], out: &mut [T]);
    /// Writes the derivatives of the `N` basis functions with respect to the `D + 1` barycentric
    /// coordinates, taken as independent.
    fn derivatives(lambda: &[T], out: &mut [[T; 4]]);
    /// What unknown `i` is the value of.
    fn node(i: usize) -> Node;
}
