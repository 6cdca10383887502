//! Bodies that bounds alone hold: whether a solution exists, and whether it is unique.
//!
//! Along a constant on a [`FreeBody`] the energy is linear, with the resultant of the load, negated, as slope. A
//! resultant that no bound opposes pulls the body away, and there is no solution; one that presses the body against
//! bounds is carried by them. Where the data, as integrated, do not tell the resultant from zero, a solution may be
//! moved as far as there is room between the bounds. (Fichera, Atti Accad. Naz. Lincei 7 (1964); Lions, Stampacchia,
//! Comm. Pure Appl. Math. 20 (1967) 493-519, section 5.)

use super::certificate::contact_states;
use super::history::Recorder;
use super::pieces::solve_on_pieces;
use super::validation::check_input;
use super::{InitialGuess, Outcome, Solution};
use crate::algebra::{Bound, FreeBody, Inequality, RESULTANT_ROUNDING};
use crate::real::Real;

/// The effect of the load on a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    /// It presses the body against lower bounds.
    Down,
    /// It presses the body against upper bounds.
    Up,
    /// No bound stops the direction of the load.
    Unbounded,
    /// The data do not tell the resultant from zero.
    Undecided,
}

/// A body with what the load does to it.
struct Tested {
    body: FreeBody,
    resultant: f64,
    motion: Motion,
}

/// The bodies that bounds alone hold. A body with an unknown between bounds that coincide is held.
fn tested<T: Real>(inequality: &Inequality<T>) -> Vec<Tested> {
    let bodies = match inequality.bodies.is_empty() {
        true => (0..inequality.kernel.len()).map(|k| body_of(inequality, k)).collect(),
        false => inequality.bodies.clone(),
    };
    let is_fixed = |&(i, _): &(u32, T)| inequality.bounds[i as usize].fixed_value().is_some();
    let is_held = |body: &FreeBody| {
        body.kernel.is_some_and(|vector| inequality.kernel[vector].iter().any(is_fixed))
    };
    let free = bodies.into_iter().filter(|body| !is_held(body));
    free.map(|body| {
        // of the present load
        let added = body.kernel.map_or(0.0, |k| inequality.load_along(k) - body.assembled);
        let resultant = body.resultant + added;
        let motion = match resultant {
            r if r.abs() <= body.uncertainty => Motion::Undecided,
            r if r < 0.0 && body.stops_below => Motion::Down,
            r if r > 0.0 && body.stops_above => Motion::Up,
            _ => Motion::Unbounded,
        };
        Tested { body, resultant, motion }
    })
    .collect()
}

/// The body of the kernel vector at a position, by load and bounds alone: the uncertainty is rounding.
fn body_of<T: Real>(inequality: &Inequality<T>, position: usize) -> FreeBody {
    let (mut stops_below, mut stops_above, mut terms) = (false, false, 0.0);
    for &(i, value) in &inequality.kernel[position] {
        let (value, bound) = (value.to_f64(), &inequality.bounds[i as usize]);
        let (below, above) = (bound.lower().is_some(), bound.upper().is_some());
        stops_below |= if value > 0.0 { below } else { above };
        stops_above |= if value > 0.0 { above } else { below };
        terms += (value * inequality.load[i as usize].to_f64()).abs();
    }
    let resultant = inequality.load_along(position);
    FreeBody {
        kernel: Some(position),
        resultant,
        uncertainty: RESULTANT_ROUNDING * T::EPSILON * terms,
        stops_below,
        stops_above,
        assembled: resultant,
    }
}

