//! The second method of Bassi and Rebay.

use super::{
    DirichletBy, ExpectedOrders, Scheme, Setting, broken_energy_order, name_by_degree, with_duality,
};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::FacetLifts;
use crate::mesh::Mesh;
use crate::real::Real;

/// Penalty by the lifts of single facets, on broken elements.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Br2<E = P1> {
    /// The factor of the penalty; where absent three halves of the number of facets of a cell,
    /// above which the form is coercive.
    pub eta: Option<f64>,
    /// The element whose broken version it is on.
    pub element: E,
}

impl Default for Br2 {
    fn default() -> Self {
        Self { eta: None, element: P1 }
    }
}

impl<E> Br2<E> {
    /// The same on the broken version of another element: `Br2::default().on(P2)`.
    pub fn on<F>(self, element: F) -> Br2<F> {
        Br2 { eta: self.eta, element }
    }
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Scheme<T, D> for Br2<E> {
    type Element = Broken<E>;
    type Facet = FacetLifts;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_by_degree(["br2", "br2-p2"], E::DEGREE)
    }
    fn facet(&self, _: &Mesh<T, D>) -> FacetLifts {
        let eta = self.eta.unwrap_or(1.5 * (D + 1) as f64);
        FacetLifts { eta, degree: E::DEGREE, bounded: true }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, E::DEGREE), setting)
    }
}
