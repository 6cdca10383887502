//! Noticing that an active set has been seen before.

use crate::algebra::Contact;

/// The contact states seen, as fingerprints, and when each unknown last moved.
///
/// A fingerprint has 128 bits: for two different states among a few hundred to share one has a
/// probability below 1e-33, so equality of fingerprints is taken for equality.
#[derive(Debug)]
pub(crate) struct History {
    seen: Vec<(u128, u32)>,
    last_move: Vec<u32>,
    step: u32,
    moving: usize,
    /// The step at which the states before were forgotten, if they were.
    forgotten: Option<u32>,
}

impl History {
    /// No state seen yet.
    pub fn new(unknowns: usize) -> Self {
        Self { seen: Vec::new(), last_move: vec![0; unknowns], step: 0, moving: 0, forgotten: None }
    }

    /// Notes that unknown `i` moves into the state to be recorded next.
    pub fn moved(&mut self, i: usize) {
        self.last_move[i] = self.step + 1;
        self.moving += 1;
    }

    /// How many unknowns move into the state to be recorded next.
    pub fn moving(&self) -> usize {
        self.moving
    }

    /// Records a state. If it has been seen, marks in `cycle` every unknown that has moved since,
    /// and returns true.
    ///
    /// After [`History::restart`] every unknown counts that has moved since then: what moved only
    /// on the way into the cycle may be what disputes the state restarted from, and would do so
    /// for ever.
    pub fn record(&mut self, state: &[Contact], cycle: &mut [bool]) -> bool {
        self.step += 1;
        self.moving = 0;
        let fingerprint = fingerprint(state);
        let Some(&(_, first)) = self.seen.iter().find(|(seen, _)| *seen == fingerprint) else {
            self.seen.push((fingerprint, self.step));
            return false;
        };
        self.mark_moved(self.forgotten.unwrap_or(first), cycle);
        true
    }

    /// Marks in `cycle` every unknown that has moved within the last `steps` records.
    pub fn mark_recent(&self, steps: usize, cycle: &mut [bool]) {
        let recent = self.step.saturating_sub(steps as u32);
        self.mark_moved(self.forgotten.unwrap_or(recent), cycle);
    }

    /// Marks every unknown that has moved after a step.
    fn mark_moved(&self, after: u32, cycle: &mut [bool]) {
        for (mark, &last) in cycle.iter_mut().zip(&self.last_move) {
            *mark |= last > after;
        }
    }

    /// Forgets all states and records one that was not reached by the method's own steps.
    pub fn restart(&mut self, state: &[Contact]) {
        self.seen.clear();
        self.record(state, &mut []);
        self.forgotten = Some(self.step);
    }
}

/// The sum over all unknowns on a bound of a pseudo-random number of unknown and bound.
fn fingerprint(state: &[Contact]) -> u128 {
    state
        .iter()
        .enumerate()
        .fold(0, |sum: u128, (i, &contact)| sum.wrapping_add(key_of(i, contact)))
}

/// What one unknown contributes to a fingerprint.
pub(crate) fn key_of(i: usize, contact: Contact) -> u128 {
    let side = match contact {
        Contact::Inactive => return 0,
        Contact::Lower => 0,
        Contact::Upper => 1,
    };
    let key = 2 * i as u64 + side;
    u128::from(scramble(key)) << 64 | u128::from(scramble(!key))
}

/// The output function of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64 bits without
/// visible structure.
fn scramble(key: u64) -> u64 {
    let z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
