//! The discontinuous version of any element.

use std::sync::Arc;

use super::basis::Basis;
use super::definition::{Element, Layout};
use super::node::Node;

/// The basis of `E` with all unknowns inside the cells.
///
/// `Broken(P1)` and `Broken(CrouzeixRaviart)` span the same space, in the bases of vertex values and
/// of facet means; the basis determines the functionals on which a scheme can impose bounds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Broken<E>(pub E);

impl<const D: usize, E: Element<D>> Element<D> for Broken<E> {
    fn degree(&self) -> usize {
        self.0.degree()
    }
    fn basis_degree(&self) -> usize {
        self.0.basis_degree()
    }
    fn layout(&self) -> Layout {
        Layout::in_cells(self.0.layout().per_cell(D))
    }
    fn node(&self, i: usize) -> Node {
        self.0.node(i)
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        self.0.values(lambda, out);
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        self.0.derivatives(lambda, out);
    }
    fn in_basis(&self, basis: Basis, _: bool) -> Option<Arc<dyn Element<D>>> {
        self.0.in_basis(basis, true)
    }
}
