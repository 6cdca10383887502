//! The trait of constraint sets.

use std::sync::Arc;

use crate::element::{Basis, Node};
use crate::theory::Setting;

/// By what an unknown is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundBy {
    /// By the datum at the [point](Node::centre) of the node; that of a mean is the barycentre.
    Value,
    /// By the functional of the node, applied to the datum: the mean over the facet, the Bernstein coefficient, at a
    /// node that is a point the value there.
    Functional,
}

/// A constraint set: which unknowns an inequality binds, and by what.
///
/// Object-safe and read once for each discretisation, in no loop over cells. An unknown that cells
/// share is bound if it is bound in one of them.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a constraint set",
    note = "a constraint set says which nodes an inequality binds: implement `ConstraintSet`, see examples/my_element.rs"
)]
pub trait ConstraintSet: Send + Sync {
    /// The name users type and reports state.
    fn name(&self) -> &str;
    /// The name in reports on an element with these nodes, where it says more than [`Self::name`].
    fn name_on(&self, nodes: &[Node]) -> &str {
        let _ = nodes;
        self.name()
    }
    /// The basis to change to, if the element [knows](crate::element::Element::in_basis) it and the set binds none of
    /// its nodes.
    fn basis(&self) -> Option<Basis> {
        None
    }
    /// By what an obstacle binds the unknown of a node; none if it does not. An element none of whose
    /// nodes it binds does not fit the set: inequalities are refused.
    fn in_domain(&self, node: &Node, dimension: usize) -> Option<BoundBy>;
    /// By what a Signorini condition binds the unknown of a node, which lies on the contact facet;
    /// none if it does not. By default the nodes that obstacles bind, by the mean of the gap.
    fn on_contact(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        self.in_domain(node, dimension).map(|_| BoundBy::Functional)
    }
    /// Whether the orders that a scheme promises with bounds at all nodes remain proven with this
    /// set. By default only where no inequality binds.
    fn keeps_orders(&self, setting: &Setting) -> bool {
        setting.is_linear()
    }
}

impl<C: ConstraintSet + ?Sized> ConstraintSet for Arc<C> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn name_on(&self, nodes: &[Node]) -> &str {
        (**self).name_on(nodes)
    }
    fn basis(&self) -> Option<Basis> {
        (**self).basis()
    }
    fn in_domain(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        (**self).in_domain(node, dimension)
    }
    fn on_contact(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        (**self).on_contact(node, dimension)
    }
    fn keeps_orders(&self, setting: &Setting) -> bool {
        (**self).keeps_orders(setting)
    }
}
