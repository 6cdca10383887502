//! Schemes: an element, a facet form and a way to impose Dirichlet data. Nothing else.

mod conforming;
mod crouzeix_raviart;
mod facet_means;
mod orders;
mod sipg;
mod wopsip;

pub use conforming::ConformingP1;
pub use crouzeix_raviart::CrouzeixRaviartScheme;
pub use facet_means::FacetMeans;
pub use sipg::Sipg;
pub use wopsip::{Eta, Wopsip};

use crate::element::ReferenceElement;
use crate::facet::FacetForm;
use crate::mesh::Mesh;
use crate::real::Real;
use crate::scenes::Regularity;
use crate::study::ExpectedOrders;
use orders::{linear_energy_order, with_duality};

/// How a scheme imposes Dirichlet data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirichletBy {
    /// Unknowns on the Dirichlet part are fixed at the data.
    Pinning,
    /// The facet form acts on Dirichlet facets, with the data in place of the other side.
    FacetForm,
}

/// What a promise of orders may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Dimension of space.
    pub dimension: usize,
    /// Whether an obstacle binds in the domain.
    pub obstacle: bool,
    /// Whether a Signorini condition binds on the boundary.
    pub contact: bool,
    /// What is known of the solution.
    pub regularity: Regularity,
    /// Whether the dual of the linear problem has solutions in `H^2`: with a coefficient that does
    /// not vary, on intervals and on convex domains with Dirichlet data on the whole boundary.
    pub regular_dual: bool,
}

impl Setting {
    /// Whether no inequality binds.
    pub fn is_linear(&self) -> bool {
        !self.obstacle && !self.contact
    }
}

/// A discretisation of the bilinear form and of Dirichlet data.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scheme on {D}-simplices over `{T}`",
    note = "a scheme is an element, a facet form and a way to impose Dirichlet data: implement `Scheme<{T}, {D}>`, see examples/my_scheme.rs"
)]
pub trait Scheme<T: Real, const D: usize>: Send + Sync {
    /// The finite element.
    type Element: ReferenceElement<T, D>;
    /// The form on facets; [`NoFacets`](crate::facet::NoFacets) if there is none.
    type Facet: FacetForm<T, D>;
    /// How Dirichlet data are imposed.
    const DIRICHLET: DirichletBy;
    /// The name users type and reports state.
    fn name(&self) -> &str;
    /// The facet form on a mesh, its parameters resolved.
    fn facet(&self, mesh: &Mesh<T, D>) -> Self::Facet;
    /// Orders that theory proves in this setting; none by default.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let _ = setting;
        ExpectedOrders::default()
    }
}
