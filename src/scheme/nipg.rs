//! The non-symmetric interior penalty method.

use super::{DirichletBy, ExpectedOrders, Scheme, Setting, broken_energy_order, name_by_degree};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;
use crate::real::Real;

/// Non-symmetric interior penalty on broken elements: coercive for every positive penalty.
///
/// Source: B. Riviere, M. F. Wheeler, V. Girault, Comput. Geosci. 3 (1999), 337-360.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Nipg<E = P1> {
    /// How the penalty is chosen; by default the coefficient over the diameter of the facet.
    pub penalty: PenaltyRule,
    /// The element whose broken version it is on.
    pub element: E,
}

impl Default for Nipg {
    fn default() -> Self {
        Self { penalty: PenaltyRule::Diameter(1.0), element: P1 }
    }
}

impl<E> Nipg<E> {
    /// The same on the broken version of another element: `Nipg::default().on(P2)`.
    pub fn on<F>(self, element: F) -> Nipg<F> {
        Nipg { penalty: self.penalty, element }
    }
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Scheme<T, D> for Nipg<E> {
    type Element = Broken<E>;
    type Facet = InteriorPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_by_degree(["nipg", "nipg-p2"], E::DEGREE)
    }
    fn facet(&self, _: &Mesh<T, D>) -> InteriorPenalty {
        InteriorPenalty { symmetry: Symmetry::NonSymmetric, rule: self.penalty, degree: E::DEGREE }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        broken_energy_order(setting, E::DEGREE)
    }
}
