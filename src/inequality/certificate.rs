//! The certificate: violations of the complementarity conditions, computed from the data and `u` alone.

use super::scales::Scales;
use crate::algebra::{Bound, Contact, Inequality};
use crate::instances::compiled;
use crate::real::Real;

/// Relative, dimensionless violations of the complementarity conditions of an [`Inequality`].
///
/// Notation: `r = A u - b`; `d` the diagonal of `A`; `E` the energy norm of the solution, with its
/// Dirichlet data subtracted where they are imposed weakly
/// ([`DirichletEnergy`](crate::algebra::DirichletEnergy)); `v_i` the admissible value nearest to
/// `u_i`; `U` the largest of all `|u_i|` and `|v_i|`; the gap the distance of `u_i` from the nearer
/// bound; the step `s_i = r_i / d_i`, its sign reversed if the upper bound is nearer: a Gauss-Seidel
/// correction towards this bound. An unknown counts as active if its gap is at most `|s_i|`. No
/// contact state of a solver enters.
///
/// Reasons for these scalings. *Violations of bounds* (`feasibility`) are relative to `U`: by the
/// comparison principle a violation of a bound by `g` changes the solution by `g` at most. Bounds
/// far from the solution (an obstacle at minus a million) do not enter `U`, where they would hide
/// everything else. *Residuals and multipliers* are relative to `E` in the dual norm
/// `(sum r_i^2 / d_i)^(1/2)`: `r_i^2 / (2 d_i)` is the decrease of the energy by a correction of
/// unknown `i` alone, so that each measure bounds a relative distance to the solution from below.
/// The Euclidean norm of `r` divided by the Euclidean norm of `b` is no measure for an
/// over-penalised scheme: with entries of size `eta h^-2` (`eta` the penalty, `h` the mesh size) it
/// is dominated by the penalty rows and cannot fall below rounding times the largest entry. Sums,
/// not maxima, because the multiplier of one unknown shrinks like the volume of its patch: on a
/// fine mesh each wrong multiplier is tiny, while all of them together may change the solution by
/// as much as the solution itself. A sum is never below its largest term.
///
/// Where the energy vanishes up to rounding (a constant, zero), the norm `(sum c_i^2 / d_i)^(1/2)` of the
/// load `c` without Dirichlet data replaces `E`, then `(sum d_i u_i^2)^(1/2)`, then one. All sums are in
/// `f64`, of numbers divided by a power of two near the largest, so that the certificate of
/// multiples of data is that of the data. If a number is not finite or sizes do not match, all four
/// violations are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Certificate {
    /// Largest violation of a bound or Dirichlet value, divided by `U`.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub feasibility: f64,
    /// Dual norm, divided by `E`, of the multipliers of active unknowns with the wrong sign. Each
    /// counts at most with the multiplier whose step reaches the opposite bound, where its sign
    /// would be right.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub multiplier: f64,
    /// `(sum d_i min(gap_i, s_i)^2)^(1/2)` divided by `E`, the sum over all `i` with positive gap
    /// and step.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub complementarity: f64,
    /// Dual norm of the residual on inactive unknowns divided by `E`; or, if larger, the largest
    /// difference between a jump and the jump that its multiplier determines, divided by `U`
    /// ([`certify_with_jump_multipliers`]).
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub residual: f64,
    /// Bound on the relative algebraic error in the energy norm, if the solver computes one; else
    /// `None`. It rests on an estimate of the smallest eigenvalue of the preconditioned matrix and,
    /// for a matrix that is not symmetric, on the assumption that no strongly active unknown
    /// becomes inactive.
    pub algebraic_bound: Option<f64>,
}

impl Certificate {
    /// The certificate of values that are not finite or do not fit the inequality.
    pub const INVALID: Self = Self::new([f64::INFINITY; 4]);

    /// A certificate with the four violations in the order of the fields and without a bound on the
    /// algebraic error.
    #[must_use]
    pub const fn new([feasibility, multiplier, complementarity, residual]: [f64; 4]) -> Self {
        Self { feasibility, multiplier, complementarity, residual, algebraic_bound: None }
    }

    /// Sets the bound on the relative algebraic error.
    #[must_use]
    pub fn with_algebraic_bound(mut self, bound: Option<f64>) -> Self {
        self.algebraic_bound = bound;
        self
    }

    /// Whether the four violations are within [`Real::CERTIFICATE_LIMIT`], and the bound on the
    /// algebraic error, where it is known, within [`Real::ALGEBRAIC_BOUND_LIMIT`].
    #[must_use]
    pub fn is_within_limits<T: Real>(&self) -> bool {
        self.largest() <= T::CERTIFICATE_LIMIT
            && self.algebraic_bound.is_none_or(|bound| bound <= T::ALGEBRAIC_BOUND_LIMIT)
    }

