//! An over-penalty without the coefficient, to show the effect of the harmonic mean.

use crate::element::{Broken, P1};
use crate::facet::{FacetForm, FacetView, OverPenalty, Trace};
use crate::mesh::Mesh;
use crate::scheme::{DirichletBy, Scheme, Wopsip};

/// WOPSIP with the penalty `eta / h_F^3` for every coefficient, for comparison with the default:
/// the scheme fails for coefficients that are not of size one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct UnweightedWopsip(pub Wopsip);

/// The form of [`UnweightedWopsip`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnweightedPenalty(OverPenalty);

impl<const D: usize> FacetForm<D> for UnweightedPenalty {
    fn uses_flux(&self) -> bool {
        false
    }
    fn moments(&self, degree: usize) -> usize {
        FacetForm::<D>::moments(&self.0, degree)
    }
    #[inline(always)]
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        self.0.penalty(facet) / facet.coefficient()
    }
    fn is_uniform(&self) -> bool {
        true
    }
    #[inline(always)]
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump
    }
}

impl<const D: usize> Scheme<D> for UnweightedWopsip {
    type Element = Broken<P1>;
    type Facet = UnweightedPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    const CONSISTENT: bool = false;

    fn name(&self) -> &str {
        "wopsip"
    }
    fn facet(&self, mesh: &Mesh<D>) -> UnweightedPenalty {
        UnweightedPenalty(Scheme::<D>::facet(&self.0, mesh))
    }
}
