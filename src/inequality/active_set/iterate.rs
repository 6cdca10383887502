//! An iterate of the active set method: unknowns, contact states, and how they change.

use super::cycles::History;
use crate::algebra::{Bound, Contact, Inequality, Start};
use crate::inequality::certificate::positive_diagonal;
use crate::inequality::interior_point::{InteriorPoint, Path};
use crate::inequality::{Outcome, Solution};
use crate::linear::direct::{EliminationOrder, FactorError, Factors, StaticCondensation};
use crate::real::Real;

/// The current unknowns and states, and the best unknowns so far.
pub(crate) struct Iterate<'a, T> {
    pub inequality: &'a Inequality<T>,
    pub values: Vec<T>,
    pub state: Vec<Contact>,
    /// LinearMethod systems with a new active set so far.
    pub outer: usize,
    /// `b - A u`.
    deficit: Vec<f64>,
    /// Largest displacement.
    scale: f64,
    best: Best<T>,
    free: Vec<u32>,
    correction: Vec<T>,
    /// Forces of jumps where the matrix is kept factored; else empty.
    pub forces: Vec<T>,
    hybrid: Option<StaticCondensation<'a, T>>,
    /// The order of elimination, once it has been needed: the same for all active sets.
    order: Option<EliminationOrder>,
    /// Where the interior point method can go on.
    path: Option<Path>,
}

/// Most corrections where the matrix is kept factored.
const MOST_CORRECTIONS: usize = 12;

/// Corrections below this many units of rounding are not repeated.
const CORRECTED: f64 = 16.0;

/// The iterate whose projected Jacobi step is smallest.
struct Best<T> {
    measure: f64,
    outer: usize,
    values: Vec<T>,
    state: Vec<Contact>,
    forces: Vec<T>,
}