    /// The largest of the four violations.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.feasibility.max(self.multiplier).max(self.complementarity).max(self.residual)
    }
}

/// The certificate of `u` as a solution of the inequality.
#[must_use]
pub fn certify<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Certificate {
    certify_with_jump_multipliers(inequality, u, &[])
}

/// The certificate of `u` together with the jump multipliers `p` of a
/// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix): the residual is `c - K u - M^T p`, without the
/// rounding of differences of values, and the largest `|g - M u + p / s|`, `s` the weight of a jump, is
/// divided by `U`.
/// Without jump multipliers, or if their number is not that of the jumps, `p = S (M u - g)`.
#[must_use]
pub fn certify_with_jump_multipliers<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> Certificate {
    compiled!(
        T: fn(&Inequality<T>, &[T], &[T]) -> Certificate
            = certificate_of
    )(inequality, u, jump_multipliers)
}

fn certificate_of<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> Certificate {
    certify_with_rounding(inequality, u, jump_multipliers).0
}

/// The certificate, and the dual norm, divided by `E`, of the vector with the entries `d_i U`. This
/// second number times machine epsilon is the size of rounding errors in `A u`, below which no
/// solver can reduce the residual.
pub(crate) fn certify_with_rounding<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> (Certificate, f64) {
    let n = inequality.size();
    if !inequality.is_well_formed() || u.len() != n {
        return (Certificate::INVALID, 0.0);
    }
    let bounds = &inequality.bounds;
    let mut r = vec![0.0; n];
    let mismatch = residual_and_mismatch(inequality, u, jump_multipliers, &mut r);
    let diagonal: Vec<f64> = (0..n).map(|i| positive_diagonal(inequality, i)).collect();
    let unit = unit(bounds, u, &r, &diagonal);
    let scales = Scales::of(inequality, u, &r, jump_multipliers, &|i| diagonal[i], unit);
    let [mut multiplier, mut complementarity, mut residual, mut stiffness] = [0.0_f64; 4];
    let mut violation = 0.0_f64;
    for i in 0..n {
        let d = diagonal[i];
        stiffness += d;
        let local = LocalViolation::new(&bounds[i], u[i].to_f64(), -r[i] / d);
        violation = violation.max(local.feasibility);
        multiplier += d * (local.multiplier / unit).powi(2);
        complementarity += d * (local.complementarity / unit).powi(2);
        residual += d * (local.residual / unit).powi(2);
    }
    let Scales { max_norm, energy_norm } = scales;
    if ![max_norm, energy_norm, multiplier, residual, mismatch].iter().all(|x| x.is_finite()) {
        return (Certificate::INVALID, 0.0);
    }
    let norm = |sum: f64| sum.sqrt() / (energy_norm / unit);
    let certificate = Certificate {
        feasibility: violation / max_norm,
        multiplier: norm(multiplier),
        complementarity: norm(complementarity),
        residual: norm(residual).max(mismatch / max_norm),
        algebraic_bound: None,
    };
    (certificate, max_norm / unit * norm(stiffness))
}

/// The energy norm `E` of `u` to which certificates and tolerances are relative.
pub(crate) fn energy_norm<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> f64 {
    let mut r = vec![0.0; inequality.size()];
    residual_and_mismatch(inequality, u, jump_multipliers, &mut r);
    let diagonal = |i: usize| positive_diagonal(inequality, i);
    Scales::of(inequality, u, &r, jump_multipliers, &diagonal, 1.0).energy_norm
}

/// A power of two near the largest of all values, admissible values and Jacobi corrections; one if all
/// are zero or one is not finite.
fn unit<T: Real>(bounds: &[Bound<T>], u: &[T], r: &[f64], diagonal: &[f64]) -> f64 {
    let size = |i: usize| {
        let nearest = bounds[i].nearest(u[i]).to_f64().abs();
        u[i].to_f64().abs().max(nearest).max(r[i].abs() / diagonal[i])
    };
    let largest = (0..u.len()).map(size).fold(0.0, f64::max);
    if largest > 0.0 && largest.is_finite() { largest.log2().floor().exp2() } else { 1.0 }
}

/// Sets `residual` to `b - A u`, or to `c - K u - M^T p` if the jump multipliers `p` are given;
/// returns the largest `|g - M u + p / s|`, zero without jump multipliers.
fn residual_and_mismatch<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
    residual: &mut [f64],
) -> f64 {
    let value = |i: usize| u[i].to_f64();
    match &inequality.penalised {
        Some(penalised) if jump_multipliers.len() == penalised.n_jumps() => {
            let multiplier = |jump: usize| jump_multipliers[jump].to_f64();
            penalised.residual_with_jump_multipliers(value, multiplier, residual);
            let mismatch = |jump| penalised.jump_residual(jump, value, multiplier(jump)).abs();
            // unlike f64::max this keeps a number that is not finite
            (0..jump_multipliers.len()).map(mismatch).fold(0.0, |m, x| if x <= m { m } else { x })
        }
        _ => {
            inequality.residual_f64(u, residual);
            0.0
        }
    }
}

