//! The symmetric interior penalty method.

use super::{DirichletBy, Scheme, Setting, linear_energy_order};
use crate::element::{Broken, P1};
use crate::facet::{InteriorPenalty, PenaltyRule};
use crate::mesh::Mesh;
use crate::real::Real;
use crate::study::ExpectedOrders;

/// Symmetric interior penalty on broken linears.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Sipg {
    /// How the penalty is chosen; by default the proven bound with a margin of one half.
    pub penalty: PenaltyRule,
}

impl Default for Sipg {
    fn default() -> Self {
        Self { penalty: PenaltyRule::Proven(0.5) }
    }
}

impl<T: Real, const D: usize> Scheme<T, D> for Sipg {
    type Element = Broken<P1>;
    type Facet = InteriorPenalty<-1>;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        "sipg"
    }
    fn facet(&self, _: &Mesh<T, D>) -> InteriorPenalty<-1> {
        InteriorPenalty { rule: self.penalty, degree: 1 }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        linear_energy_order(setting)
    }
}
