//! The certificate: how well the complementarity conditions hold, from the data and `u` alone.

use crate::algebra::{Bound, Contact, Inequality};
use crate::instances::compiled;
use crate::real::Real;

/// Relative, dimensionless violations of the complementarity conditions of an [`Inequality`].
///
/// Notation: `r = A u - b`; `d` the diagonal of `A`; `E` the energy norm of the solution, the root
/// of `u.A u`; `U` the largest of all `|u_i|` and of all `|v_i|`, `v_i` the admissible value
/// nearest to `u_i`; the gap the distance to the nearer bound; the step `s_i = r_i / d_i` (its
/// sign turned at an upper bound), what one Gauss-Seidel correction would move. An unknown counts
/// as in contact if its gap is not larger than `|s_i|`. No state of any solver enters.
///
/// Why these scalings. *Displacements* (`feasibility`) are measured against `U`: by the comparison
/// principle a violation of the bound by `g` shifts the solution by `g`. Bounds that nothing comes
/// near (an obstacle at minus a million) do not enter `U`, or they would hide everything. *Forces*
/// are measured in the dual norm `sqrt(sum r_i^2 / d_i)` against `E`: half the square of
/// `r_i / sqrt(d_i)` is the energy that moving unknown `i` alone would still gain, so that each
/// measure bounds a relative distance to the solution from below. The plain 2-norm of `r` against
/// that of `b` says nothing for an over-penalised scheme: with entries of size `eta h^-2` it is
/// ruled by the penalty rows and cannot fall below rounding times the largest entry. Sums, not
/// maxima, because the force on one unknown shrinks like the volume of its patch: at small mesh
/// size every single wrong force is tiny while together they move the solution by its own size.
/// A sum is never below its largest term.
///
/// Where `u.A u` is not positive beyond rounding (a constant, zero), `sqrt(sum d_i u_i^2)` takes
/// the place of `E`, then `sqrt(sum b_i^2 / d_i)`, then one. All sums are in `f64`. If anything is
/// not finite or sizes do not match, all four are infinite.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Certificate {
    /// Largest violation of a bound or Dirichlet value, over `U`.
    pub feasibility: f64,
    /// Dual norm over `E` of the multipliers in contact that have the wrong sign, each counted up
    /// to the distance to the opposite bound, where it would have the right one.
    pub multiplier: f64,
    /// Energy norm with the diagonal, over `E`, of the smaller of gap and step where both are
    /// positive.
    pub complementarity: f64,
    /// Dual norm over `E` of the residual off contact; if larger, the largest difference, over `U`,
    /// of a jump and what its force makes of it ([`certify_with_jump_multipliers`]).
    pub residual: f64,
    /// Relative bound on the energy-norm distance to the discrete solution, where the solver knows
    /// one. It rests on one estimate, of the smallest eigenvalue of the preconditioned matrix.
    pub algebraic_bound: Option<f64>,
}

impl Certificate {
    /// What cannot be judged.
    pub const WORTHLESS: Self = Self {
        feasibility: f64::INFINITY,
        multiplier: f64::INFINITY,
        complementarity: f64::INFINITY,
        residual: f64::INFINITY,
        algebraic_bound: None,
    };

    /// The largest of the four violations.
    pub fn largest(&self) -> f64 {
        self.feasibility.max(self.multiplier).max(self.complementarity).max(self.residual)
    }
}

/// Certifies `u` as a solution of the inequality; see [`Certificate`].
pub fn certify<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Certificate {
    certify_with_jump_multipliers(inequality, u, &[])
}

/// The same with the forces `p` of the jumps of a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) matrix,
/// where they are known besides the values: forces are then `c - K u - M^T p`, without the rounding
/// that differences of values have, and what jumps and `p / s` differ by is measured as a
/// displacement. No forces (or not as many as jumps): those that the values have.
pub fn certify_with_jump_multipliers<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    forces: &[T],
) -> Certificate {
    compiled!(
        T: fn(&Inequality<T>, &[T], &[T]) -> Certificate
            = certificate_of
    )(inequality, u, forces)
}

fn certificate_of<T: Real>(inequality: &Inequality<T>, u: &[T], forces: &[T]) -> Certificate {
    certify_with_noise(inequality, u, forces).0
}

