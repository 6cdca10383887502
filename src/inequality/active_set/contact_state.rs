//! The contact states that a bound allows, and the values that contact states prescribe.

use crate::algebra::{Bound, Contact, Inequality, Start};
use crate::parallel::vectors::collect;
use crate::real::Real;

/// The given contact state if the bound has the side that the state names, else inactive. Always lower if lower and
/// upper bound coincide: such an unknown is active from the start. Inactive for a fixed unknown.
pub(crate) fn admissible_state<T: Real>(bound: &Bound<T>, contact: Contact) -> Contact {
    match contact {
        _ if bound.is_inequality() && bound.fixed_value().is_some() => Contact::Lower,
        Contact::Lower if bound.lower().is_some() => Contact::Lower,
        Contact::Upper if bound.upper().is_some() => Contact::Upper,
        _ => Contact::Inactive,
    }
}

/// The value of a fixed unknown, in every state, or of an active one; `None` if it is inactive.
pub(crate) fn prescribed_value<T: Real>(bound: &Bound<T>, state: Contact) -> Option<T> {
    bound.fixed_value().or(match state {
        Contact::Inactive => None,
        Contact::Lower => bound.lower(),
        Contact::Upper => bound.upper(),
    })
}

/// The state of the bound that `x` violates by more than a tolerance, and the violation; the lower bound counts first.
#[inline]
pub(crate) fn violated_bound<T: Real>(
    bound: &Bound<T>,
    x: f64,
    tolerance: f64,
) -> Option<(Contact, f64)> {
    let [to_lower, to_upper] = bound.distances(x);
    match () {
        () if -to_lower > tolerance => Some((Contact::Lower, -to_lower)),
        () if -to_upper > tolerance => Some((Contact::Upper, -to_upper)),
        () => None,
    }
}

/// The contact states of the start of an inequality, made admissible by [`admissible_state`]. An unknown that the start
/// does not name, because its list is shorter, starts as inactive. Where no unknown of a body that bounds alone hold is
/// active, all of them are, at their lower bounds if they have two: else the matrix is singular.
pub(crate) fn starting_states<T: Real>(inequality: &Inequality<T>) -> Vec<Contact> {
    let Inequality { bounds, start, kernel, .. } = inequality;
    let guess = match start {
        Start::Cold => &[],
        Start::Contact(guess) => guess.as_slice(),
    };
    let guess_at = |i: usize| guess.get(i).copied().unwrap_or_default();
    let mut states = collect(bounds.len(), |i| admissible_state(&bounds[i], guess_at(i)));
    for body in kernel {
        let unknowns = || body.iter().map(|&(i, _)| i as usize);
        if unknowns().all(|i| states[i] == Contact::Inactive) {
            for i in unknowns() {
                let lower = admissible_state(&bounds[i], Contact::Lower);
                let upper = admissible_state(&bounds[i], Contact::Upper);
                states[i] = if lower == Contact::Inactive { upper } else { lower };
            }
        }
    }
    states
}
