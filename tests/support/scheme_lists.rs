//! Lists of schemes.

use super::schemes::Entry;
use std::sync::Arc;
use unilateral::prelude::*;

/// A scheme with a constraint set.
pub fn entry<const D: usize>(
    scheme: impl Scheme<D> + 'static,
    set: impl ConstraintSet + 'static,
) -> Entry<D> {
    Entry { scheme: Box::new(scheme), set: Arc::new(set) }
}

impl<const D: usize> Entry<D> {
    /// The name of the constraint set on the scheme's element.
    pub fn constraint(&self) -> String {
        self.constraint_on(&self.set).unwrap()
    }
}

/// The schemes that reproduce linear functions.
pub fn consistent_schemes<const D: usize>() -> Vec<Entry<D>> {
    vec![
        entry(ConformingP1, Nodes),
        entry(NonconformingP1, Nodes),
        entry(Sipg::default(), Nodes),
        entry(Sipg::default(), FacetMeans),
    ]
}

/// Every scheme, and the discontinuous ones with both sets of constraints, with default penalties.
pub fn all_schemes<const D: usize>() -> Vec<Entry<D>> {
    let mut schemes = consistent_schemes();
    schemes.push(entry(Wopsip::default(), Nodes));
    schemes.push(entry(Wopsip::default(), FacetMeans));
    schemes
}
