//! The certificate of values: the violations of the complementarity conditions at each unknown, and their sums.

use super::scales::Scales;
use super::{Certificate, nearer_bound, positive_diagonal, residual};
use crate::algebra::{Bound, Contact, Inequality, PenalisedMatrix, any_part};
use crate::inequality::Solution;
use crate::inequality::contact_forces::BalancedNodes;
use crate::inequality::validation::data_are_in_range;
use crate::instances::compiled;
use crate::parallel::vectors::{collect, largest, map_chunks};
use crate::real::{Precision, Real, maximum};

/// The certificate of `u` as a solution of the inequality.
#[must_use]
pub fn certify<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Certificate {
    compiled!(T: fn(&Inequality<T>, &[T]) -> Certificate = |inequality, u| {
        in_range(inequality, Violations::of(inequality, (u, &[]), T::PRECISION)).certificate
    })(inequality, u)
}

/// The certificate of a solution, with its jump multipliers, in its precision; and the energy norm `E` to which it is
/// relative.
pub(crate) fn certify_solution(
    inequality: &Inequality<f64>,
    solution: &Solution<f64>,
) -> (Certificate, f64) {
    let Solution { values, jump_multipliers, precision, .. } = solution;
    let found = Violations::of(inequality, (values, jump_multipliers), *precision);
    let Violations { certificate, energy_norm, .. } = in_range(inequality, found);
    (certificate.with_algebraic_bound(solution.algebraic_bound), energy_norm)
}

/// The certificate, and the dual norm of the vector with the entries `d_i U`, divided by `E`. The second number times
/// machine epsilon is the size of rounding errors in `A u`, below which no solver can reduce the residual.
pub(crate) fn certify_with_rounding<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> (Certificate, f64) {
    let Violations { certificate, rounding, .. } =
        Violations::of(inequality, (u, jump_multipliers), T::PRECISION);
    (certificate, rounding)
}

/// Data whose squares underflow or overflow have no certificate.
fn in_range<T: Real>(inequality: &Inequality<T>, found: Violations) -> Violations {
    match data_are_in_range(inequality, inequality.is_well_formed()) {
        true => found,
        false => Violations { certificate: Certificate::INVALID, ..found },
    }
}

/// The violations of the complementarity conditions at the unknowns of all parts of a mesh.
struct Violations {
    certificate: Certificate,
    /// `E`.
    energy_norm: f64,
    /// The size of rounding errors relative to machine epsilon: see [`certify_with_rounding`].
    rounding: f64,
}

/// The position of the sum of diagonal entries among the sums over unknowns.
const DIAGONAL: usize = 3;

impl Violations {
    const INVALID: Self =
        Self { certificate: Certificate::INVALID, energy_norm: 1.0, rounding: 0.0 };

    /// The violations of values `u` and jump multipliers that were computed in a precision; all parts call it.
    ///
    /// With the jump multipliers `p` of a [`PenalisedMatrix`] the residual is `c - K u - M^T p`, without the rounding
    /// of differences of values, and the largest `|g - M u + p / s|`, `s` the weight of a jump, is divided by `U`.
    /// Without jump multipliers, or if their number is not that of the jumps, `p = S (M u - g)`.
    fn of<T: Real>(
        inequality: &Inequality<T>,
        (u, jump_multipliers): (&[T], &[T]),
        precision: Precision,
    ) -> Self {
        let (n, distribution) = (inequality.size(), inequality.distribution());
        let is_malformed = !inequality.is_well_formed() || u.len() != n;
        if any_part(distribution, is_malformed) {
            return Self::INVALID;
        }
        let bounds = &inequality.bounds;
        let mut r = vec![0.0; n];
        residual(inequality, u, jump_multipliers, &mut r);
        let diagonal = collect(n, |i| positive_diagonal(inequality, i));
        let values = (u, &r[..], jump_multipliers);
        let scales = Scales::of(inequality, values, &|i| diagonal[i], precision);
        let steps = |i: usize| -r[i] / diagonal[i];
        let jumps = jumps_of_slopes(inequality);
        let shares = shares_of_nodes(inequality, u, &steps);
        let chunks = map_chunks(n, |range| {
            let (mut feasibility, mut sums) = (0.0_f64, [0.0; 4]);
            for i in range.filter(|&i| inequality.owns(i)) {
                let d = diagonal[i];
                sums[DIAGONAL] += d;
                let (x, step) = (u[i].to_f64(), -r[i] / d);
                let mut local = LocalViolation::new(&bounds[i], x, step);
                if let Some((shares, penalised)) = &shares {
                    let stiffness = penalised.stiffness_diagonal(i);
                    local.add_share(&bounds[i], (x, step), shares[i], (stiffness, d));
                }
                if let Some(&(state, jump)) = jumps.get(i) {
                    local.add_excess(&bounds[i], (x, step), (state, jump / d));
                }
                feasibility = maximum(feasibility, local.feasibility);
                let changes = [local.multiplier, local.complementarity, local.residual];
                for (sum, change) in sums.iter_mut().zip(changes) {
                    *sum += d * change.powi(2);
                }
            }
            (feasibility, sums)
        });
        let (mut feasibility, mut sums) = (0.0, [0.0; 4]);
        for (of_chunk, sums_of_chunk) in chunks {
            feasibility = maximum(feasibility, of_chunk);
            sums.iter_mut().zip(sums_of_chunk).for_each(|(sum, of_chunk)| *sum += of_chunk);
        }
        let mut maxima = [feasibility, largest_jump_residual(inequality, u, jump_multipliers)];
        distribution.largest(&mut maxima);
        distribution.sum(&mut sums);
        Self::new(scales, maxima, sums)
    }

