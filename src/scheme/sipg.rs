//! The symmetric interior penalty method.

use super::{
    DirichletBy, ExpectedOrders, Scheme, Setting, broken_energy_order, name_by_degree, with_duality,
};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;
use crate::real::Real;

/// Symmetric interior penalty on broken elements.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Sipg<E = P1> {
    /// How the penalty is chosen; by default the proven bound with a margin of one half.
    pub penalty: PenaltyRule,
    /// The element whose broken version it is on.
    pub element: E,
}

impl Default for Sipg {
    fn default() -> Self {
        Self { penalty: PenaltyRule::Proven(0.5), element: P1 }
    }
}

impl<E> Sipg<E> {
    /// The same on the broken version of another element: `Sipg::default().on(P2)`.
    pub fn on<F>(self, element: F) -> Sipg<F> {
        Sipg { penalty: self.penalty, element }
    }
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Scheme<T, D> for Sipg<E> {
    type Element = Broken<E>;
    type Facet = InteriorPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_by_degree(["sipg", "sipg-p2"], E::DEGREE)
    }
    fn facet(&self, _: &Mesh<T, D>) -> InteriorPenalty {
        InteriorPenalty { symmetry: Symmetry::Symmetric, rule: self.penalty, degree: E::DEGREE }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, E::DEGREE), setting)
    }
}
