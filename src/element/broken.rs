//! The discontinuous version of any element.

use super::basis::Basis;
use super::node::Node;
use super::reference_element::{ElementVisitor, Layout, ReferenceElement};

/// The basis of `E` with all unknowns inside the cells.
///
/// `Broken<P1>` and `Broken<CrouzeixRaviart>` span the same space, in the bases of vertex values and
/// of facet means; the basis determines the functionals on which a scheme can impose bounds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Broken<E>(pub E);

impl<const D: usize, E: ReferenceElement<D>> ReferenceElement<D> for Broken<E> {
    const N: usize = E::N;
    const DEGREE: usize = E::DEGREE;
    const BASIS_DEGREE: usize = E::BASIS_DEGREE;
    const LAYOUT: Layout = Layout::in_cells(E::N);

    #[inline(always)]
    fn values(lambda: &[f64], out: &mut [f64]) {
        E::values(lambda, out);
    }
    #[inline(always)]
    fn derivatives(lambda: &[f64], out: &mut [[f64; 4]]) {
        E::derivatives(lambda, out);
    }
    fn node(i: usize) -> Node {
        E::node(i)
    }
    fn broken_in_basis<V: ElementVisitor<D>>(basis: Basis, visitor: V) -> Option<V::Output> {
        E::broken_in_basis(basis, visitor)
    }
}
