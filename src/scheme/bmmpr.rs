//! The method of Brezzi, Manzini, Marini, Pietra and Russo.

use super::{
    DirichletBy, ExpectedOrders, Scheme, Setting, broken_energy_order, name_by_degree, with_duality,
};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{FacetLifts, Lifted};
use crate::mesh::Mesh;
use crate::real::Real;

/// `int alpha (grad u + r(u)) . (grad v + r(v))` with a penalty by the lifts of single facets, on
/// broken elements: coercive for every positive factor.
///
/// Source: F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer. Methods Partial
/// Differential Equations 16 (2000), 365-378.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Bmmpr<E = P1> {
    /// The factor of the penalty; by default one.
    pub eta: f64,
    /// The element whose broken version it is on.
    pub element: E,
}

impl Default for Bmmpr {
    fn default() -> Self {
        Self { eta: 1.0, element: P1 }
    }
}

impl<E> Bmmpr<E> {
    /// The same on the broken version of another element: `Bmmpr::default().on(P2)`.
    pub fn on<F>(self, element: F) -> Bmmpr<F> {
        Bmmpr { eta: self.eta, element }
    }
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Scheme<T, D> for Bmmpr<E> {
    type Element = Broken<E>;
    type Facet = Lifted<FacetLifts>;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_by_degree(["bmmpr", "bmmpr-p2"], E::DEGREE)
    }
    fn facet(&self, _: &Mesh<T, D>) -> Lifted<FacetLifts> {
        Lifted(FacetLifts { eta: self.eta, degree: E::DEGREE, bounded: false })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, E::DEGREE), setting)
    }
}
