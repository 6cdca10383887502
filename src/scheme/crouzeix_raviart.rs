//! Non-conforming linear elements.

use std::sync::Arc;

use super::{ExpectedOrders, Scheme, Setting, broken_energy_order, with_duality};
use crate::element::{CrouzeixRaviart, Element};

/// Piecewise linears with continuous facet means, bounds on those means, Dirichlet means pinned.
///
/// Orders: L.-H. Wang, J. Comput. Math. 21 (2003), 481-490 for obstacles; D. Y. Hua, L. H. Wang,
/// J. Comput. Math. 17 (1999), 15-24 for Signorini.
#[derive(Clone, Copy, Debug, Default)]
pub struct NonconformingP1;

impl<const D: usize> Scheme<D> for NonconformingP1 {
    fn name(&self) -> &str {
        "cr"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(CrouzeixRaviart)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        match setting.friction {
            // nothing is proven
            true => ExpectedOrders::default(),
            false => with_duality(broken_energy_order(setting, 1), setting),
        }
    }
}
