//! A reference element without its type.

use super::tables::BasisAt;
use crate::element::{Layout, Node, ReferenceElement};

/// What the assembler reads of a reference element, except in the loops over shared rows.
pub(crate) struct AnyElement {
    /// Largest degree of which the element contains all polynomials.
    pub degree: usize,
    /// Largest degree of a basis function.
    pub basis_degree: usize,
    /// Who owns the unknowns.
    pub layout: Layout,
    /// What each unknown is the value of.
    pub nodes: Vec<Node>,
    /// The basis at a point of the cell.
    pub basis: fn(&[f64; 4]) -> BasisAt,
}

impl AnyElement {
    /// The facts of an element over `T` on the `D`-simplex.
    pub fn of<E: ReferenceElement<D>, const D: usize>() -> Self {
        Self {
            degree: E::DEGREE,
            basis_degree: E::BASIS_DEGREE,
            layout: E::LAYOUT,
            nodes: (0..E::N).map(E::node).collect(),
            basis: BasisAt::new::<E, D>,
        }
    }
}
