//! Interior penalty without symmetry.

use unilateral::facet::InteriorPenalty;
use unilateral::prelude::*;

/// The non-symmetric form for 1, the incomplete one for 0, with `factor / h_F`.
pub struct Family<const THETA: i8> {
    pub factor: f64,
}

impl<T: Real, const D: usize, const THETA: i8> Scheme<T, D> for Family<THETA> {
    type Element = Broken<P1>;
    type Facet = InteriorPenalty<THETA>;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    fn name(&self) -> &str {
        if THETA == 1 { "nipg" } else { "iipg" }
    }
    fn facet(&self, _: &Mesh<T, D>) -> InteriorPenalty<THETA> {
        InteriorPenalty { rule: PenaltyRule::Diameter(self.factor), degree: 1 }
    }
}