    /// The violations from their maxima and sums.
    fn new(
        Scales { max_norm, energy_norm }: Scales,
        [feasibility, jump_residual]: [f64; 2],
        [multiplier, complementarity, residual, diagonal_sum]: [f64; 4],
    ) -> Self {
        // a bound that is not a number gives no other violation than of itself
        let numbers = [max_norm, energy_norm, feasibility, multiplier, residual, jump_residual];
        if !numbers.iter().all(|x| x.is_finite()) {
            return Self { energy_norm, ..Self::INVALID };
        }
        let norm = |sum: f64| sum.sqrt() / energy_norm;
        let certificate = Certificate::new([
            feasibility / max_norm,
            norm(multiplier),
            norm(complementarity),
            norm(residual).max(jump_residual / max_norm),
        ]);
        Self { certificate, energy_norm, rounding: max_norm * norm(diagonal_sum) }
    }
}

/// The largest jump residual `|g - M u + p / s|` of the jumps whose first unknown is owned; zero without jump
/// multipliers.
fn largest_jump_residual<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> f64 {
    let Some(penalised) = &inequality.penalised else { return 0.0 };
    if jump_multipliers.len() != penalised.n_jumps() {
        return 0.0;
    }
    let of_jump = |jump: usize| {
        let multiplier = jump_multipliers[jump].to_f64();
        penalised.jump_residual(jump, |i| u[i].to_f64(), multiplier).abs()
    };
    let is_owned = |jump: usize| penalised.first_unknown(jump).is_some_and(|i| inequality.owns(i));
    largest(jump_multipliers.len(), |jump| if is_owned(jump) { of_jump(jump) } else { 0.0 })
}

/// By unknown that touches a bound its share in the balance of its node ([`BalancedNodes`]), zero for the others; with the
/// matrix that has the nodes. Each `step` is as [`LocalViolation::new`] takes it.
fn shares_of_nodes<'a, T: Real>(
    inequality: &'a Inequality<T>,
    u: &[T],
    step: &(impl Fn(usize) -> f64 + Sync),
) -> Option<(Vec<f64>, &'a PenalisedMatrix<T>)> {
    let nodes = BalancedNodes::of(inequality)?;
    let bounds = &inequality.bounds;
    let touched = collect(u.len(), |i| touched_bound(&bounds[i], u[i].to_f64(), step(i)));
    let mut shares = vec![0.0; u.len()];
    nodes.share(u, &|i| touched[i], &mut shares, None);
    inequality.penalised.as_ref().map(|penalised| (shares, penalised))
}

/// By unknown the largest multiplier in a contact state: the jump of the slope where a kink holds it, infinite elsewhere;
/// empty without kinks.
fn jumps_of_slopes<T: Real>(inequality: &Inequality<T>) -> Vec<(Contact, f64)> {
    let n = if inequality.kinks.is_empty() { 0 } else { inequality.size() };
    let mut jumps = vec![(Contact::Inactive, f64::INFINITY); n];
    for kink in &inequality.kinks {
        if let Some(state) = kink.state() {
            jumps[kink.unknown as usize] = (state, 2.0 * kink.slope.to_f64());
        }
    }
    jumps
}

/// The bound that the value `x` touches: the nearer bound, if the gap to it is at most `step`. A fixed unknown touches
/// none.
fn touched_bound<T: Real>(bound: &Bound<T>, x: f64, step: f64) -> Contact {
    let (side, gap, _) = nearer_bound(bound, x, step);
    match bound.fixed_value() {
        None if gap <= step.abs() => side,
        _ => Contact::Inactive,
    }
}

/// The violations at one unknown, each as a change of its value; see [`Certificate`].
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
        let [to_lower, to_upper] = bound.distances(x);
        let (_, gap, step_to_bound) = nearer_bound(bound, x, step);
        let to_opposite = maximum(to_lower, to_upper);
        let feasibility = maximum(maximum(-to_lower, -to_upper), 0.0);
        let mut local = Self { feasibility, ..Self::default() };
        if gap > step.abs() {
            local.residual = step;
        } else if step_to_bound < 0.0 {
            local.multiplier = (-step_to_bound).min(to_opposite.max(0.0));
        }
        local.complementarity = gap.min(step_to_bound).max(0.0);
        local
    }

    /// Counts as a multiplier by how much the step of an unknown in a contact state exceeds the largest one there.
    fn add_excess<T: Real>(
        &mut self,
        bound: &Bound<T>,
        (x, step): (f64, f64),
        (state, most): (Contact, f64),
    ) {
        let excess = step.abs() - most;
        if excess > 0.0 && touched_bound(bound, x, step) == state {
            self.multiplier = maximum(self.multiplier, excess);
        }
    }

    /// Counts the share of an unknown in the force of its node, if its sign is wrong, as a multiplier. Its step is
    /// relative to the diagonal of the stiffness `K`; the change is that with the same energy in the diagonal `d` of
    /// `A`.
    fn add_share<T: Real>(
        &mut self,
        bound: &Bound<T>,
        (x, step): (f64, f64),
        share: f64,
        (stiffness, d): (f64, f64),
    ) {
        let (wrong, opposite) = match touched_bound(bound, x, step) {
            Contact::Lower => (-share, bound.upper()),
            Contact::Upper => (share, bound.lower()),
            Contact::Inactive => return,
        };
        if wrong > 0.0 && stiffness > 0.0 {
            let to_opposite = opposite.map_or(f64::INFINITY, |o| (x - o.to_f64()).abs());
            let change = (wrong / stiffness).min(to_opposite);
            self.multiplier = maximum(self.multiplier, change * (stiffness / d).sqrt());
        }
    }
}