/// Solves an inequality by `solve`, unless bodies that bounds alone hold have no solution ([`Outcome::NoSolution`],
/// with admissible values) or many ([`Outcome::NotUnique`], with one of them). The solution has the number of linear
/// systems and the history that `solve` records, of all its calls.
///
/// Bounds that the load does not press against are left out of a first solve: those of a body that the load presses
/// against its other bounds, and all bounds of a body with an undecided resultant, of which one value is prescribed
/// instead. This is a solution if the values, moved by a constant where the resultant is undecided, are within the
/// bounds left out. Else these bounds act, and the next solve has them.
pub(crate) fn solve_with_kernel<T: Real>(
    inequality: &Inequality<T>,
    guess: &InitialGuess<T>,
    solve: impl Fn(&Inequality<T>, &Recorder<'_>) -> Solution<T>,
) -> Solution<T> {
    let recorder = Recorder::new(&guess.steps, guess.keeps_history);
    let mut solution = solve_on_pieces(inequality, guess, |inequality| {
        solve_with_bodies(inequality, |inequality| solve(inequality, &recorder))
    });
    let (systems, history) = recorder.finish();
    (solution.systems, solution.history) = (Some(systems), history);
    solution
}

fn solve_with_bodies<T: Real>(
    inequality: &Inequality<T>,
    solve: impl Fn(&Inequality<T>) -> Solution<T>,
) -> Solution<T> {
    if inequality.kernel.is_empty() && inequality.bodies.is_empty() {
        return solve(inequality);
    }
    if let Err(outcome) = check_input(inequality) {
        return Solution::without_iterate(inequality, outcome);
    }
    let tested = tested(inequality);
    if tested.iter().any(|tested| tested.motion == Motion::Unbounded) {
        return Solution::without_iterate(inequality, Outcome::NoSolution);
    }
    let mut relaxed = relaxations(inequality, &tested);
    let (mut outer, mut linear, mut stages) = (0, 0, Vec::new());
    let mut solution = loop {
        let mut solution = match relaxed.is_empty() {
            true => solve(inequality),
            false => solve(&relax(inequality, &relaxed)),
        };
        (outer, linear) = (outer + solution.outer, linear + solution.linear);
        stages.append(&mut solution.stages);
        let n_relaxed = relaxed.len();
        relaxed.retain(|&(vector, motion)| {
            let entries = &inequality.kernel[vector];
            match motion {
                Motion::Undecided => move_within_bounds(inequality, entries, &mut solution.values),
                _ => are_admissible(inequality, entries, &solution.values),
            }
        });
        if relaxed.len() == n_relaxed {
            // states of the solve with bounds left out are not those of values that were moved
            if !relaxed.is_empty() && solution.outcome == Outcome::Converged {
                let Solution { values, jump_multipliers, .. } = &solution;
                solution.contact = contact_states(inequality, values, jump_multipliers);
            }
            break solution;
        }
    };
    (solution.outer, solution.linear, solution.stages) = (outer, linear, stages);
    let is_undecided = |tested: &Tested| {
        let FreeBody { kernel, stops_below, stops_above, .. } = tested.body;
        let has_room = relaxed.iter().any(|(vector, _)| kernel == Some(*vector));
        tested.motion == Motion::Undecided && (has_room || !(stops_below && stops_above))
    };
    if solution.outcome == Outcome::Converged && tested.iter().any(is_undecided) {
        solution.outcome = Outcome::NotUnique;
        solution.algebraic_bound = None;
    }
    solution
}

/// The kernel vectors of which bounds are left out of the first solve, with what the load does to all bodies of each.
fn relaxations<T: Real>(inequality: &Inequality<T>, tested: &[Tested]) -> Vec<(usize, Motion)> {
    let relaxation = |vector: usize| {
        let mut of_vector = tested.iter().filter(|tested| tested.body.kernel == Some(vector));
        let motion = of_vector.next()?.motion;
        if of_vector.any(|tested| tested.motion != motion) {
            return None;
        }
        let is_left_out = |&(i, _): &(u32, T)| {
            let bound = &inequality.bounds[i as usize];
            keep(bound, motion) != *bound
        };
        let is_relaxed =
            motion == Motion::Undecided || inequality.kernel[vector].iter().any(is_left_out);
        is_relaxed.then_some((vector, motion))
    };
    (0..inequality.kernel.len()).filter_map(relaxation).collect()
}

/// The bound without the sides that the load does not press against.
fn keep<T: Real>(bound: &Bound<T>, motion: Motion) -> Bound<T> {
    match motion {
        Motion::Down => bound.lower().map_or(Bound::Free, Bound::Lower),
        Motion::Up => bound.upper().map_or(Bound::Free, Bound::Upper),
        _ => Bound::Free,
    }
}

/// The inequality without the bounds left out. One value of a body with an undecided resultant is prescribed.
fn relax<T: Real>(inequality: &Inequality<T>, relaxed: &[(usize, Motion)]) -> Inequality<T> {
    let mut trial = inequality.clone();
    for &(vector, motion) in relaxed {
        let entries = &inequality.kernel[vector];
        for &(i, _) in entries {
            trial.bounds[i as usize] = keep(&inequality.bounds[i as usize], motion);
        }
        if motion == Motion::Undecided {
            trial.bounds[entries[0].0 as usize] = Bound::Fixed(T::lit(0.0));
        }
    }
    let is_pinned = |vector: usize| relaxed.contains(&(vector, Motion::Undecided));
    let kernel = std::mem::take(&mut trial.kernel).into_iter().enumerate();
    trial.kernel = kernel.filter(|(vector, _)| !is_pinned(*vector)).map(|(_, w)| w).collect();
    trial.bodies.clear();
    trial
}

/// Whether the values of the unknowns of a kernel vector are within their bounds.
fn are_admissible<T: Real>(inequality: &Inequality<T>, entries: &[(u32, T)], values: &[T]) -> bool {
    let is_admissible = |&(i, _): &(u32, T)| {
        let (bound, x) = (&inequality.bounds[i as usize], values[i as usize]);
        bound.nearest(x) == x
    };
    entries.iter().all(is_admissible)
}

/// Moves the bodies that touch no bound in the direction of their load, along constants, until each touches one. The
/// energy falls, and no residual changes. Where the load on a body is small beside the energy of others, no certificate
/// sees where the body is: this load alone says it.
pub(super) fn press_onto_bounds<T: Real>(inequality: &Inequality<T>, values: &mut [T]) {
    for (vector, entries) in inequality.kernel.iter().enumerate() {
        let load = inequality.load_along(vector);
        // the bound in the direction of the load, and how far the body may go there
        let room = |&(i, value): &(u32, T)| {
            let (bound, x) = (&inequality.bounds[i as usize], values[i as usize]);
            let is_up = load * value.to_f64() > 0.0;
            let limit = if is_up { bound.upper() } else { bound.lower() }.or(bound.fixed_value())?;
            Some(((limit - x).to_f64() / (load * value.to_f64()), i, limit))
        };
        let nearest = entries.iter().filter_map(room).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((length, first, limit)) = nearest.filter(|(length, ..)| *length > 0.0) else {
            continue;
        };
        for &(i, value) in entries {
            let moved = values[i as usize] + T::lit(length * load * value.to_f64());
            values[i as usize] = inequality.bounds[i as usize].nearest(moved);
        }
        values[first as usize] = limit;
    }
}

/// Adds the multiple of a kernel vector, of smallest absolute value, with which all bounds of its unknowns hold;
/// returns whether there is more than one such multiple, apart from rounding.
fn move_within_bounds<T: Real>(
    inequality: &Inequality<T>,
    entries: &[(u32, T)],
    values: &mut [T],
) -> bool {
    let (mut least, mut most, mut size) = (f64::NEG_INFINITY, f64::INFINITY, 0.0_f64);
    for &(i, value) in entries {
        let (x, value) = (values[i as usize].to_f64(), value.to_f64());
        let bound = &inequality.bounds[i as usize];
        let mut ratio = |limit: Option<T>| {
            limit.map(|limit| {
                size = size.max((limit.to_f64() / value).abs()).max((x / value).abs());
                (limit.to_f64() - x) / value
            })
        };
        let (from_lower, from_upper) = (ratio(bound.lower()), ratio(bound.upper()));
        let (low, high) =
            if value > 0.0 { (from_lower, from_upper) } else { (from_upper, from_lower) };
        least = least.max(low.unwrap_or(f64::NEG_INFINITY));
        most = most.min(high.unwrap_or(f64::INFINITY));
    }
    if most - least <= RESULTANT_ROUNDING * T::EPSILON * size {
        return false;
    }
    let multiple = 0.0_f64.max(least).min(most);
    for &(i, value) in entries {
        let moved = values[i as usize] + T::lit(multiple * value.to_f64());
        values[i as usize] = inequality.bounds[i as usize].nearest(moved);
    }
    true
}

/// What [`Outcome::NoSolution`] and [`Outcome::NotUnique`] say of an inequality, in one sentence with the resultant;
/// `None` for other outcomes.
pub(crate) fn explanation<T: Real>(inequality: &Inequality<T>, outcome: Outcome) -> Option<String> {
    let motion = match outcome {
        Outcome::NoSolution => Motion::Unbounded,
        Outcome::NotUnique => Motion::Undecided,
        _ => return None,
    };
    let tested = tested(inequality);
    let Tested { body, resultant, .. } = tested.iter().find(|tested| tested.motion == motion)?;
    Some(match motion {
        Motion::Unbounded => format!("{}: its resultant is {resultant:.6e}", outcome.message()),
        _ => format!(
            "the data, as integrated, do not decide whether the load presses or pulls a body that only its bounds or friction hold: its resultant is {resultant:.2e}, and up to {:.2e} it counts as none; the values are one of the solutions, which differ there by a constant",
            body.uncertainty
        ),
    })
}