/// The certificate, and the size its forces have if every entry of `A u` is wrong by one unit of
/// `d_i U`: times the rounding unit, the level below which no solver can push them.
pub(crate) fn certify_with_noise<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    forces: &[T],
) -> (Certificate, f64) {
    let n = inequality.size();
    if !inequality.is_well_formed() || u.len() != n {
        return (Certificate::WORTHLESS, 0.0);
    }
    let Inequality { load, bounds, .. } = inequality;
    let mut deficit = vec![0.0; n];
    let mismatch = residual_with_forces(inequality, u, forces, &mut deficit);

    let mut displacement = 0.0_f64;
    let [mut work, mut energy, mut diagonal_energy, mut load_energy, mut stiffness] = [0.0; 5];
    let [mut wrong, mut complementarity, mut residual] = [0.0_f64; 3];
    let mut violation = 0.0_f64;
    for i in 0..n {
        let (x, b, r) = (u[i].to_f64(), load[i].to_f64(), -deficit[i]);
        let d = positive_diagonal(inequality, i);
        displacement = displacement.max(x.abs()).max(bounds[i].nearest(u[i]).to_f64().abs());
        energy += x * (b + r);
        work += (x * (b + r)).abs();
        diagonal_energy += d * x * x;
        load_energy += b * b / d;
        stiffness += d;
        let local = Local::new(&bounds[i], x, r / d);
        violation = violation.max(local.violation);
        wrong += d * local.wrong.powi(2);
        complementarity += d * local.complementarity.powi(2);
        residual += d * local.residual.powi(2);
    }
    if ![displacement, work, load_energy, wrong, residual, mismatch].iter().all(|x| x.is_finite()) {
        return (Certificate::WORTHLESS, 0.0);
    }
    let displacement = if displacement > 0.0 { displacement } else { 1.0 };
    let candidates = [energy, diagonal_energy, load_energy, 1.0];
    let least = [8.0 * f64::EPSILON * work, 0.0, 0.0, 0.0];
    let energy = (0..4).find(|&k| candidates[k] > least[k]).map_or(1.0, |k| candidates[k]);
    let norm = |sum: f64| (sum / energy).sqrt();
    let certificate = Certificate {
        feasibility: violation / displacement,
        multiplier: norm(wrong),
        complementarity: norm(complementarity),
        residual: norm(residual).max(mismatch / displacement),
        algebraic_bound: None,
    };
    (certificate, displacement * norm(stiffness))
}

/// `b - A u` with the forces of jumps if they are given; returns the largest difference of jumps.
fn residual_with_forces<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    forces: &[T],
    deficit: &mut [f64],
) -> f64 {
    let value = |i: usize| u[i].to_f64();
    match &inequality.factored {
        Some(factored) if forces.len() == factored.n_jumps() => {
            let force = |jump: usize| forces[jump].to_f64();
            factored.residual_with_forces(value, force, deficit);
            let mismatch = |jump| factored.mismatch(jump, value, force(jump)).abs();
            // written so that a number that is not finite stays
            (0..forces.len()).map(mismatch).fold(0.0, |m, x| if x <= m { m } else { x })
        }
        _ => {
            inequality.residual_f64(u, deficit);
            0.0
        }
    }
}

/// The diagonal entry as a scale: if it is not positive, the largest entry of the row, or one.
pub(crate) fn positive_diagonal<T: Real>(inequality: &Inequality<T>, i: usize) -> f64 {
    let d = inequality.matrix.get(i, i).to_f64();
    if d > 0.0 {
        return d;
    }
    let entries = inequality.matrix.row(i).1;
    let largest = entries.iter().map(|a| a.to_f64().abs()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// What one unknown contributes, as displacements.
#[derive(Default)]
struct Local {
    violation: f64,
    wrong: f64,
    complementarity: f64,
    residual: f64,
}

impl Local {
    /// `step` is `r_i / d_i`: positive where the unknown is pressed downwards.
    fn new<T: Real>(bound: &Bound<T>, x: f64, step: f64) -> Self {
        if let Some(value) = bound.only_value() {
            return Self { violation: (x - value.to_f64()).abs(), ..Self::default() };
        }
        let to_lower = bound.lower().map_or(f64::INFINITY, |l| x - l.to_f64());
        let to_upper = bound.upper().map_or(f64::INFINITY, |u| u.to_f64() - x);
        let (gap, opposite, pressed) = if to_lower <= to_upper {
            (to_lower, to_upper, step)
        } else {
            (to_upper, to_lower, -step)
        };
        let mut local = Self { violation: (-gap).max(0.0), ..Self::default() };
        if gap > step.abs() {
            local.residual = step;
        } else if pressed < 0.0 {
            local.wrong = (-pressed).min(opposite.max(0.0));
        }
        local.complementarity = gap.min(pressed).max(0.0);
        local
    }
}

/// Number of unknowns under an inequality that rest on a bound; Dirichlet ones do not count.
pub fn active<T: Real>(inequality: &Inequality<T>, contact: &[Contact]) -> usize {
    inequality
        .bounds
        .iter()
        .zip(contact)
        .filter(|(bound, state)| bound.is_inequality() && **state != Contact::Inactive)
        .count()
}
