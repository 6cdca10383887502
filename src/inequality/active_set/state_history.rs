//! The history of contact states: which active sets have occurred, and which unknowns changed when.

use crate::algebra::Contact;

/// The active sets that have occurred, as fingerprints, and the step of the last change of each
/// unknown.
///
/// A fingerprint has 128 bits: two different sets among a few hundred share one with a probability
/// below 1e-33, so that equal fingerprints count as equal sets.
#[derive(Debug)]
pub(crate) struct StateHistory {
    /// The fingerprints of the active sets, each with the step at which it was recorded.
    seen: Vec<(u128, u32)>,
    /// The step of the last change of each unknown; zero if it never changed.
    last_change: Vec<u32>,
    /// The number of recorded active sets.
    step: u32,
    /// The number of changes since the last recorded active set.
    pending_changes: usize,
    /// The step of the last [`StateHistory::restart`].
    restarted_at: Option<u32>,
}

impl StateHistory {
    /// An empty history.
    pub fn new(unknowns: usize) -> Self {
        Self {
            seen: Vec::new(),
            last_change: vec![0; unknowns],
            step: 0,
            pending_changes: 0,
            restarted_at: None,
        }
    }

    /// Notes a change of unknown `i` since the last recorded active set.
    pub fn note_change(&mut self, i: usize) {
        self.last_change[i] = self.step + 1;
        self.pending_changes += 1;
    }

    /// The number of changes since the last recorded active set.
    pub fn pending_changes(&self) -> usize {
        self.pending_changes
    }

    /// Records an active set. If it has occurred before, marks in `cycle` every unknown that has
    /// changed since then, and returns true; marks that are set already stay.
    ///
    /// After a [`StateHistory::restart`] every unknown is marked that has changed since the
    /// restart, even if it changed only before the cycle began: its change may have made the method
    /// leave the active set of the restart, and would do so again.
    pub fn record(&mut self, states: &[Contact], cycle: &mut [bool]) -> bool {
        self.step += 1;
        self.pending_changes = 0;
        let fingerprint = fingerprint(states);
        let Some(&(_, first)) = self.seen.iter().find(|(seen, _)| *seen == fingerprint) else {
            self.seen.push((fingerprint, self.step));
            return false;
        };
        self.mark_changed(self.restarted_at.unwrap_or(first), cycle);
        true
    }

    /// Marks in `cycle` every unknown that has changed within the last `steps` recorded active sets, or
    /// since the last restart if there was one.
    pub fn mark_recent(&self, steps: usize, cycle: &mut [bool]) {
        let recent = self.step.saturating_sub(steps as u32);
        self.mark_changed(self.restarted_at.unwrap_or(recent), cycle);
    }

    /// Marks in `cycle` every unknown that has changed after a step.
    fn mark_changed(&self, after: u32, cycle: &mut [bool]) {
        for (mark, &last) in cycle.iter_mut().zip(&self.last_change) {
            *mark |= last > after;
        }
    }

    /// Clears the history and records an active set that condensation found.
    pub fn restart(&mut self, states: &[Contact]) {
        self.seen.clear();
        self.record(states, &mut []);
        self.restarted_at = Some(self.step);
    }
}

/// The fingerprint of an active set: the sum of the keys of all unknowns.
pub(crate) fn fingerprint(states: &[Contact]) -> u128 {
    states
        .iter()
        .enumerate()
        .fold(0, |sum: u128, (i, &contact)| sum.wrapping_add(state_key(i, contact)))
}

/// The key of the contact state of unknown `i`: a pseudo-random number determined by the unknown
/// and its active bound, zero if the unknown is inactive.
pub(crate) fn state_key(i: usize, contact: Contact) -> u128 {
    let side = match contact {
        Contact::Inactive => return 0,
        Contact::Lower => 0,
        Contact::Upper => 1,
    };
    let key = 2 * i as u64 + side;
    u128::from(scramble(key)) << 64 | u128::from(scramble(!key))
}

/// The output function of SplitMix64 (Steele, Lea, Flood 2014), a bijection of 64 bits without visible
/// structure.
fn scramble(key: u64) -> u64 {
    let z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
