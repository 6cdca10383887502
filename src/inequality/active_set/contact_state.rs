//! Contact states: which one a bound admits, and which value it prescribes.

use crate::algebra::{Bound, Contact, Start};
use crate::real::Real;

/// The given contact state if the bound admits it; inactive if the lower or upper bound that the state
/// names does not exist; always lower if two bounds coincide.
pub(crate) fn admissible_state<T: Real>(bound: &Bound<T>, contact: Contact) -> Contact {
    match contact {
        _ if bound.is_inequality() && bound.fixed_value().is_some() => Contact::Lower,
        Contact::Lower if bound.lower().is_some() => Contact::Lower,
        Contact::Upper if bound.upper().is_some() => Contact::Upper,
        _ => Contact::Inactive,
    }
}

/// The value of a fixed or an active unknown; `None` if it is inactive.
pub(crate) fn prescribed_value<T: Real>(bound: &Bound<T>, state: Contact) -> Option<T> {
    bound.fixed_value().or(match state {
        Contact::Inactive => None,
        Contact::Lower => bound.lower(),
        Contact::Upper => bound.upper(),
    })
}

/// The admissible contact states of a start; inactive where the start names no state.
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
