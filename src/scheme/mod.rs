//! Schemes: an element, a facet form, a way to impose Dirichlet data and a constraint set. Nothing
//! else.

mod bmmpr;
mod bounded_nodes;
mod br2;
mod cell_means;
mod conforming;
mod conforming_p2;
mod crouzeix_raviart;
mod energy_order;
mod facet_means;
mod iipg;
mod ldg;
mod midpoints;
mod nipg;
mod sipg;
mod theory;
mod wopsip;

pub use bmmpr::Bmmpr;
pub use bounded_nodes::BoundedNodes;
pub use br2::Br2;
pub use cell_means::CellMeans;
pub use conforming::ConformingP1;
pub use conforming_p2::ConformingP2;
pub use crouzeix_raviart::NonconformingP1;
pub use facet_means::FacetMeans;
pub use iipg::Iipg;
pub use ldg::{Ldg, LocalFluxes};
pub use midpoints::Midpoints;
pub(crate) use midpoints::midpoint_orders;
pub use nipg::Nipg;
pub use sipg::Sipg;
pub use theory::{ExpectedOrders, Regularity, Setting};
pub use wopsip::{Eta, Wopsip};

use crate::element::ReferenceElement;
use crate::facet::FacetForm;
use crate::mesh::Mesh;
use crate::real::Real;
use energy_order::{broken_energy_order, energy_order, with_duality};

/// How a scheme imposes Dirichlet data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirichletBy {
    /// Unknowns on the Dirichlet part are fixed at the data.
    Pinning,
    /// The facet form acts on Dirichlet facets, with the data in place of the other side.
    FacetForm,
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
    /// Whether the exact solution satisfies the discrete equations, so that polynomials of the
    /// element's degree are reproduced; [`crate::kit`] holds a scheme to it either way.
    const CONSISTENT: bool = true;
    /// The name users type and reports state.
    fn name(&self) -> &str;
    /// At which nodes it imposes the inequality.
    fn bounded_nodes(&self) -> BoundedNodes {
        BoundedNodes::All
    }
    /// The facet form on a mesh, its parameters resolved.
    fn facet(&self, mesh: &Mesh<T, D>) -> Self::Facet;
    /// Orders that theory proves in this setting; none by default.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let _ = setting;
        ExpectedOrders::default()
    }
}

/// The name of a scheme on linears or on quadratics.
fn name_by_degree(names: [&'static str; 2], degree: usize) -> &'static str {
    names[usize::from(degree > 1)]
}
