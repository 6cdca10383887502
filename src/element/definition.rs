//! The trait of elements.

use std::fmt::Debug;
use std::sync::Arc;

use super::basis::Basis;
use super::node::Node;

/// Largest number of basis functions of an element: cubics on a tetrahedron.
pub const MAX_BASIS: usize = 20;

/// Number of unknowns at each vertex, edge and facet, shared by the cells that contain it, and inside
/// each cell. The layout distinguishes conforming, nonconforming and broken spaces with one basis.
///
/// A cell lists its unknowns in the order of the fields. In two dimensions edges and facets are the
/// same sets, but `edge` and `facet` count separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Unknowns at each vertex; those of vertex `i` of the cell come `i`-th.
    pub vertex: usize,
    /// Unknowns on each edge. Edges are ordered by their second vertex: `(0, 1)`, `(0, 2)`, `(1, 2)`, `(0, 3)`, `(1, 3)`, `(2, 3)`,
    /// of which a segment has the first and a triangle the first three.
    pub edge: usize,
    /// Unknowns on each facet; those of the facet opposite vertex `i` come `i`-th.
    pub facet: usize,
    /// Unknowns inside each cell.
    pub cell: usize,
}

impl Layout {
    /// All unknowns inside the cells.
    pub const fn in_cells(cell: usize) -> Self {
        Self { vertex: 0, edge: 0, facet: 0, cell }
    }
    /// Whether no two cells share an unknown.
    pub const fn is_broken(&self) -> bool {
        self.vertex == 0 && self.edge == 0 && self.facet == 0
    }
    /// Number of unknowns of a cell of this dimension.
    pub const fn per_cell(&self, dimension: usize) -> usize {
        // destructured, so that a field added later is counted here too
        let Self { vertex, edge, facet, cell } = *self;
        let edges = dimension * (dimension + 1) / 2;
        (vertex + facet) * (dimension + 1) + edge * edges + cell
    }
}

/// A finite element on the `D`-simplex, which is tabulated once for each discretisation.
///
/// Laws, tested by [`check_element`](crate::kit::check_element): nodes dual to basis functions,
/// partition of unity, polynomials of its [degree](Self::degree) in the span, basis functions of its
/// [basis degree](Self::basis_degree) at most, derivatives equal to those of the values, nodes tied to
/// the entities that own the unknowns.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a finite element on a {D}-simplex",
    note = "elements exist on simplices of dimension 1, 2 and 3"
)]
pub trait Element<const D: usize>: Debug + Send + Sync {
    /// Largest degree of which the span of the basis contains all polynomials: what the element
    /// reproduces and what determines the orders of convergence.
    fn degree(&self) -> usize;
    /// Largest degree of a basis function, from which the rules for integrals of the basis follow.
    /// It differs from the [degree](Self::degree) where the basis has more than the polynomials of
    /// that degree: it is `D + 1` for linears with a bubble that vanishes on the boundary of the cell.
    fn basis_degree(&self) -> usize {
        self.degree()
    }
    /// Unknowns at vertices, edges, facets and inside cells: as many as there are basis functions,
    /// at most 20 in a cell.
    fn layout(&self) -> Layout;
    /// The functional that unknown `i` is the value of.
    fn node(&self, i: usize) -> Node;
    /// Writes the basis functions at a point; `lambda` has `D + 1` entries, `out` as many as there are
    /// functions.
    fn values(&self, lambda: &[f64], out: &mut [f64]);
    /// Writes the derivatives of the basis functions with respect to the `D + 1` barycentric
    /// coordinates, taken as independent; entries beyond these are zero already.
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]);
    /// The element of the same functions that has this basis, of the discontinuous ones if the element
    /// `is_broken`; none if the element knows no such basis. [`Broken`](super::Broken) asks the element
    /// inside.
    fn in_basis(&self, basis: Basis, is_broken: bool) -> Option<Arc<dyn Element<D>>> {
        let _ = (basis, is_broken);
        None
    }
}

impl<const D: usize> dyn Element<D> + '_ {
    /// Number of basis functions.
    pub fn per_cell(&self) -> usize {
        self.layout().per_cell(D)
    }
    /// The functional of each unknown.
    pub fn nodes(&self) -> Vec<Node> {
        (0..self.per_cell()).map(|i| self.node(i)).collect()
    }
}
