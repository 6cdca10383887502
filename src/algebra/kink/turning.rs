//! The side of each kink on which load and bounds are.

use std::borrow::Cow;

use super::Kink;
use crate::algebra::bound::{Bound, Contact};
use crate::algebra::inequality::Inequality;
use crate::real::Real;

impl<T: Real> Kink<T> {
    /// Whether the unknown has admissible values on both sides of the place.
    pub fn has_both_sides(&self) -> bool {
        self.own.lower().is_none_or(|lower| lower < self.place)
            && self.own.upper().is_none_or(|upper| upper > self.place)
    }
    /// The admissible values on the side of the kink.
    fn bound(&self) -> Bound<T> {
        match (self.has_both_sides(), self.is_above) {
            (false, _) => self.own,
            (true, true) => {
                self.own.upper().map_or(Bound::Lower(self.place), |u| Bound::Both(self.place, u))
            }
            (true, false) => {
                self.own.lower().map_or(Bound::Upper(self.place), |l| Bound::Both(l, self.place))
            }
        }
    }
    /// The state of an unknown that is at the place; none if the place is no bound.
    pub(crate) fn state(&self) -> Option<Contact> {
        let state = if self.is_above { Contact::Lower } else { Contact::Upper };
        self.has_both_sides().then_some(state)
    }
    /// The slope of the function on the side of the kink, part of minus the load.
    fn slope_on_side(&self) -> T {
        if self.is_above { self.slope } else { -self.slope }
    }
}

impl<T: Real> Inequality<T> {
    /// Adds the function `slope |x - place|` of an unknown that is not fixed, on its side above the place if it has one.
    ///
    /// # Panics
    /// If there is no such unknown.
    pub fn add_kink(&mut self, unknown: u32, slope: T, place: T) {
        let own = self.bounds[unknown as usize];
        let is_above = own.upper().is_none_or(|upper| upper > place);
        let kink = Kink { unknown, slope, place, is_above, own };
        self.bounds[unknown as usize] = kink.bound();
        self.load[unknown as usize] -= kink.slope_on_side();
        self.kinks.push(kink);
    }
    /// Turns the unknown of the kink at a position to the other side of its place, if it has one.
    ///
    /// # Panics
    /// If there is no such kink.
    pub fn turn(&mut self, position: usize) {
        let kink = &mut self.kinks[position];
        if kink.has_both_sides() {
            let before = kink.slope_on_side();
            kink.is_above = !kink.is_above;
            let load = &mut self.load[kink.unknown as usize];
            *load = *load + before - kink.slope_on_side();
            self.bounds[kink.unknown as usize] = kink.bound();
        }
    }
    /// Turns each kink to the side on which its unknown has the value that is given; at its place it stays.
    pub fn turn_to(&mut self, values: &[T]) {
        for k in 0..self.kinks.len() {
            let Kink { unknown, place, is_above, .. } = self.kinks[k];
            let is_beyond = values
                .get(unknown as usize)
                .is_some_and(|&x| if is_above { x < place } else { x > place });
            if is_beyond {
                self.turn(k);
            }
        }
    }
    /// The slope of the function of the kink at a position on the side of its unknown: part of minus the load.
    pub fn slope_at(&self, position: usize) -> f64 {
        self.kinks[position].slope_on_side().to_f64()
    }
    /// Adds to vectors of the load and of the residual what takes the slopes of kinks out of them.
    pub(crate) fn add_slopes(&self, to: &mut [f64]) {
        for (k, kink) in self.kinks.iter().enumerate() {
            to[kink.unknown as usize] += self.slope_at(k);
        }
    }
    /// The position of the kink of an unknown.
    pub(crate) fn kink_of(&self, unknown: usize) -> Option<usize> {
        self.kinks.binary_search_by_key(&(unknown as u32), |kink| kink.unknown).ok()
    }
    /// Whether a kink holds its unknown, whose contact state is one of these.
    pub(crate) fn sticks(&self, position: usize, contact: &[Contact]) -> bool {
        let kink = &self.kinks[position];
        let state = contact.get(kink.unknown as usize);
        state.is_some() && state.copied() == kink.state()
    }
    /// The contact states without kinks: unknowns at their own bounds.
    pub(crate) fn states_at_bounds<'c>(&self, contact: &'c [Contact]) -> Cow<'c, [Contact]> {
        let mut states = Cow::Borrowed(contact);
        for k in 0..self.kinks.len() {
            if self.sticks(k, contact) {
                states.to_mut()[self.kinks[k].unknown as usize] = Contact::Inactive;
            }
        }
        states
    }
    /// The bounds without kinks.
    pub(crate) fn own_bounds(&self) -> Cow<'_, [Bound<T>]> {
        let mut bounds = Cow::Borrowed(&self.bounds[..]);
        for kink in &self.kinks {
            bounds.to_mut()[kink.unknown as usize] = kink.own;
        }
        bounds
    }
    /// The sum of slope times place over the kinks: the load has `slope x` for the function `slope (x - place)`.
    pub(in crate::algebra) fn slopes_at_places(&self) -> f64 {
        self.kinks.iter().map(|kink| kink.slope_on_side().to_f64() * kink.place.to_f64()).sum()
    }
    /// Whether kinks belong to unknowns, have positive slopes, and no two the same unknown.
    pub(in crate::algebra) fn has_sound_kinks(&self) -> bool {
        let is_sound = |kink: &Kink<T>| {
            (kink.unknown as usize) < self.bounds.len() && kink.slope.to_f64() > 0.0
        };
        self.kinks.iter().all(is_sound)
            && self.kinks.windows(2).all(|pair| pair[0].unknown < pair[1].unknown)
    }
}