impl<'a, T: Real> Iterate<'a, T> {
    /// The admissible values nearest to zero, in the states of the start that the bounds have.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let bounds = &inequality.bounds;
        let values: Vec<T> = bounds.iter().map(|bound| bound.nearest(T::lit(0.0))).collect();
        let guess = match &inequality.start {
            Start::Cold => &[],
            Start::Contact(guess) => guess.as_slice(),
        };
        let state: Vec<Contact> = bounds
            .iter()
            .enumerate()
            .map(|(i, bound)| rest(bound, guess.get(i).copied().unwrap_or_default()))
            .collect();
        // what is malformed is refused before anything is solved
        let factored = inequality.penalised.as_ref().filter(|_| inequality.is_well_formed());
        let forces = vec![T::lit(0.0); factored.map_or(0, |factored| factored.n_jumps())];
        Self {
            inequality,
            outer: 0,
            deficit: vec![0.0; inequality.size()],
            scale: 1.0,
            best: Best {
                measure: f64::INFINITY,
                outer: 0,
                values: values.clone(),
                state: state.clone(),
                forces: forces.clone(),
            },
            values,
            state,
            free: Vec::new(),
            correction: Vec::new(),
            forces,
            hybrid: factored.map(|factored| {
                StaticCondensation::new(factored)
                    .with_points(inequality.points_of_unknowns().as_deref())
            }),
            order: None,
            path: None,
        }
    }

    /// The current iterate if it converged, else the best one.
    pub fn into_solution(self, outcome: Outcome) -> Solution<T> {
        let (values, contact, jump_multipliers) = if outcome == Outcome::Converged {
            (self.values, self.state, self.forces)
        } else {
            (self.best.values, self.best.state, self.best.forces)
        };
        Solution {
            values,
            contact,
            outcome,
            outer: self.outer,
            linear: 0,
            linear_solver: "direct",
            algebraic_bound: None,
            jump_multipliers,
        }
    }

    /// Puts every unknown whose value is known on it, exactly.
    pub fn rest_on_bounds(&mut self) {
        for ((value, bound), state) in
            self.values.iter_mut().zip(&self.inequality.bounds).zip(&self.state)
        {
            if let Some(known) = known_value(bound, *state) {
                *value = known;
            }
        }
    }

    /// Solves for the unknowns without contact.
    ///
    /// Always for a correction of the unknowns as they are: the same code starts from the last
    /// iterate and refines.
    pub fn solve_linear(&mut self, refinements: usize) -> Result<(), FactorError> {
        self.outer += 1;
        self.rest_on_bounds();
        let Inequality { matrix, load, bounds, symmetric, .. } = self.inequality;
        self.free.clear();
        let states = bounds.iter().zip(&self.state).enumerate();
        let free = states.filter(|(_, (bound, state))| known_value(bound, **state).is_none());
        self.free.extend(free.map(|(i, _)| i as u32));
        if let Some(hybrid) = self.hybrid.take() {
            let solved = self.solve_factored(&hybrid, refinements);
            self.hybrid = Some(hybrid);
            return solved;
        }
        let factors = if *symmetric {
            let order = match self.order.take() {
                Some(order) => order,
                None => EliminationOrder::for_inequality(self.inequality)?,
            };
            let order = self.order.insert(order);
            Factors::in_order(matrix, &self.free, order)?
        } else {
            Factors::new(matrix, false, &self.free)?
        };
        for _ in 0..=refinements {
            matrix.residual_f64(load, &self.values, &mut self.deficit);
            self.correction.clear();
            self.correction.extend(self.free.iter().map(|&i| T::lit(self.deficit[i as usize])));
            factors.solve_in_place(&mut self.correction, 1);
            for (&i, &correction) in self.free.iter().zip(&self.correction) {
                self.values[i as usize] += correction;
            }
        }
        matrix.residual_f64(load, &self.values, &mut self.deficit);
        Ok(())
    }

    /// The same where the matrix is kept factored: values and forces of jumps are corrected together,
    /// until corrections no longer get smaller. If they are not small then, the matrix is singular as
    /// far as this scalar can tell.
    fn solve_factored(
        &mut self,
        hybrid: &StaticCondensation<'a, T>,
        refinements: usize,
    ) -> Result<(), FactorError> {
        let Some(factored) = &self.inequality.penalised else { return Ok(()) };
        let mut is_free = vec![false; self.values.len()];
        self.free.iter().for_each(|&i| is_free[i as usize] = true);
        let factors = hybrid.factor(&is_free)?;
        let mut mismatch = vec![0.0; self.forces.len()];
        let mut least = f64::INFINITY;
        let mut is_lost = false;
        let floor = (CORRECTED * T::EPSILON).powi(2);
        for correction in 0..MOST_CORRECTIONS {
            let (values, forces) = (&self.values, &self.forces);
            let value = |i: usize| values[i].to_f64();
            for (jump, out) in mismatch.iter_mut().enumerate() {
                *out = factored.jump_residual(jump, value, forces[jump].to_f64());
            }
            factored.residual_with_jump_multipliers(
                value,
                |f| forces[f].to_f64(),
                &mut self.deficit,
            );
            let work = hybrid.solve(&factors, &is_free, &mut self.deficit, &mut mismatch);
            let (mut size, mut scale, mut sum) = (0.0_f64, 0.0_f64, 0.0);
            for (i, (value, change)) in self.values.iter_mut().zip(&self.deficit).enumerate() {
                *value += T::lit(*change);
                size = size.max(change.abs());
                scale = scale.max(value.to_f64().abs());
                sum += factored.stiffness_diagonal(i) * value.to_f64().powi(2);
            }
            for (force, change) in self.forces.iter_mut().zip(&mismatch) {
                *force += T::lit(*change);
            }
            let is_small = size <= CORRECTED * T::EPSILON * scale;
            // by a quarter of the digits; in energy, because single unknowns of thin cells may be lost
            let (values, forces) = (&self.values, &self.forces);
            let energy = factored.energy(|i| values[i].to_f64(), |f| forces[f].to_f64());
            // and beyond rounding, because constants have none
            is_lost = work.abs() > T::EPSILON.sqrt() * energy + floor * sum;
            // numbers that are not finite do not get smaller either
            let goes_on = size <= 0.5 * least && !is_small;
            if correction >= refinements && !goes_on {
                break;
            }
            least = size;
        }
        let (values, forces) = (&self.values, &self.forces);
        let force = |jump: usize| forces[jump].to_f64();
        factored.residual_with_jump_multipliers(|i| values[i].to_f64(), force, &mut self.deficit);
        if is_lost { Err(FactorError::Singular) } else { Ok(()) }
    }

    /// Finds the scale and keeps the iterate if it is the best; false if it is not finite.
    ///
    /// The measure is the projected Jacobi step `u - P(u - r / d)` in the energy norm of the
    /// diagonal: zero at the solution only, and, unlike relative measures, not flattered by
    /// iterates that are far too large.
    pub fn assess(&mut self) -> bool {
        let mut scale = 0.0_f64;
        let mut measure = 0.0;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let (x, value) = (self.values[i], self.values[i].to_f64());
            let d = positive_diagonal(self.inequality, i);
            let target = bound.nearest(T::lit(value + self.deficit[i] / d)).to_f64();
            scale = scale.max(value.abs()).max(bound.nearest(x).to_f64().abs());
            measure += d * (value - target).powi(2);
        }
        if !measure.is_finite() {
            return false;
        }
        self.scale = if scale > 0.0 { scale } else { 1.0 };
        if measure < self.best.measure {
            self.best.measure = measure;
            self.best.outer = self.outer;
            self.best.values.copy_from_slice(&self.values);
            self.best.state.copy_from_slice(&self.state);
            self.best.forces.copy_from_slice(&self.forces);
        }
        true
    }

    /// The number of linear systems when the best iterate was found.
    pub fn best_outer(&self) -> usize {
        self.best.outer
    }

    /// Lets go and takes hold; true if any unknown changed its state.
    pub fn change_state(&mut self, band: f64, spread: f64, history: &mut History) -> bool {
        let noise = self.gap_noise(band);
        let mut changed = false;
        // States are written after all are decided: the noise of a force looks at its neighbours'.
        let next: Vec<(u32, Contact)> = (0..self.state.len())
            .filter_map(|i| {
                let bound = &self.inequality.bounds[i];
                let x = self.values[i].to_f64();
                // Positive where the bound would have to pull.
                let pull = match self.state[i] {
                    _ if bound.fixed_value().is_some() => return None,
                    Contact::Inactive if bound.lower().is_some_and(|l| l.to_f64() - x > noise) => {
                        return Some((i as u32, Contact::Lower));
                    }
                    Contact::Inactive if bound.upper().is_some_and(|u| x - u.to_f64() > noise) => {
                        return Some((i as u32, Contact::Upper));
                    }
                    Contact::Inactive => return None,
                    Contact::Lower => self.deficit[i],
                    Contact::Upper => -self.deficit[i],
                };
                (pull > 0.0 && pull > self.force_noise(i, band, spread))
                    .then_some((i as u32, Contact::Inactive))
            })
            .collect();
        for (i, contact) in next {
            self.set_state(i as usize, contact, history);
            changed = true;
        }
        changed
    }

    /// Changes one state.
    pub fn set_state(&mut self, i: usize, contact: Contact, history: &mut History) {
        if self.state[i] != contact {
            self.state[i] = contact;
            history.moved(i);
        }
    }

    /// Moves to where an interior point method gets from the best iterate, or from where it stopped
    /// before; stays if it does not get anywhere.
    pub fn approach(&mut self) {
        let Best { values, forces, .. } = &self.best;
        let hybrid = self.hybrid.as_ref();
        let mut point = match self.path.take() {
            Some(path) => InteriorPoint::resume(self.inequality, hybrid, path),
            None => InteriorPoint::new(self.inequality, hybrid, values, forces),
        };
        let contact = point.run();
        self.outer += point.steps;
        if let Some(contact) = contact {
            let states = contact.iter().zip(&self.inequality.bounds);
            self.state = states.map(|(&contact, bound)| rest(bound, contact)).collect();
            self.values = point.values();
            self.forces = point.forces();
            self.path = point.into_path();
        }
    }

    /// Whether the interior point method believed in contact that it can still look at more closely.
    pub fn can_resume(&self) -> bool {
        self.path.is_some()
    }

    /// Moves every value into its bounds.
    pub fn admit(&mut self) {
        for (value, bound) in self.values.iter_mut().zip(&self.inequality.bounds) {
            *value = bound.nearest(*value);
        }
    }

    /// Whether no bound is violated beyond rounding.
    pub fn is_admissible(&self, band: f64) -> bool {
        let noise = self.gap_noise(band);
        let off = |(&x, bound): (&T, &Bound<T>)| (x.to_f64() - bound.nearest(x).to_f64()).abs();
        self.values.iter().zip(&self.inequality.bounds).map(off).all(|off| off <= noise)
    }

    /// The best values, and the forces of jumps.
    pub fn best_values(&self) -> (&[T], &[T]) {
        (&self.best.values, &self.best.forces)
    }

    /// Goes back to the best iterate.
    pub fn return_to_best(&mut self) {
        self.values.copy_from_slice(&self.best.values);
        self.state.copy_from_slice(&self.best.state);
        self.forces.copy_from_slice(&self.best.forces);
    }

    /// Puts every unknown on a bound, the lower one if it has two; false if none was off it.
    pub fn close(&mut self, history: &mut History) -> bool {
        let mut changed = false;
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let contact = match (bound.lower(), bound.upper()) {
                (Some(_), _) => Contact::Lower,
                (None, Some(_)) => Contact::Upper,
                (None, None) => Contact::Inactive,
            };
            changed |= contact != self.state[i];
            self.set_state(i, contact, history);
        }
        changed
    }

    /// Violations of a bound up to this are put down to rounding.
    pub fn gap_noise(&self, band: f64) -> f64 {
        band * T::EPSILON * self.scale
    }

    /// Multipliers of the wrong sign up to this are put down to rounding: `band` units of the
    /// forces of free neighbours in the scalar, of all others in `f64`, and `spread` units of the
    /// largest force the diagonal could exert.
    pub fn force_noise(&self, i: usize, band: f64, spread: f64) -> f64 {
        let Inequality { matrix, load, bounds, .. } = self.inequality;
        let global = positive_diagonal(self.inequality, i) * self.scale;
        let spread = spread * T::EPSILON * global;
        if let Some(hybrid) = &self.hybrid {
            let value = |j: usize| self.values[j].to_f64();
            let is_known = |j: usize| known_value(&bounds[j], self.state[j]).is_some();
            let (free, known) = hybrid.residual_term_sizes(i, &value, &self.forces, &is_known);
            return band * (T::EPSILON * free + f64::EPSILON * known) + spread;
        }
        let (columns, entries) = matrix.row(i);
        let mut free = 0.0;
        let mut known = load[i].to_f64().abs();
        for (&j, &a) in columns.iter().zip(entries) {
            let j = j as usize;
            let force = (a.to_f64() * self.values[j].to_f64()).abs();
            match known_value(&bounds[j], self.state[j]) {
                Some(_) => known += force,
                None => free += force,
            }
        }
        band * (T::EPSILON * free + f64::EPSILON * known) + spread
    }
}

/// The state an unknown can have under its bound: open where the bound named does not exist; on
/// the lower of two bounds that coincide.
pub(crate) fn rest<T: Real>(bound: &Bound<T>, contact: Contact) -> Contact {
    match contact {
        _ if bound.is_inequality() && bound.fixed_value().is_some() => Contact::Lower,
        Contact::Lower if bound.lower().is_some() => Contact::Lower,
        Contact::Upper if bound.upper().is_some() => Contact::Upper,
        _ => Contact::Inactive,
    }
}

/// The value an unknown has without solving for it.
pub(crate) fn known_value<T: Real>(bound: &Bound<T>, state: Contact) -> Option<T> {
    bound.fixed_value().or(match state {
        Contact::Inactive => None,
        Contact::Lower => bound.lower(),
        Contact::Upper => bound.upper(),
    })
}
