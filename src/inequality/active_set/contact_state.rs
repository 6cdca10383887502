//! The contact states that a bound allows, and the values that contact states prescribe.

use crate::algebra::{Bound, Contact, Start};
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

/// The contact states of a start, made admissible by [`admissible_state`]. An unknown that the start does not name,
/// because its list is shorter, starts as inactive.
pub(crate) fn starting_states<T: Real>(bounds: &[Bound<T>], start: &Start) -> Vec<Contact> {
    let guess = match start {
        Start::Cold => &[],
        Start::Contact(guess) => guess.as_slice(),
    };
    let states = bounds.iter().enumerate();
    states
        .map(|(i, bound)| admissible_state(bound, guess.get(i).copied().unwrap_or_default()))
        .collect()
}
