//! Schemes on broken elements.

use std::fmt::Debug;
use std::sync::Arc;

use super::{ExpectedOrders, Scheme, SchemeOptions, Setting};
use crate::element::{Broken, Element, P1};
use crate::facet::FacetForm;
use crate::mesh::Mesh;

/// A scheme on broken elements: parameters, and the form on facets that they make for an element.
///
/// As it stands it is a [`Scheme`] on broken linears, [on](Self::on) another element one on the broken version
/// of that.
pub trait BrokenScheme: Clone + Debug + Default + Send + Sync + 'static {
    /// The name on linears; `-p2` is added on quadratics, and so on.
    fn name_on_linears(&self) -> &'static str;
    /// The form on the facets of a mesh, for a broken element.
    fn form_on<const D: usize>(
        &self,
        element: &dyn Element<D>,
        mesh: &Mesh<D>,
    ) -> Box<dyn FacetForm<D>>;
    /// Whether the exact solution satisfies the discrete equations.
    fn has_consistency_terms(&self) -> bool {
        true
    }
    /// All parameters as options, in this dimension: those that differ from the default scheme's stand
    /// in labels.
    fn options(&self, dimension: usize) -> SchemeOptions;
    /// The scheme with those of its parameters that the options give.
    #[must_use]
    fn with_options(self, options: &SchemeOptions, dimension: usize) -> Self;
    /// Orders that theory proves on elements of this degree, with bounds at all nodes; none by default.
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        let _ = (degree, setting);
        ExpectedOrders::default()
    }
    /// The scheme on the broken version of another element: `Sipg::default().on(P2)`.
    fn on<const D: usize>(self, element: impl Element<D> + 'static) -> OnElement<Self, D> {
        let name = match element.degree() {
            1 => self.name_on_linears().to_owned(),
            degree => format!("{}-p{degree}", self.name_on_linears()),
        };
        OnElement { scheme: self, name, element: Arc::new(Broken(element)) }
    }
}

/// A scheme on the broken version of an element, made by [`BrokenScheme::on`].
#[derive(Clone, Debug)]
pub struct OnElement<S, const D: usize> {
    scheme: S,
    name: String,
    element: Arc<dyn Element<D>>,
}

impl<S: BrokenScheme, const D: usize> Scheme<D> for OnElement<S, D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        self.scheme.form_on(&*self.element, mesh)
    }
    fn is_consistent(&self) -> bool {
        self.scheme.has_consistency_terms()
    }
    fn choices(&self) -> SchemeOptions {
        self.scheme.options(D).unlike(&S::default().options(D))
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        self.scheme.orders_of_degree(self.element.degree(), setting)
    }
}

impl<S: BrokenScheme, const D: usize> Scheme<D> for S {
    fn name(&self) -> &str {
        self.name_on_linears()
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        self.form_on(&Broken(P1), mesh)
    }
    fn is_consistent(&self) -> bool {
        self.has_consistency_terms()
    }
    fn choices(&self) -> SchemeOptions {
        self.options(D).unlike(&S::default().options(D))
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        self.orders_of_degree(1, setting)
    }
}
