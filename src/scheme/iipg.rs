//! The incomplete interior penalty method.

use super::{DirichletBy, ExpectedOrders, Scheme, Setting, broken_energy_order, name_by_degree};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;
use crate::real::Real;

/// Incomplete interior penalty on broken elements: consistent, without a symmetrising term.
///
/// Source: C. Dawson, S. Sun, M. F. Wheeler, Comput. Methods Appl. Mech. Engrg. 193 (2004),
/// 2565-2580. Orders by the argument of F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48
/// (2010), 708-733, which asks for consistency and coercivity only.
#[derive(Clone, Copy, Debug)]
pub struct Iipg<E = P1> {
    /// How the penalty is chosen; by default the proven bound, a quarter of the symmetric one, with a margin of one half.
    pub penalty: PenaltyRule,
    /// The element whose broken version it is on.
    pub element: E,
}

impl Default for Iipg {
    fn default() -> Self {
        Self { penalty: PenaltyRule::Proven(0.5), element: P1 }
    }
}

impl<E> Iipg<E> {
    /// The same on the broken version of another element: `Iipg::default().on(P2)`.
    pub fn on<F>(self, element: F) -> Iipg<F> {
        Iipg { penalty: self.penalty, element }
    }
}

impl<T: Real, const D: usize, E: ReferenceElement<T, D>> Scheme<T, D> for Iipg<E> {
    type Element = Broken<E>;
    type Facet = InteriorPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_by_degree(["iipg", "iipg-p2"], E::DEGREE)
    }
    fn facet(&self, _: &Mesh<T, D>) -> InteriorPenalty {
        InteriorPenalty { symmetry: Symmetry::Incomplete, rule: self.penalty, degree: E::DEGREE }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        broken_energy_order(setting, E::DEGREE)
    }
}
