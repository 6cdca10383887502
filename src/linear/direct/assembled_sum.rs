//! Solutions by factors of the assembled matrix `A = K + M^T S M`, and their jump multipliers.
//!
//! Rounding in `A` is a relative error of size `eps cond(A)` in a solution. The caller corrects values and jump
//! multipliers by the residuals of `K u + M^T p = r` and `M u - S^-1 p = t`, in which no weight is added to a stiffness:
//! where `eps cond(A)` is below one tenth or so, the corrections have all digits in the end.

use super::factors::Factors;
use crate::algebra::{JumpTerm, PenalisedMatrix};
use crate::real::Real;

/// Solves `K u + M^T p = r` on the free unknowns and `M u - S^-1 p = t` by the factors of `A`:
/// `A u = r + M^T S t`, `p = S (M u - t)`. Replaces `r` by `u`, which is zero on fixed unknowns, and `t` by `p`. Returns
/// `u.r - p.t`.
pub(super) fn solve_assembled<T: Real>(
    penalised: &PenalisedMatrix<T>,
    factors: &Factors<T>,
    is_free: &[bool],
    r: &mut [f64],
    t: &mut [f64],
) -> f64 {
    let mut load = r.to_vec();
    for (jump, t) in t.iter().enumerate() {
        let weighted = penalised.weights[jump].to_f64() * t;
        for term in penalised.terms_of(jump) {
            let product = term.weight.to_f64() * weighted;
            for (unknown, sign) in [(term.here, 1.0), (term.there, -1.0)] {
                if unknown != JumpTerm::<T>::NO_UNKNOWN {
                    load[unknown as usize] += sign * product;
                }
            }
        }
    }
    let free = || (0..is_free.len()).filter(|&i| is_free[i]);
    let mut x: Vec<T> = free().map(|i| T::lit(load[i])).collect();
    factors.solve_in_place(&mut x, 1);
    let mut energy = 0.0;
    let mut u = vec![0.0; r.len()];
    for (i, x) in free().zip(x) {
        u[i] = x.to_f64();
        energy += u[i] * r[i];
    }
    r.copy_from_slice(&u);
    for (jump, t) in t.iter_mut().enumerate() {
        let multiplier = penalised.weights[jump].to_f64() * (penalised.jump(jump, |i| u[i]) - *t);
        energy -= multiplier * *t;
        *t = multiplier;
    }
    energy
}
