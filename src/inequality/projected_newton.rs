//! The monotone active set method: slow, and finite for every symmetric positive definite matrix.

use super::Outcome;
use super::active_set::ActiveSet;
use super::active_set::cycles::History;
use super::active_set::iterate::Iterate;
use crate::algebra::Contact;
use crate::real::Real;

/// Share of the decrease its slope promises that a step must bring.
const ARMIJO: f64 = 1e-4;

/// Runs from the values of the iterate until the active set rests; the error is the reason why it
/// does not, [`Outcome::Stalled`] where rounding outweighs what energy there is to gain.
///
/// All values are admissible and the energy `u.A u / 2 - b.u` never rises. With the states as they
/// are the minimum is found; if it violates bounds the method goes towards it along the path that
/// bends at bounds (Bertsekas, SIAM J. Control Optim. 20 (1982) 221-246) as far as energy falls,
/// but at least to the first bound, and everything met on the way stays there. Once the minimum is
/// admissible all multipliers of the wrong sign are let go at once (More, Toraldo, SIAM J. Optim. 1
/// (1991) 93-113). It ends: every step takes hold of an unknown at least until the minimum is
/// admissible, and an admissible minimum is below the one before, of which there are as many as
/// sets of contact.
pub(crate) fn descend<T: Real>(
    iterate: &mut Iterate<'_, T>,
    settings: &ActiveSet,
) -> Result<(), Outcome> {
    let mut history = History::new(iterate.values.len());
    iterate.rest_on_bounds();
    iterate.admit();
    let mut gained = f64::NAN;
    loop {
        if iterate.outer >= settings.max_outer {
            return Err(Outcome::IterationLimit);
        }
        let before = Place::of(iterate);
        iterate.solve_linear(settings.refinements)?;
        if !iterate.assess() {
            return Err(Outcome::NotFinite);
        }
        if iterate.is_admissible(settings.band) {
            gained += before.gain(iterate, &iterate.values);
            if !iterate.change_state(settings.band, 0.0, &mut history) {
                return Ok(());
            }
            // the first minimum has none before it to be compared with
            if gained <= 0.0 {
                return Err(Outcome::Stalled);
            }
            gained = 0.0;
        } else {
            gained += before.bend(iterate, &mut history);
        }
    }
}

/// Admissible values and the force `b - A u` there.
struct Place<T> {
    values: Vec<T>,
    force: Vec<f64>,
}

impl<T: Real> Place<T> {
    fn of(iterate: &Iterate<'_, T>) -> Self {
        let values = iterate.values.clone();
        let mut force = vec![0.0; values.len()];
        iterate.inequality.residual_f64(&values, &mut force);
        Self { values, force }
    }

    /// By how much the energy falls from here to `values`.
    fn gain(&self, iterate: &Iterate<'_, T>, values: &[T]) -> f64 {
        let (slope, curvature) = self.slope_and_curvature(iterate, values);
        slope - 0.5 * curvature
    }

    fn slope_and_curvature(&self, iterate: &Iterate<'_, T>, values: &[T]) -> (f64, f64) {
        let step: Vec<T> = values.iter().zip(&self.values).map(|(&x, &y)| x - y).collect();
        let matrix = &iterate.inequality.matrix;
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (i, step_i) in step.iter().enumerate() {
            slope += self.force[i] * step_i.to_f64();
            curvature += step_i.to_f64() * matrix.row_dot_f64(i, &step);
        }
        (slope, curvature)
    }

    /// Goes from here towards the values of the iterate, bending at bounds, and takes hold of what
    /// is met; returns by how much the energy falls.
    fn bend(&self, iterate: &mut Iterate<'_, T>, history: &mut History) -> f64 {
        let goal = iterate.values.clone();
        let walls: Vec<(usize, f64, Contact)> = self.walls(iterate, &goal);
        let first = walls.iter().map(|wall| wall.1).fold(1.0, f64::min);
        let mut length = 1.0;
        let gained = loop {
            for i in 0..goal.len() {
                let x = self.values[i] + (goal[i] - self.values[i]) * T::lit(length);
                iterate.values[i] = iterate.inequality.bounds[i].nearest(x);
            }
            let (slope, curvature) = self.slope_and_curvature(iterate, &iterate.values);
            let gain = slope - 0.5 * curvature;
            if length <= first || gain > 0.0 && gain >= ARMIJO * slope {
                break gain;
            }
            length = if 0.5 * length > first { 0.5 * length } else { first };
        };
        for (i, at, contact) in walls {
            if at <= length {
                iterate.set_state(i, contact, history);
            }
        }
        iterate.rest_on_bounds();
        gained
    }

    /// The bounds met on the way to `goal`, and after which share of it.
    fn walls(&self, iterate: &Iterate<'_, T>, goal: &[T]) -> Vec<(usize, f64, Contact)> {
        let bounds = &iterate.inequality.bounds;
        let open = (0..goal.len()).filter(|&i| iterate.state[i] == Contact::Inactive);
        let wall = |i: usize| {
            let (from, to) = (self.values[i].to_f64(), goal[i].to_f64());
            let (wall, contact) = match (bounds[i].lower(), bounds[i].upper()) {
                (Some(l), _) if to < l.to_f64() => (l, Contact::Lower),
                (_, Some(u)) if to > u.to_f64() => (u, Contact::Upper),
                _ => return None,
            };
            Some((i, ((wall.to_f64() - from) / (to - from)).max(0.0), contact))
        };
        open.filter_map(wall).collect()
    }
}
