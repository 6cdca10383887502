//! Tapia indicators, from which the active bounds are identified after each step.

use super::complementarity_pairs::ComplementarityPair;
use crate::algebra::Contact;

/// Least distance of the two Tapia indicators of a bound at which they count as separated.
const INDICATOR_SEPARATION: f64 = 0.5;

/// Whether the two Tapia indicators are separated at every bound: in the limit one of them is one, the other zero
/// (El-Bakry, Tapia, Zhang, SIAM Rev. 36 (1994) 45-72).
pub(super) fn are_separated(pairs: &[ComplementarityPair]) -> bool {
    undecided(pairs) == 0
}

/// The number of bounds whose two Tapia indicators are not separated.
pub(super) fn undecided(pairs: &[ComplementarityPair]) -> usize {
    let distance = |pair: &ComplementarityPair| (pair.indicators[0] - pair.indicators[1]).abs();
    pairs.iter().filter(|pair| distance(pair) <= INDICATOR_SEPARATION).count()
}

/// The contact states of `n` unknowns: a bound is active if the indicator of its dual variable is larger than the
/// indicator of its slack.
pub(super) fn contact_states(pairs: &[ComplementarityPair], n: usize) -> Vec<Contact> {
    let mut contact = vec![Contact::Inactive; n];
    for pair in pairs.iter().filter(|pair| pair.indicators[1] > pair.indicators[0]) {
        contact[pair.unknown] = if pair.side > 0.0 { Contact::Lower } else { Contact::Upper };
    }
    contact
}

/// The contact states after the step with the fewest bounds whose Tapia indicators are not separated: after a short
/// step all indicators are near one.
#[derive(Default)]
pub(super) struct DecidedContact {
    /// The number of bounds whose indicators were not separated.
    undecided: usize,
    /// The contact states; `None` before the first ones.
    pub contact: Option<Vec<Contact>>,
}

impl DecidedContact {
    /// Keeps contact states if the number of bounds whose indicators are not separated is not larger than before.
    pub fn keep_if_better(&mut self, undecided: usize, contact: &[Contact]) {
        if self.contact.is_none() || undecided <= self.undecided {
            (self.undecided, self.contact) = (undecided, Some(contact.to_vec()));
        }
    }
}
