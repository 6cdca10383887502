//! The side of each kink on which load and bounds are.

use super::Kink;
use crate::algebra::bound::Bound;
use crate::algebra::inequality::Inequality;
use crate::real::Real;

impl<T: Real> Inequality<T> {
    /// Adds the function `slope |x - place|` of an unknown without bounds, on its side above the place.
    ///
    /// # Panics
    /// If there is no such unknown.
    pub fn add_kink(&mut self, unknown: u32, slope: T, place: T) {
        self.bounds[unknown as usize] = Bound::Lower(place);
        self.load[unknown as usize] -= slope;
        self.kinks.push(Kink { unknown, slope });
    }
    /// Turns the unknown of the kink at a position to the other side of its place.
    ///
    /// # Panics
    /// If there is no such kink.
    pub fn turn(&mut self, position: usize) {
        let Kink { unknown, slope } = self.kinks[position];
        let (bound, load) = (&mut self.bounds[unknown as usize], &mut self.load[unknown as usize]);
        let twice = slope + slope;
        (*bound, *load) = match *bound {
            Bound::Lower(place) => (Bound::Upper(place), *load + twice),
            Bound::Upper(place) => (Bound::Lower(place), *load - twice),
            other => (other, *load),
        };
    }
    /// Turns each kink to the side on which its unknown has the value that is given; at its place it stays.
    pub fn turn_to(&mut self, values: &[T]) {
        for k in 0..self.kinks.len() {
            let i = self.kinks[k].unknown as usize;
            let is_beyond = values.get(i).is_some_and(|&x| match self.bounds[i] {
                Bound::Lower(place) => x < place,
                Bound::Upper(place) => x > place,
                _ => false,
            });
            if is_beyond {
                self.turn(k);
            }
        }
    }
    /// The slope of the function of the kink at a position on the side of its unknown: part of minus the load.
    pub fn slope_at(&self, position: usize) -> f64 {
        let Kink { unknown, slope } = self.kinks[position];
        match self.bounds[unknown as usize] {
            Bound::Upper(_) => -slope.to_f64(),
            _ => slope.to_f64(),
        }
    }
    /// What the linear functions that are in the load exceed those of the kinks by: slopes times places.
    pub(in crate::algebra) fn slopes_at_places(&self) -> f64 {
        let place = |k: usize| {
            let bound = self.bounds[self.kinks[k].unknown as usize];
            bound.lower().or(bound.upper()).map_or(0.0, |place| place.to_f64())
        };
        (0..self.kinks.len()).map(|k| self.slope_at(k) * place(k)).sum()
    }
    /// Whether kinks belong to unknowns with one bound, have positive slopes, and no two the same unknown.
    pub(in crate::algebra) fn has_sound_kinks(&self) -> bool {
        let is_sound = |kink: &Kink<T>| {
            let bound = self.bounds.get(kink.unknown as usize);
            kink.slope.to_f64() > 0.0 && matches!(bound, Some(Bound::Lower(_) | Bound::Upper(_)))
        };
        self.kinks.iter().all(is_sound)
            && self.kinks.windows(2).all(|pair| pair[0].unknown < pair[1].unknown)
    }
}
