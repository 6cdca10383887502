//! An over-penalty that does not know the coefficient: what the harmonic mean is good for.

use crate::element::{Broken, P1};
use crate::facet::{FacetForm, FacetView, OverPenalty, Trace};
use crate::mesh::Mesh;
use crate::real::Real;
use crate::scheme::{DirichletBy, Scheme, Wopsip};

/// `eta / h_F^3`, whatever the coefficient. Shown beside the library's own choice, and for nothing
/// else: it fails where coefficients are not of size one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Blind(pub Wopsip);

/// Its form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlindPenalty(OverPenalty);

impl<T: Real, const D: usize> FacetForm<T, D> for BlindPenalty {
    fn moments(&self, degree: usize) -> usize {
        FacetForm::<T, D>::moments(&self.0, degree)
    }
    #[inline(always)]
    fn penalty(&self, facet: &FacetView<T, D>) -> T {
        self.0.penalty(facet) / facet.coefficient()
    }
    #[inline(always)]
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T {
        penalty * u.jump * v.jump
    }
}

impl<T: Real, const D: usize> Scheme<T, D> for Blind {
    type Element = Broken<P1>;
    type Facet = BlindPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    const CONSISTENT: bool = false;

    fn name(&self) -> &str {
        "wopsip"
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> BlindPenalty {
        BlindPenalty(Scheme::<T, D>::facet(&self.0, mesh))
    }
}