/// The diagonal entry of row `i` as a positive scale: if it is not positive, the largest absolute
/// entry of the row, or one if the row is zero.
pub(crate) fn positive_diagonal<T: Real>(inequality: &Inequality<T>, i: usize) -> f64 {
    let d = inequality.matrix.get(i, i).to_f64();
    if d > 0.0 {
        return d;
    }
    let entries = inequality.matrix.row(i).1;
    let largest = entries.iter().map(|a| a.to_f64().abs()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// The violations of one unknown, each as a change of its value.
#[derive(Default)]
struct LocalViolation {
    feasibility: f64,
    multiplier: f64,
    complementarity: f64,
    residual: f64,
}

impl LocalViolation {
    /// The violations for the value `x` and `step = r_i / d_i`, which is positive where a Gauss-Seidel
    /// correction would decrease the value.
    fn new<T: Real>(bound: &Bound<T>, x: f64, step: f64) -> Self {
        if let Some(value) = bound.fixed_value() {
            return Self { feasibility: (x - value.to_f64()).abs(), ..Self::default() };
        }
        let to_lower = bound.lower().map_or(f64::INFINITY, |l| x - l.to_f64());
        let to_upper = bound.upper().map_or(f64::INFINITY, |u| u.to_f64() - x);
        let (gap, to_opposite, step_to_bound) = if to_lower <= to_upper {
            (to_lower, to_upper, step)
        } else {
            (to_upper, to_lower, -step)
        };
        let mut local = Self { feasibility: (-gap).max(0.0), ..Self::default() };
        if gap > step.abs() {
            local.residual = step;
        } else if step_to_bound < 0.0 {
            local.multiplier = (-step_to_bound).min(to_opposite.max(0.0));
        }
        local.complementarity = gap.min(step_to_bound).max(0.0);
        local
    }
}

/// The contact states of values that a solver without them found: active at the nearer bound is an unknown
/// whose gap is at most the Gauss-Seidel step `r_i / d_i` towards this bound.
#[must_use]
pub fn contact_of<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Vec<Contact> {
    let mut residual = vec![0.0; inequality.size()];
    inequality.residual_f64(u, &mut residual);
    let state = |(i, bound): (usize, &Bound<T>)| {
        if !bound.is_inequality() {
            return Contact::Inactive;
        }
        let (x, step) = (u[i].to_f64(), -residual[i] / positive_diagonal(inequality, i));
        let to_lower = bound.lower().map_or(f64::INFINITY, |l| x - l.to_f64());
        let to_upper = bound.upper().map_or(f64::INFINITY, |u| u.to_f64() - x);
        if to_lower <= to_upper && to_lower <= step {
            Contact::Lower
        } else if to_upper < to_lower && to_upper <= -step {
            Contact::Upper
        } else {
            Contact::Inactive
        }
    };
    inequality.bounds.iter().enumerate().map(state).collect()
}

/// The number of active unknowns; fixed ones do not count.
#[must_use]
pub fn count_active<T: Real>(inequality: &Inequality<T>, contact: &[Contact]) -> usize {
    inequality
        .bounds
        .iter()
        .zip(contact)
        .filter(|(bound, state)| bound.is_inequality() && **state != Contact::Inactive)
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::SparseMatrix;

    /// Forces and values in a unit that is smaller or larger by a power of two.
    #[test]
    fn certificate_and_rounding_do_not_depend_on_the_unit_of_data() {
        let of_unit = |unit: f64| {
            let matrix = SparseMatrix {
                row_starts: vec![0, 2, 4],
                columns: vec![0, 1, 0, 1],
                values: vec![3.0, -1.0, -1.0, 2.0],
            };
            let bounds = vec![Bound::Lower(-0.5 * unit), Bound::Upper(0.3 * unit)];
            let problem = Inequality::new(matrix, true, vec![-2.0 * unit, unit], bounds);
            certify_with_rounding(&problem, &[-0.4 * unit, 0.31 * unit], &[])
        };
        let (certificate, rounding) = of_unit(1.0);
        assert!(certificate.feasibility > 0.0 && certificate.complementarity > 0.0);
        assert!(rounding > 0.0);
        for exponent in [-300, -30, 30, 300] {
            assert_eq!(of_unit(2.0_f64.powi(exponent)), (certificate, rounding), "{exponent}");
        }
    }
}
