//! The certificate: violations of the complementarity conditions, computed from the data and `u` alone.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`Certificate`]; contact states of values |
//! | `violations` | [`certify`]: the violations at each unknown, and their sums |
//! | `scales` | the energy norm and the largest value to which violations are relative |

pub(super) mod scales;
pub(super) mod violations;

use scales::Scales;
pub use violations::certify;
pub(crate) use violations::certify_solution;

use crate::algebra::{Bound, Contact, Inequality};
use crate::parallel::vectors::collect;
use crate::real::{Precision, Real, maximum};

/// Relative, dimensionless violations of the complementarity conditions of an [`Inequality`].
///
/// Notation: `r = A u - b`, the residual with the other sign; `d` the diagonal of `A`; `E` the energy norm of the solution, with its
/// Dirichlet data subtracted where they are imposed weakly
/// ([`DirichletEnergy`](crate::algebra::DirichletEnergy)); `v_i` the admissible value nearest to
/// `u_i`; `U` the largest of all `|u_i|` and `|v_i|`; the gap the distance of `u_i` from the nearer
/// bound; the step `s_i = r_i / d_i`, its sign reversed if the upper bound is nearer: a Gauss-Seidel
/// correction towards this bound. An unknown counts as active if its gap is at most `|s_i|`. No
/// contact state of a solver enters.
///
/// Reasons for these scalings. *Violations of bounds* (`feasibility`) are relative to `U`: by the comparison principle
/// a violation of a bound by `g` changes the solution by `g` at most. Bounds far from the solution (an obstacle at
/// minus a million) do not enter `U`: relative to them all violations would be small. *Residuals and multipliers* are
/// relative to `E` in the dual norm `(sum r_i^2 / d_i)^(1/2)`: `r_i^2 / (2 d_i)` is the decrease of the energy by a
/// correction of unknown `i` alone, so that each measure bounds a relative distance to the solution from below. The
/// Euclidean norm of `r` divided by the Euclidean norm of `b` is no measure for an over-penalised scheme: with entries
/// of size `eta h^-2` (`eta` the penalty, `h` the mesh size) the quotient is dominated by the penalty rows and cannot
/// fall below rounding times the largest entry. The measures are sums, not maxima, because the multiplier of one
/// unknown is of the size of the volume of its patch: on a fine mesh each wrong multiplier is tiny, while all of them
/// together may change the solution by as much as the solution itself.
///
/// If the energy vanishes up to rounding (the solution is a constant), the norm `(sum c_i^2 / d_i)^(1/2)` of the load
/// `c` without Dirichlet data replaces `E`, then `(sum d_i u_i^2)^(1/2)`, then one. All sums are in `f64`: data whose
/// squares underflow or overflow, which solvers refuse, have no certificate. If a number is not finite, or sizes do not
/// match, all four violations are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Certificate {
    /// Largest violation of a bound or Dirichlet value, divided by `U`.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub feasibility: f64,
    /// Dual norm, divided by `E`, of the multipliers of active unknowns with the wrong sign. A multiplier counts at
    /// most as much as one whose step reaches the opposite bound, where its sign would be right. With a penalised
    /// matrix `K + M^T S M` the forces of nodes count too, which follow from balances without `S`, in the dual norm of
    /// the diagonal of `K`: the diagonal of `A` contains the penalty, beside which a wrong force is small.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub multiplier: f64,
    /// `(sum d_i min(gap_i, s_i)^2)^(1/2)` divided by `E`, the sum over all `i` with positive gap
    /// and step.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub complementarity: f64,
    /// Dual norm of the residual on inactive unknowns divided by `E`; or, if larger, the largest
    /// difference between a jump and the jump that its multiplier determines, divided by `U`.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_infinity"))]
    pub residual: f64,
    /// Bound on the relative algebraic error in the energy norm, if the solver computes one; else `None`. Without
    /// factors the bound depends on an estimate of the smallest eigenvalue of the preconditioned matrix and, for a
    /// matrix that is not symmetric, on the assumption that no strongly active unknown becomes inactive.
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

    /// Whether the four violations of values that were computed in a precision are within its
    /// [`Precision::certificate_limit`], and the bound on the algebraic error, where it is known, within its
    /// [`Precision::algebraic_bound_limit`].
    #[must_use]
    pub fn is_within_limits(&self, precision: Precision) -> bool {
        self.largest() <= precision.certificate_limit()
            && self.algebraic_bound.is_none_or(|bound| bound <= precision.algebraic_bound_limit())
    }

    /// The largest of the four violations; NaN if one of them is NaN, which is within no limit.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let Self { feasibility, multiplier, complementarity, residual, .. } = *self;
        [multiplier, complementarity, residual].into_iter().fold(feasibility, maximum)
    }
}

