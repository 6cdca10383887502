//! The element of a scheme in the basis that a constraint set needs.

use super::space::AnyElement;
use crate::constraint::{CONSTRAINT_SETS, ConstraintSet, constraint_set_by_name};
use crate::element::{ElementVisitor, Node, ReferenceElement};

/// An element without its type.
pub(crate) struct ChosenElement<const D: usize> {
    pub element: AnyElement,
    /// The names of the constraint sets that the element of the scheme offers an obstacle, or a
    /// Signorini condition.
    pub offered: fn(contact: bool) -> Vec<String>,
}

impl<const D: usize> ChosenElement<D> {
    /// The element `E`, or the one of the same broken polynomials in the basis of the set, if the set
    /// binds no node of `E`.
    pub fn of<E: ReferenceElement<D>>(set: &dyn ConstraintSet) -> Self {
        let own = Erase.visit::<E>();
        let is_bound = binds_any(set, &own.element.nodes, D);
        let other = match set.basis() {
            Some(basis) if !is_bound && E::LAYOUT.is_broken() => E::broken_in_basis(basis, Erase),
            _ => None,
        };
        Self { offered: offered::<E, D>, ..other.unwrap_or(own) }
    }
}

/// Whether the set binds one of these nodes.
fn binds_any(set: &dyn ConstraintSet, nodes: &[Node], dimension: usize) -> bool {
    nodes.iter().any(|node| set.in_domain(node, dimension).is_some())
}

/// The visitor that removes the type.
struct Erase;

impl<const D: usize> ElementVisitor<D> for Erase {
    type Output = ChosenElement<D>;

    fn visit<E: ReferenceElement<D>>(self) -> ChosenElement<D> {
        ChosenElement { element: AnyElement::of::<E, D>(), offered: offered::<E, D> }
    }
}

fn offered<E: ReferenceElement<D>, const D: usize>(contact: bool) -> Vec<String> {
    offered_in(D, contact, |set| ChosenElement::<D>::of::<E>(set).element)
}

/// As [`offered`], compiled once for all elements.
fn offered_in(
    dimension: usize,
    contact: bool,
    element_for: fn(&dyn ConstraintSet) -> AnyElement,
) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for set in CONSTRAINT_SETS.iter().filter_map(|(name, _)| constraint_set_by_name(name)) {
        let AnyElement { nodes, .. } = element_for(&set);
        let is_bound = binds_any(&set, &nodes, dimension);
        let is_off_a_facet =
            |node: &Node| (0..dimension + 1).any(|k| !node.entity().contains(dimension, k));
        let is_bound_on_facets = nodes
            .iter()
            .any(|node| set.on_contact(node, dimension).is_some() && is_off_a_facet(node));
        let name = set.name_on(&nodes);
        if is_bound && (is_bound_on_facets || !contact) && !names.iter().any(|known| known == name)
        {
            names.push(name.to_owned());
        }
    }
    names
}
