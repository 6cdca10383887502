//! Conforming linear elements.

use super::{DirichletBy, ExpectedOrders, Scheme, Setting, energy_order, with_duality};
use crate::element::P1;
use crate::facet::NoFacets;
use crate::mesh::Mesh;
use crate::real::Real;

/// Continuous piecewise linears, bounds at vertices, Dirichlet values pinned.
///
/// Orders: R. S. Falk, Math. Comp. 28 (1974), 963-971 and F. Brezzi, W. W. Hager, P.-A. Raviart,
/// Numer. Math. 28 (1977), 431-443 for obstacles; G. Drouet, P. Hild, SIAM J. Numer. Anal. 53 (2015),
/// 1488-1507 for Signorini.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConformingP1;

impl<T: Real, const D: usize> Scheme<T, D> for ConformingP1 {
    type Element = P1;
    type Facet = NoFacets;
    const DIRICHLET: DirichletBy = DirichletBy::Pinning;

    fn name(&self) -> &str {
        "p1"
    }
    fn facet(&self, _: &Mesh<T, D>) -> NoFacets {
        NoFacets
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(energy_order(setting, 1), setting)
    }
}
