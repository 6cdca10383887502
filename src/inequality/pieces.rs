//! Inequalities with kinks, solved piece by piece.
//!
//! On one side of each kink the convex function of an unknown is linear: its slope is load, its kink a bound. The solution
//! there is that of the whole problem unless the multiplier at a kink exceeds the jump of the slope. Such an unknown turns to the
//! other side of its kink. The solution at hand is admissible there too, and the next one has less energy: no piece
//! returns, and the last one is reached after finitely many.

use super::certificate::residual;
use super::{InitialGuess, Outcome, Solution};
use crate::algebra::{Bound, Contact, Inequality, RESULTANT_ROUNDING, Start};
use crate::real::Real;

/// Most pieces for which an inequality is solved.
const MOST_PIECES: usize = 100;
/// A multiplier turns a kink if it exceeds the jump of the slope by this many units of rounding in the residual.
const EXCESS: f64 = 64.0;

/// Solves an inequality by `solve`, which takes it without kinks in mind, and names the kinks that turned.
pub(super) fn solve_on_pieces<T: Real>(
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    solve: impl Fn(&Inequality<T>) -> Solution<T>,
) -> Solution<T> {
    if inequality.kinks.is_empty() || !inequality.is_well_formed() {
        return solve(inequality);
    }
    let mut piece = inequality.clone();
    turn_by_guess(&mut piece, guess.values.as_deref().unwrap_or_default());
    let (mut outer, mut linear, mut stages) = (0, 0, Vec::new());
    let mut left = MOST_PIECES;
    let mut solution = loop {
        let mut solution = solve_without_kinks(&mut piece, &solve);
        (outer, linear) = (outer + solution.outer, linear + solution.linear);
        stages.append(&mut solution.stages);
        if !matches!(solution.outcome, Outcome::Converged | Outcome::NotUnique) {
            break solution;
        }
        let beyond = beyond_the_jump(&piece, &solution);
        if beyond.is_empty() {
            break solution;
        }
        left -= 1;
        if left == 0 {
            solution.outcome = Outcome::IterationLimit;
            break solution;
        }
        let mut states = solution.contact;
        for k in beyond {
            piece.turn(k);
            states[piece.kinks[k].unknown as usize] = Contact::Inactive;
        }
        piece.start = Start::Contact(states);
    };
    (solution.outer, solution.linear, solution.stages) = (outer, linear, stages);
    if solution.outcome == Outcome::Converged && is_at_its_limit(&piece) {
        solution.outcome = Outcome::NotUnique;
        solution.algebraic_bound = None;
    }
    let is_turned =
        |&k: &u32| piece.kinks[k as usize].is_above != inequality.kinks[k as usize].is_above;
    solution.turned = (0..inequality.kinks.len() as u32).filter(is_turned).collect();
    solution
}

/// Whether the load on a body that kinks alone hold is the sum of their slopes, up to its uncertainty.
fn is_at_its_limit<T: Real>(piece: &Inequality<T>) -> bool {
    piece.bodies.iter().any(|body| {
        let Some(vector) = body.kernel.filter(|_| !body.stops_below && !body.stops_above) else {
            return false;
        };
        let mut load = body.resultant + piece.load_along(vector) - body.assembled;
        let mut limit = 0.0;
        for (k, kink) in piece.kinks.iter().enumerate() {
            let entries = &piece.kernel[vector];
            if let Ok(at) = entries.binary_search_by_key(&kink.unknown, |(i, _)| *i) {
                let value = entries[at].1.to_f64();
                load += value * piece.slope_at(k);
                limit += value.abs() * kink.slope.to_f64();
            }
        }
        let rounding = RESULTANT_ROUNDING * T::EPSILON * limit;
        (load.abs() - limit).abs() <= body.uncertainty.max(rounding)
    })
}

/// Solves a piece as an inequality without kinks, whose bounds stop bodies.
fn solve_without_kinks<T: Real>(
    piece: &mut Inequality<T>,
    solve: &impl Fn(&Inequality<T>) -> Solution<T>,
) -> Solution<T> {
    let (kinks, bodies) = (std::mem::take(&mut piece.kinks), piece.bodies.clone());
    for body in &mut piece.bodies {
        let Some(entries) = body.kernel.map(|k| &piece.kernel[k]) else { continue };
        for kink in kinks.iter().filter(|kink| kink.has_both_sides()) {
            if let Ok(k) = entries.binary_search_by_key(&kink.unknown, |(i, _)| *i) {
                let is_down = kink.is_above == (entries[k].1.to_f64() > 0.0);
                *(if is_down { &mut body.stops_below } else { &mut body.stops_above }) = true;
            }
        }
    }
    let solution = solve(piece);
    (piece.kinks, piece.bodies) = (kinks, bodies);
    solution
}

/// Turns kinks to the sides of the values of a guess, and the states of its start with them.
fn turn_by_guess<T: Real>(piece: &mut Inequality<T>, values: &[T]) {
    piece.turn_to(values);
    let Inequality { kinks, start: Start::Contact(states), .. } = piece else { return };
    for kink in kinks {
        let state = states.get_mut(kink.unknown as usize);
        if let Some(state) = state.filter(|state| **state != Contact::Inactive) {
            // beside bounds of its own nothing tells which of them a start means
            let is_alone = kink.own == Bound::Free;
            *state = kink.state().filter(|_| is_alone).unwrap_or_default();
        }
    }
}

/// The kinks at which the multiplier of a solution exceeds the jump of the slope.
fn beyond_the_jump<T: Real>(piece: &Inequality<T>, solution: &Solution<T>) -> Vec<usize> {
    let mut r = vec![0.0; piece.size()];
    residual(piece, &solution.values, &solution.jump_multipliers, &mut r);
    let is_beyond = |&k: &usize| {
        if !piece.sticks(k, &solution.contact) {
            return false;
        }
        let (i, jump) = (piece.kinks[k].unknown as usize, 2.0 * piece.kinks[k].slope.to_f64());
        let force = if piece.kinks[k].is_above { -r[i] } else { r[i] };
        let (columns, entries) = piece.matrix.row(i);
        let terms = columns
            .iter()
            .zip(entries)
            .map(|(&j, a)| (a.to_f64() * solution.values[j as usize].to_f64()).abs());
        let size = terms.sum::<f64>() + piece.load[i].to_f64().abs() + jump;
        force - jump > EXCESS * T::EPSILON * size
    };
    (0..piece.kinks.len()).filter(is_beyond).collect()
}
