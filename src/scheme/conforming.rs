//! Conforming elements.

use std::sync::Arc;

use super::{ExpectedOrders, Scheme, Setting, energy_order, with_duality};
use crate::element::{Element, P1, P2};

/// Continuous piecewise linears, bounds at vertices, Dirichlet values pinned.
///
/// Orders: R. S. Falk, Math. Comp. 28 (1974), 963-971 and F. Brezzi, W. W. Hager, P.-A. Raviart,
/// Numer. Math. 28 (1977), 431-443 for obstacles; G. Drouet, P. Hild, SIAM J. Numer. Anal. 53 (2015),
/// 1488-1507 for Signorini.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConformingP1;

impl<const D: usize> Scheme<D> for ConformingP1 {
    fn name(&self) -> &str {
        "p1"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(P1)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(energy_order(setting, 1), setting)
    }
}

/// Continuous piecewise quadratics, bounds at all nodes, Dirichlet values pinned.
///
/// [`Midpoints`](crate::constraint::Midpoints) binds midpoints of edges only.
///
/// Orders in the energy norm, for a solution in `H^s`: `min(s - 1, 2)` by interpolation where no
/// inequality binds; with an obstacle `min(s - 1, 3/2)` (F. Brezzi, W. W. Hager, P.-A. Raviart,
/// Numer. Math. 28 (1977), 431-443; L.-H. Wang, Numer. Math. 92 (2002), 771-778), for which a
/// function that is not negative at the nodes must have no negative mean over a cell: true on
/// segments and triangles, false on tetrahedra, where the weights of vertices are negative
/// (S. Gaddam, T. Gudi, Comput. Methods Appl. Math. 18 (2018), 223-236, add bubbles there); with a
/// Signorini condition `min(s - 1, 3/2)` (Z. Belhachmi, F. Ben Belgacem, Math. Comp. 72 (2003),
/// 83-104; G. Drouet, P. Hild, SIAM J. Numer. Anal. 53 (2015), 1488-1507).
#[derive(Clone, Copy, Debug, Default)]
pub struct ConformingP2;

impl<const D: usize> Scheme<D> for ConformingP2 {
    fn name(&self) -> &str {
        "p2"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(P2)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(energy_order(setting, 2), setting)
    }
}
