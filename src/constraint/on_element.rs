//! Constraint sets on an element: the basis that a set needs, the sets that an element offers.

use std::sync::Arc;

use super::by_name::{CONSTRAINT_SETS, constraint_set_by_name};
use super::constraint_set::ConstraintSet;
use crate::element::{Element, Node};

/// The element, or the one of the same functions in the basis of the set, if the set binds no node of the
/// element.
pub(crate) fn in_basis_of<const D: usize>(
    set: &dyn ConstraintSet,
    element: Arc<dyn Element<D>>,
) -> Arc<dyn Element<D>> {
    let other = match set.basis() {
        Some(basis) if !binds_any(set, &element.nodes(), D) => {
            element.in_basis(basis, element.layout().is_broken())
        }
        _ => None,
    };
    other.unwrap_or(element)
}

/// Whether the set binds one of these nodes.
fn binds_any(set: &dyn ConstraintSet, nodes: &[Node], dimension: usize) -> bool {
    nodes.iter().any(|node| set.in_domain(node, dimension).is_some())
}

/// The names of the constraint sets that an element offers an obstacle, or a Signorini condition.
pub(crate) fn offered<const D: usize>(element: &Arc<dyn Element<D>>, contact: bool) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for set in CONSTRAINT_SETS.iter().filter_map(|(name, _)| constraint_set_by_name(name)) {
        let nodes = in_basis_of(&set, element.clone()).nodes();
        let is_off_a_facet = |node: &Node| (0..=D).any(|k| !node.entity().contains(D, k));
        let is_bound_on_facets =
            nodes.iter().any(|node| set.on_contact(node, D).is_some() && is_off_a_facet(node));
        let name = set.name_on(&nodes);
        let is_new = !names.iter().any(|known| known == name);
        if binds_any(&set, &nodes, D) && (is_bound_on_facets || !contact) && is_new {
            names.push(name.to_owned());
        }
    }
    names
}
