//! Bounds on Bernstein coefficients.

use super::constraint_set::{BoundBy, ConstraintSet};
use crate::element::{Basis, Node};

/// The Bernstein coefficients of quadratics are bound by those of the obstacle or gap, interpolated at vertices and
/// midpoints: the solution respects the interpolant at every point, not at nodes alone. On a contact facet these are
/// the coefficients of the trace.
///
/// Quadratics change to the basis of Bernstein; space, form and Dirichlet data stay. The functions with such
/// coefficients are some of those that respect the interpolant: a quadratic may be positive where a coefficient is
/// negative. No order is proven for this set under an inequality; it is measured.
///
/// Source: R. C. Kirby, D. Shapero, arXiv 2311.05880, on coefficients that imply bounds everywhere. The set of
/// [`Nodes`](super::Nodes) is that of G. R. Barrenechea, E. H. Georgoulis, T. Pryer, A. Veeser, IMA J. Numer. Anal. 44
/// (2024), 2198-2219, on bounds at nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bernstein;

impl ConstraintSet for Bernstein {
    fn name(&self) -> &str {
        "bernstein"
    }
    fn basis(&self) -> Option<Basis> {
        Some(Basis::Bernstein)
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        node.is_coefficient().then_some(BoundBy::Functional)
    }
}
