//! Directions in which the energy does not grow: whether a solution exists, and whether it is unique.
//!
//! `A` is positive semidefinite with the kernel of [`Inequality::kernel`]: constants on components of the domain that
//! neither Dirichlet data nor a reaction hold. A kernel vector `w` is a direction of recession if no bound limits
//! `t > 0` in `u + t w`. The energy along `u + t w` is linear in `t` with slope `-b.w`: a load with `b.w > 0` pulls the
//! component away and there is no solution; for `b.w = 0` a solution may be moved along `w`; for `b.w < 0` the load
//! presses the component against its bounds. (Fichera, Atti Accad. Naz. Lincei 7 (1964); Lions, Stampacchia, Comm. Pure
//! Appl. Math. 20 (1967) 493-519, section 5.)

use super::{Outcome, Solution};
use crate::algebra::{Bound, Inequality};
use crate::real::Real;

/// The multiple of machine epsilon times the sum of the absolute values of its terms below which a
/// resultant of the load counts as zero.
const ROUNDING: f64 = 64.0;

/// The energy along a kernel vector and its negative, within the bounds.
enum Motion {
    /// Bounded below, with a bounded set of minimisers: bounds stop both directions, or the one of the load.
    Stopped,
    /// Without a lower bound: no bound stops the direction of the load.
    Unbounded,
    /// Constant, because the load is balanced; bounds stop one direction at most.
    Balanced,
}

/// Solves an inequality by `solve` if there is no kernel vector or all of them are [`Motion::Stopped`]. Else the
/// outcome is [`Outcome::NoSolution`] with admissible values if one is [`Motion::Unbounded`], or [`Outcome::NotUnique`]
/// with a solution: that of the problem in which components with a balanced load have no bounds and one prescribed
/// value, moved along the kernel vectors until all bounds hold.
pub(crate) fn solve_with_kernel<T: Real>(
    inequality: &Inequality<T>,
    solve: impl FnOnce(&Inequality<T>) -> Solution<T>,
) -> Solution<T> {
    // the solver returns the outcome of an inequality that is not well formed
    if inequality.kernel.is_empty() || !inequality.is_well_formed() {
        return solve(inequality);
    }
    let motions: Vec<Motion> = inequality.kernel.iter().map(|w| motion(inequality, w)).collect();
    if motions.iter().any(|motion| matches!(motion, Motion::Unbounded)) {
        return Solution::without_iterate(inequality, Outcome::NoSolution);
    }
    let of_kernel = inequality.kernel.iter().zip(&motions);
    let balanced: Vec<&[(u32, T)]> = of_kernel
        .filter(|(_, motion)| matches!(motion, Motion::Balanced))
        .map(|(w, _)| w.as_slice())
        .collect();
    if balanced.is_empty() {
        return solve(inequality);
    }
    let mut fixed = inequality.clone();
    fixed.kernel.clear();
    for kernel_vector in &balanced {
        for &(i, _) in *kernel_vector {
            fixed.bounds[i as usize] = Bound::Free;
        }
        fixed.bounds[kernel_vector[0].0 as usize] = Bound::Fixed(T::lit(0.0));
    }
    let mut solution = solve(&fixed);
    if solution.outcome == Outcome::Converged {
        for kernel_vector in balanced {
            move_within_bounds(inequality, kernel_vector, &mut solution.values);
        }
        solution.outcome = Outcome::NotUnique;
        solution.algebraic_bound = None;
    }
    solution
}

/// The motion along a kernel vector.
fn motion<T: Real>(inequality: &Inequality<T>, kernel_vector: &[(u32, T)]) -> Motion {
    let (mut resultant, mut terms) = (0.0, 0.0);
    // whether a bound stops the direction of the vector, and the opposite one
    let (mut stops_along, mut stops_against) = (false, false);
    for &(i, value) in kernel_vector {
        let (i, value) = (i as usize, value.to_f64());
        let bound = &inequality.bounds[i];
        if bound.fixed_value().is_some() {
            return Motion::Stopped;
        }
        let term = value * inequality.load[i].to_f64();
        resultant += term;
        terms += term.abs();
        let (below, above) = (bound.lower().is_some(), bound.upper().is_some());
        stops_along |= if value > 0.0 { above } else { below };
        stops_against |= if value > 0.0 { below } else { above };
    }
    if stops_along && stops_against {
        return Motion::Stopped;
    }
    let tolerance = ROUNDING * T::EPSILON * terms;
    if resultant.abs() <= tolerance {
        Motion::Balanced
    } else if (resultant > 0.0 && stops_along) || (resultant < 0.0 && stops_against) {
        Motion::Stopped
    } else {
        Motion::Unbounded
    }
}

/// Adds the multiple of a kernel vector, of smallest absolute value, with which all bounds of its unknowns hold.
fn move_within_bounds<T: Real>(
    inequality: &Inequality<T>,
    kernel_vector: &[(u32, T)],
    values: &mut [T],
) {
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for &(i, value) in kernel_vector {
        let (x, value) = (values[i as usize].to_f64(), value.to_f64());
        let bound = &inequality.bounds[i as usize];
        let ratio = |limit: Option<T>| limit.map(|limit| (limit.to_f64() - x) / value);
        let (from_lower, from_upper) = (ratio(bound.lower()), ratio(bound.upper()));
        let (low, high) =
            if value > 0.0 { (from_lower, from_upper) } else { (from_upper, from_lower) };
        least = least.max(low.unwrap_or(f64::NEG_INFINITY));
        most = most.min(high.unwrap_or(f64::INFINITY));
    }
    let multiple = 0.0_f64.max(least).min(most);
    for &(i, value) in kernel_vector {
        let moved = values[i as usize] + T::lit(multiple * value.to_f64());
        values[i as usize] = inequality.bounds[i as usize].nearest(moved);
    }
}
