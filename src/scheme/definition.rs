//! What a scheme is.

use crate::element::ReferenceElement;
use crate::facet::{DirichletBy, FacetForm};
use crate::mesh::Mesh;

use super::SchemeOptions;
use crate::theory::{ExpectedOrders, Setting};

/// A discretisation of the bilinear form and of Dirichlet data.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scheme on {D}-simplices",
    note = "a scheme is an element, a facet form and a way to impose Dirichlet data: implement `Scheme<{D}>`, see examples/my_scheme.rs"
)]
pub trait Scheme<const D: usize>: Send + Sync {
    /// The finite element.
    type Element: ReferenceElement<D>;
    /// The form on facets; [`NoFacets`](crate::facet::NoFacets) if there is none.
    type Facet: FacetForm<D>;
    /// How Dirichlet data are imposed.
    const DIRICHLET: DirichletBy;
    /// Whether the exact solution satisfies the discrete equations, so that polynomials of the
    /// element's degree are reproduced; [`crate::kit`] holds a scheme to it either way.
    const CONSISTENT: bool = true;
    /// The name users type and reports state. Two schemes of a study must differ in it or in their
    /// [choices](Self::choices): a scheme with parameters puts them into one of the two.
    fn name(&self) -> &str;
    /// What distinguishes the scheme from the default one of its name, for its label in reports; nothing
    /// by default.
    fn choices(&self) -> SchemeOptions {
        SchemeOptions::default()
    }
    /// The facet form on a mesh, its parameters resolved.
    fn facet(&self, mesh: &Mesh<D>) -> Self::Facet;
    /// Orders that theory proves in this setting, with bounds at all nodes; none by default.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let _ = setting;
        ExpectedOrders::default()
    }
}
