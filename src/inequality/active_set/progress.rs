//! The progress of an active set iteration: cycles, stagnation, and the accuracy of the next linear solution.

use super::linear_solver::Accuracy;
use crate::algebra::{Contact, Distribution};

/// Least number of state changes after which the next system is solved with reduced accuracy. Fewer changes hardly
/// affect the error.
const MIN_CHANGES_FOR_REDUCED_ACCURACY: usize = 16;

/// Largest number of systems that are solved again because rounding made the certificate of an accurate solution too
/// large.
const MAX_REPEATS: usize = 3;

/// Number of systems with state changes within which their number must halve. Active sets that settle halve it with
/// every system or two; where it does not halve within four, the changes wander among unknowns whose gap and multiplier
/// both vanish, or return in turn, and the methods that follow cost less than more systems.
pub(crate) const SYSTEMS_WITHOUT_HALVING: usize = 4;

/// The progress of an iteration.
pub(crate) struct ProgressMonitor<'d> {
    /// Number of systems within which the number of state changes must halve; `None` for no limit.
    limit: Option<usize>,
    /// The distribution of the unknowns over the parts of a mesh.
    distribution: &'d dyn Distribution,
    /// The fingerprint of the present active set, less that of the first; see [`fingerprint_change`].
    fingerprint: u128,
    /// The fingerprints of the preceding active sets, each with whether its system was solved accurately.
    seen: Vec<(u128, bool)>,
    /// Whether the next system is solved accurately.
    next_is_accurate: bool,
    /// The number of accurate solutions whose certificate was too large.
    repeats: usize,
    /// The number of state changes when it last halved.
    fewest_changes: usize,
    /// The number of systems with state changes since `fewest_changes` was set.
    steps_without_halving: usize,
}

impl<'d> ProgressMonitor<'d> {
    /// The progress before the first system, which is solved accurately if the problem is linear: no unknown has an
    /// inequality as bound.
    pub fn new(limit: Option<usize>, is_linear: bool, distribution: &'d dyn Distribution) -> Self {
        Self {
            limit,
            distribution,
            fingerprint: 0,
            seen: Vec::new(),
            next_is_accurate: is_linear,
            repeats: 0,
            fewest_changes: usize::MAX,
            steps_without_halving: 0,
        }
    }

    /// How accurately the next system is solved.
    pub fn accuracy(&self) -> Accuracy {
        match self.next_is_accurate {
            true => Accuracy::Full,
            false => Accuracy::Reduced,
        }
    }

    /// Counts an accurate solution whose certificate is too large; returns false after more than [`MAX_REPEATS`] of
    /// them.
    pub fn may_solve_again(&mut self) -> bool {
        self.repeats += 1;
        self.repeats <= MAX_REPEATS
    }

    /// Records a solution of a linear system: the state changes that follow from it, the states `before` these changes,
    /// and whether it is accurate to the tolerance of the linear solver. Returns whether the iteration progresses: the
    /// next active set is none of an accurate solution before, and the number of changes has halved within the limit.
    pub fn record_solution(
        &mut self,
        changes: &[(u32, Contact)],
        before: &[Contact],
        is_accurate: bool,
    ) -> bool {
        let (fingerprint, count) = fingerprint_change(changes, before, self.distribution);
        self.next_is_accurate = count < MIN_CHANGES_FOR_REDUCED_ACCURACY;
        if count == 0 {
            return true;
        }
        match self.record_active_set(fingerprint, is_accurate) {
            Some(true) => return false,
            Some(false) => self.next_is_accurate = true,
            None => {}
        }
        !self.has_stagnated(count)
    }

    /// The number of active sets so far.
    pub fn steps(&self) -> usize {
        self.seen.len()
    }

    /// Whether the number of state changes has halved with the last solution.
    pub fn has_halved(&self) -> bool {
        self.steps_without_halving == 0
    }

    /// Records a number of state changes; returns whether the number has not halved within the limit.
    fn has_stagnated(&mut self, changes: usize) -> bool {
        if 2 * changes <= self.fewest_changes {
            (self.fewest_changes, self.steps_without_halving) = (changes, 0);
        } else {
            self.steps_without_halving += 1;
        }
        self.limit.is_some_and(|limit| self.steps_without_halving >= limit)
    }

    /// Records the present active set and adds `change` to the fingerprint, which gives the next active set. `None` if
    /// the next active set has not occurred before; else whether its system was solved accurately, so that the
    /// iteration would cycle.
    fn record_active_set(&mut self, change: u128, is_accurate: bool) -> Option<bool> {
        self.seen.push((self.fingerprint, is_accurate));
        self.fingerprint = self.fingerprint.wrapping_add(change);
        let earlier = self.seen.iter().filter(|(seen, _)| *seen == self.fingerprint);
        earlier.map(|(_, is_accurate)| *is_accurate).reduce(|a, b| a || b)
    }
}

/// The difference of the fingerprints of two active sets, and the number of state changes, over all parts. The
/// fingerprint of an active set is the sum of the keys of all unknowns and has 128 bits: two different sets among a few
/// hundred share one with a probability below 1e-33, so that sets with equal fingerprints count as equal.
fn fingerprint_change(
    changes: &[(u32, Contact)],
    before: &[Contact],
    distribution: &dyn Distribution,
) -> (u128, usize) {
    let mut fingerprint = 0_u128;
    for &(i, contact) in changes {
        let number = distribution.number(i as usize);
        fingerprint = fingerprint
            .wrapping_sub(state_key(number, before[i as usize]))
            .wrapping_add(state_key(number, contact));
    }
    // quarters of 32 bits are added separately, so that their sums are exact in `f64`
    let quarter = |k: u32| f64::from((fingerprint >> (32 * k)) as u32);
    let mut sums = [quarter(0), quarter(1), quarter(2), quarter(3), changes.len() as f64];
    distribution.sum(&mut sums);
    let quarters = (0..).zip(&sums[..4]).map(|(k, &sum)| (sum as u128) << (32 * k));
    (quarters.fold(0, u128::wrapping_add), sums[4] as usize)
}

/// The key of the contact state of the unknown with number `i`: a pseudo-random number determined by `i` and the active
/// bound; zero if the unknown is inactive.
fn state_key(i: u64, contact: Contact) -> u128 {
    let side = match contact {
        Contact::Inactive => return 0,
        Contact::Lower => 0,
        Contact::Upper => 1,
    };
    let key = 2 * i + side;
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
