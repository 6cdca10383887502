//! The unknowns of one inequality in several processes.

use std::fmt::Debug;

use crate::real::Real;

/// How the unknowns of an inequality are distributed over the parts of a mesh, seen from one part.
///
/// A part has rows, load and bounds of its own unknowns, and besides unknowns that other parts own, its
/// *ghosts*: their values take part in products, their rows are incomplete and count nowhere. A mesh in one process
/// is one part. Solvers of an inequality run in all parts at once. Sums and maxima over the parts decide, so that all
/// parts take the same decision.
///
/// [`exchange`](Self::exchange), [`sum`](Self::sum) and [`largest`](Self::largest) are collective: all parts
/// call them as often as one another, in the same order. Where messages fail, the numbers that come back are
/// not numbers, which ends a solve as [`NotFinite`](crate::inequality::Outcome::NotFinite).
pub trait Distribution: Debug + Send + Sync {
    /// Whether this part owns one of its unknowns.
    fn owns(&self, unknown: usize) -> bool;
    /// The number of one of the unknowns of this part among those of all parts.
    fn number(&self, unknown: usize) -> u64;
    /// Calls `receive` with every ghost and the `value` that its owner has.
    fn exchange(&self, value: &dyn Fn(usize) -> f64, receive: &mut dyn FnMut(usize, f64));
    /// Replaces each number by the sum of those of all parts, with the same bits in all parts.
    fn sum(&self, numbers: &mut [f64]);
    /// Replaces each number by the largest of those of all parts; by one that is not a number if a part has
    /// one.
    fn largest(&self, numbers: &mut [f64]);
}

/// The distribution of an inequality in one process: all unknowns are its own.
#[derive(Debug)]
pub(crate) struct OnePart;

impl Distribution for OnePart {
    fn owns(&self, _: usize) -> bool {
        true
    }
    fn number(&self, unknown: usize) -> u64 {
        unknown as u64
    }
    fn exchange(&self, _: &dyn Fn(usize) -> f64, _: &mut dyn FnMut(usize, f64)) {}
    fn sum(&self, _: &mut [f64]) {}
    fn largest(&self, _: &mut [f64]) {}
}

/// What solvers ask of a distribution.
impl dyn Distribution + '_ {
    /// Gives ghosts the values that their owners have.
    pub(crate) fn update<T: Real>(&self, values: &mut [T]) {
        self.update_by(values, |value| value.to_f64(), T::lit);
    }
    /// Gives ghosts the flags that their owners have.
    pub(crate) fn update_flags(&self, flags: &mut [bool]) {
        self.update_by(flags, |flag| f64::from(u8::from(flag)), |number| number != 0.0);
    }
    /// Gives ghosts the states that their owners have; each is sent as a number.
    pub(crate) fn update_by<V: Copy>(
        &self,
        states: &mut [V],
        number: impl Fn(V) -> f64,
        state: impl Fn(f64) -> V,
    ) {
        let mut received: Vec<(usize, f64)> = Vec::new();
        self.exchange(&|i| number(states[i]), &mut |i, number| received.push((i, number)));
        received.into_iter().for_each(|(i, number)| states[i] = state(number));
    }
}

/// The sum of a number over all parts.
pub(crate) fn sum_over_parts(distribution: &dyn Distribution, number: f64) -> f64 {
    let mut numbers = [number];
    distribution.sum(&mut numbers);
    numbers[0]
}

/// Whether a statement is true in one part or more.
pub(crate) fn any_part(distribution: &dyn Distribution, is_true: bool) -> bool {
    let mut numbers = [f64::from(u8::from(is_true))];
    distribution.largest(&mut numbers);
    numbers[0] != 0.0
}