/// Sets `residual` to `b - A u`, or to `c - K u - M^T p` if the jump multipliers `p` are given.
pub(crate) fn residual<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
    residual: &mut [f64],
) {
    match &inequality.penalised {
        Some(penalised) if jump_multipliers.len() == penalised.n_jumps() => {
            let (value, multiplier) =
                (|i: usize| u[i].to_f64(), |jump: usize| jump_multipliers[jump].to_f64());
            let load = &inequality.load;
            penalised.residual_with_jump_multipliers(load, value, multiplier, residual);
        }
        _ => inequality.residual_f64(u, residual),
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

/// The diagonal entry of row `i` as a positive scale, without a penalty that is kept apart.
pub(crate) fn stiffness_diagonal<T: Real>(inequality: &Inequality<T>, i: usize) -> f64 {
    match &inequality.penalised {
        Some(penalised) => penalised.stiffness_diagonal(i),
        None => positive_diagonal(inequality, i),
    }
}

/// A certificate with which contact forces have digits. That of values in double precision is smaller, in single
/// precision its limit is a hundred times as large.
const WITH_FORCES: f64 = 1e-6;

/// Whether a method whose certificates fall from step to step ends: the smallest one is within its limit, and forces have
/// digits, or the last step has not halved the certificate `before`.
pub(in crate::inequality) fn is_final<T: Real>(smallest: f64, before: f64, last: f64) -> bool {
    smallest <= T::CERTIFICATE_LIMIT && (smallest <= WITH_FORCES || last > 0.5 * before)
}

/// The contact states of values: see [`Solution::of_values`](super::Solution::of_values).
///
/// # Panics
/// If the inequality is not [well formed](Inequality::is_well_formed), or has another number of unknowns.
#[must_use]
pub fn contact_of<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Vec<Contact> {
    let (n, values) = (inequality.size(), u.len());
    assert!(inequality.is_well_formed(), "the inequality of {n} unknowns is not well formed");
    assert!(values == n, "{values} values for {n} unknowns: contact states need one for each");
    contact_states(inequality, u, &[])
}

/// [`contact_of`] for values with jump multipliers, if they are not empty.
pub(in crate::inequality) fn contact_states<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> Vec<Contact> {
    let mut r = vec![0.0; u.len()];
    residual(inequality, u, jump_multipliers, &mut r);
    let diagonal = collect(u.len(), |i| positive_diagonal(inequality, i));
    let values = (u, &r[..], jump_multipliers);
    let scales = Scales::of(inequality, values, &|i| diagonal[i], T::PRECISION);
    let allowed = T::CERTIFICATE_LIMIT * scales.energy_norm;
    collect(u.len(), |i| {
        let bound = &inequality.bounds[i];
        if bound.fixed_value().is_some() {
            return if bound.is_inequality() { Contact::Lower } else { Contact::Inactive };
        }
        let (side, gap, step) = nearer_bound(bound, u[i].to_f64(), -r[i] / diagonal[i]);
        let is_on_bound = gap <= 0.0 && -step * diagonal[i].sqrt() <= allowed;
        if gap <= step || is_on_bound { side } else { Contact::Inactive }
    })
}

/// The bound that is nearer to the value `x`, the distance from it, negative beyond it, and the step towards it.
/// `step = r_i / d_i` is positive where a Gauss-Seidel correction would decrease the value.
pub(in crate::inequality) fn nearer_bound<T: Real>(
    bound: &Bound<T>,
    x: f64,
    step: f64,
) -> (Contact, f64, f64) {
    let [to_lower, to_upper] = bound.distances(x);
    match to_lower <= to_upper {
        true => (Contact::Lower, to_lower, step),
        false => (Contact::Upper, to_upper, -step),
    }
}

/// The number of active unknowns; unknowns with a Dirichlet value do not count, nor do those that other parts own.
#[must_use]
pub fn count_active<T: Real>(inequality: &Inequality<T>, contact: &[Contact]) -> usize {
    let states = inequality.bounds.iter().zip(contact).enumerate();
    let is_active = |(i, (bound, state)): &(usize, (&Bound<T>, &Contact))| {
        bound.is_inequality() && **state != Contact::Inactive && inequality.owns(*i)
    };
    states.filter(is_active).count()
}
