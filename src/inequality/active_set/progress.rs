//! The progress of an active set iteration: active sets that return, stagnation, and how accurately to
//! solve.

use super::linear_solver::Accuracy;
use crate::algebra::Contact;

/// Fewer state changes than this hardly change the error: the next system is then solved accurately.
const FEW_CHANGES: usize = 16;

/// Largest number of solutions that may be repeated because of rounding.
const MAX_REPEATS: usize = 3;

/// Why an active set iteration does not continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Obstruction {
    /// The active set has occurred before, and its system was solved accurately.
    Cycle,
    /// The number of state changes has not halved, or the merit has not decreased, for too long.
    Stagnation,
}

/// The numbers of steps within which an iteration must progress.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patience {
    /// Number of systems within which the number of state changes must halve; `None` for no limit.
    pub halving: Option<usize>,
    /// Number of systems within which the merit must decrease.
    pub improvement: usize,
}

/// The progress of an iteration.
pub(crate) struct ProgressMonitor {
    patience: Patience,
    /// The fingerprint of the present active set; see [`fingerprint`].
    fingerprint: u128,
    /// The fingerprints of the preceding active sets, each with whether its system was solved accurately.
    seen: Vec<(u128, bool)>,
    next_is_accurate: bool,
    all_are_accurate: bool,
    /// The number of systems since the smallest merit, or since all are solved accurately.
    steps_without_improvement: usize,
    /// The number of accurate solutions whose certificate was too large.
    repeats: usize,
    /// The number of state changes when it last halved.
    fewest_changes: usize,
    /// The number of systems with state changes since then.
    steps_without_halving: usize,
}

impl ProgressMonitor {
    /// The progress before the first system of contact states, which is solved accurately if
    /// `is_linear`: no unknown has an inequality as bound.
    pub fn new(states: &[Contact], patience: Patience, is_linear: bool) -> Self {
        Self {
            patience,
            fingerprint: fingerprint(states),
            seen: Vec::new(),
            next_is_accurate: is_linear,
            all_are_accurate: false,
            steps_without_improvement: 0,
            repeats: 0,
            fewest_changes: usize::MAX,
            steps_without_halving: 0,
        }
    }

    /// How accurately the next system is solved.
    pub fn accuracy(&self) -> Accuracy {
        match self.next_is_accurate || self.all_are_accurate {
            true => Accuracy::Full,
            false => Accuracy::Reduced,
        }
    }

    /// Notes an accurate solution whose certificate is too large; false after more than
    /// [`MAX_REPEATS`] of them.
    pub fn may_repeat(&mut self) -> bool {
        self.repeats += 1;
        self.repeats <= MAX_REPEATS
    }

    /// Notes the state changes that follow from a solution and whether the solution is the best so
    /// far. `before` are the states before the changes, `is_accurate` tells whether the solution is as
    /// accurate as possible.
    ///
    /// # Errors
    /// [`Obstruction`] if the iteration does not progress.
    pub fn note(
        &mut self,
        changes: &[(u32, Contact)],
        before: &[Contact],
        is_best: bool,
        is_accurate: bool,
    ) -> Result<(), Obstruction> {
        self.next_is_accurate = changes.len() < FEW_CHANGES;
        if changes.is_empty() {
            return Ok(());
        }
        match self.record(changes, before, is_accurate) {
            Some(true) => return Err(Obstruction::Cycle),
            Some(false) => self.next_is_accurate = true,
            None => {}
        }
        if self.has_stagnated(changes.len()) {
            return Err(Obstruction::Stagnation);
        }
        self.steps_without_improvement =
            if is_best { 0 } else { self.steps_without_improvement + 1 };
        if self.steps_without_improvement > self.patience.improvement {
            if self.all_are_accurate || is_accurate {
                return Err(Obstruction::Stagnation);
            }
            // inaccurate solutions may be the cause
            (self.all_are_accurate, self.steps_without_improvement) = (true, 0);
        }
        Ok(())
    }

    /// The number of active sets so far.
    pub fn steps(&self) -> usize {
        self.seen.len()
    }

    /// Whether the number of state changes has halved at the last note.
    pub fn has_halved(&self) -> bool {
        self.steps_without_halving == 0
    }

    /// Whether the number of state changes has not halved for too long.
    fn has_stagnated(&mut self, changes: usize) -> bool {
        if 2 * changes <= self.fewest_changes {
            (self.fewest_changes, self.steps_without_halving) = (changes, 0);
        } else {
            self.steps_without_halving += 1;
        }
        self.patience.halving.is_some_and(|steps| self.steps_without_halving >= steps)
    }

    /// Records the present active set and the one that follows from state changes. If the latter has
    /// occurred before: whether its system was solved accurately, so that the iteration would repeat
    /// itself.
    fn record(
        &mut self,
        changes: &[(u32, Contact)],
        before: &[Contact],
        is_accurate: bool,
    ) -> Option<bool> {
        self.seen.push((self.fingerprint, is_accurate));
        for &(i, contact) in changes {
            let i = i as usize;
            self.fingerprint = self
                .fingerprint
                .wrapping_sub(state_key(i, before[i]))
                .wrapping_add(state_key(i, contact));
        }
        let earlier = self.seen.iter().filter(|(seen, _)| *seen == self.fingerprint);
        earlier.map(|(_, is_accurate)| *is_accurate).reduce(|a, b| a || b)
    }
}

/// The fingerprint of an active set: the sum of the keys of all unknowns. It has 128 bits: two
/// different sets among a few hundred share one with a probability below 1e-33, so that equal
/// fingerprints count as equal sets.
fn fingerprint(states: &[Contact]) -> u128 {
    let keys = states.iter().enumerate().map(|(i, &contact)| state_key(i, contact));
    keys.fold(0, u128::wrapping_add)
}

/// The key of the contact state of unknown `i`: a pseudo-random number determined by the unknown
/// and its active bound, zero if the unknown is inactive.
fn state_key(i: usize, contact: Contact) -> u128 {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of accurate steps, each with another unknown in contact, before the iteration ends.
    fn steps(improvement: usize, is_best: bool) -> usize {
        let mut states = vec![Contact::Inactive; 20];
        let mut progress =
            ProgressMonitor::new(&states, Patience { halving: None, improvement }, false);
        let mut goes_on = |i: &usize| {
            let change = [(*i as u32, Contact::Lower)];
            let noted = progress.note(&change, &states, is_best, true);
            states[*i] = Contact::Lower;
            noted != Err(Obstruction::Stagnation)
        };
        (0..20).take_while(|i| goes_on(i)).count()
    }

    #[test]
    fn patience_ends_where_nothing_improves() {
        assert_eq!(steps(3, false), 3);
        assert_eq!(steps(7, false), 7);
        assert_eq!(steps(3, true), 20);
    }
}
