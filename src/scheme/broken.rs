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
    fn name_on_linears(&self) -> &str;
    /// The form on the facets of a mesh, for a broken element.
    fn form_on<const D: usize>(&self, on: &dyn Element<D>, mesh: &Mesh<D>)
    -> Box<dyn FacetForm<D>>;
    /// Whether the exact solution satisfies the discrete equations.
    fn has_consistency_terms(&self) -> bool {
        true
    }
    /// All parameters as options: those that differ from the default scheme's stand in labels.
    fn options(&self) -> SchemeOptions;
    /// The scheme with those of its parameters that the options give.
    #[must_use]
    fn with_options(self, options: &SchemeOptions) -> Self;
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

/// A broken scheme and its element: broken linears where no other is chosen. It is a [`Scheme`].
pub trait WithBrokenElement<const D: usize>: Send + Sync {
    /// The scheme without its element.
    type Method: BrokenScheme;
    /// The scheme, its name on the element, and the element.
    fn on_its_element(&self) -> (&Self::Method, &str, Arc<dyn Element<D>>);
}

impl<S: BrokenScheme, const D: usize> WithBrokenElement<D> for S {
    type Method = S;
    fn on_its_element(&self) -> (&S, &str, Arc<dyn Element<D>>) {
        (self, self.name_on_linears(), Arc::new(Broken(P1)))
    }
}

impl<S: BrokenScheme, const D: usize> WithBrokenElement<D> for OnElement<S, D> {
    type Method = S;
    fn on_its_element(&self) -> (&S, &str, Arc<dyn Element<D>>) {
        (&self.scheme, &self.name, self.element.clone())
    }
}

impl<W: WithBrokenElement<D>, const D: usize> Scheme<D> for W {
    fn name(&self) -> &str {
        self.on_its_element().1
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.on_its_element().2
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let (scheme, _, element) = self.on_its_element();
        scheme.form_on(&*element, mesh)
    }
    fn is_consistent(&self) -> bool {
        self.on_its_element().0.has_consistency_terms()
    }
    fn choices(&self) -> SchemeOptions {
        self.on_its_element().0.options().unlike(&W::Method::default().options())
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let (scheme, _, element) = self.on_its_element();
        scheme.orders_of_degree(element.degree(), setting)
    }
}
