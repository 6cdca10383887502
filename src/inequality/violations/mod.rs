//! The sums and maxima from which a certificate is computed, over the unknowns of one part of a mesh or of all parts.

mod local_violation;

use super::Solution;
use super::certificate::{Certificate, positive_diagonal, residual};
use super::contact_forces::BalancedNodes;
use super::scales::{Scales, Sums};
use super::validation::data_are_in_range;
use crate::algebra::{Contact, Distribution, Inequality, PenalisedMatrix};
use crate::arrays::array_of;
use crate::instances::compiled;
use crate::parallel::vectors::{collect, largest, map_chunks};
use crate::real::{Precision, Real, maximum};
use local_violation::{LocalViolation, touched_bound};

/// The certificate of `u` as a solution of the inequality.
#[must_use]
pub fn certify<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Certificate {
    compiled!(
        T: fn(&Inequality<T>, (&[T], &[T]), Precision) -> (Certificate, f64)
            = certificate_with_norm
    )(inequality, (u, &[]), T::PRECISION)
    .0
}

/// The certificate of a solution, with its jump multipliers ([`Violations::of`]), in its precision; and the energy norm
/// `E` to which it is relative.
pub(crate) fn certify_solution(
    inequality: &Inequality<f64>,
    solution: &Solution<f64>,
) -> (Certificate, f64) {
    let Solution { values, jump_multipliers, precision, .. } = solution;
    let (certificate, energy_norm) =
        certificate_with_norm(inequality, (values, jump_multipliers), *precision);
    (certificate.with_algebraic_bound(solution.algebraic_bound), energy_norm)
}

fn certificate_with_norm<T: Real>(
    inequality: &Inequality<T>,
    values: (&[T], &[T]),
    precision: Precision,
) -> (Certificate, f64) {
    let is_in_range = data_are_in_range(inequality, inequality.is_well_formed());
    let violations = Violations::of_all(inequality, values, precision);
    let certificate = if is_in_range { violations.certificate() } else { Certificate::INVALID };
    let [_, _, epsilon] = violations.maxima;
    (certificate, violations.scales.scales(epsilon).energy_norm)
}

/// The certificate, and the dual norm of the vector with the entries `d_i U`, divided by `E`. The second number times
/// machine epsilon is the size of rounding errors in `A u`, below which no solver can reduce the residual.
pub(crate) fn certify_with_rounding<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
) -> (Certificate, f64) {
    Violations::of_all(inequality, (u, jump_multipliers), T::PRECISION).certificate_with_rounding()
}

/// The position of the sum of diagonal entries among [`Violations::sums`].
const DIAGONAL: usize = 3;

/// The violations of the complementarity conditions at the unknowns that a part of a mesh owns: sums and maxima. Those
/// of all parts are [merged](Violations::merge) into the violations at all unknowns, from which the [`Certificate`] is
/// computed.
///
/// ```
/// use unilateral::inequality::{Violations, certify};
/// use unilateral::prelude::*;
///
/// let problem = Problem::new().source(|_| -8.0).obstacle_below(|x| -0.3 - x[0] * x[0]);
/// let line = BoxDomain::dirichlet(Point::from([-1.0]), Point::from([1.0]));
/// let mesh = Mesh::<1>::kuhn_box(&line, [8])?;
/// let solved = solve(&problem, &mesh, &ConformingP1)?;
/// let (inequality, u) = (solved.inequality(), &solved.solution().values);
/// let [left, right] =
///     [0..5, 5..9].map(|own| Violations::of(inequality, u, &[], &|i| own.contains(&i)));
/// let (merged, serial) = (left.merge(right).certificate(), certify(inequality, u));
/// assert!((merged.largest() - serial.largest()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Violations {
    /// The sums for the scales of the certificate.
    scales: Sums,
    /// The largest violation of a bound; the largest jump residual `|g - M u + p / s|`, infinite if sizes do not match;
    /// machine epsilon.
    maxima: [f64; 3],
    /// `sum d_i v_i^2` for the violations `v_i` called `multiplier`, `complementarity` and `residual`, in this order, and
    /// the sum of the diagonal entries `d_i`.
    sums: [f64; 4],
}

impl Violations {
    /// The violations at the unknowns for which `owns` is true, of the values `u` of all unknowns of a part and
    /// of as many jump multipliers as its penalised matrix has jumps, or none. A jump belongs to the part that
    /// owns its first unknown.
    ///
    /// With the jump multipliers `p` of a [`PenalisedMatrix`](crate::algebra::PenalisedMatrix) the residual is
    /// `c - K u - M^T p`, without the rounding of differences of values, and the largest `|g - M u + p / s|`, `s`
    /// the weight of a jump, is divided by `U`. Without jump multipliers, or if their number is not that of the
    /// jumps, `p = S (M u - g)`. The forces of nodes, which [`certify`] counts besides, need all copies of a node and
    /// are no part of these violations.
    #[must_use]
    pub fn of<T: Real>(
        inequality: &Inequality<T>,
        u: &[T],
        jump_multipliers: &[T],
        owns: &(dyn Fn(usize) -> bool + Sync),
    ) -> Self {
        compiled!(
            T: fn(&Inequality<T>, &[T], &[T], &(dyn Fn(usize) -> bool + Sync)) -> Violations
                = |inequality, u, multipliers, owns| {
                    Violations::at(inequality, (u, multipliers), &|i| owns(i), (T::PRECISION, false))
                }
        )(inequality, u, jump_multipliers, owns)
    }

    /// The violations at all unknowns, of all parts, of values and jump multipliers that were computed in a precision.
    fn of_all<T: Real>(
        inequality: &Inequality<T>,
        values: (&[T], &[T]),
        precision: Precision,
    ) -> Self {
        let has_all_copies = !inequality.is_in_parts();
        let owns = |i: usize| inequality.owns(i);
        let own = Self::at(inequality, values, &owns, (precision, has_all_copies));
        own.over_parts(inequality.distribution())
    }

    /// [`Violations::of`] without the dispatch to a compiled instance; with the forces of nodes, whose sums over copies
    /// parts of a mesh do not have, if `has_all_copies`.
    pub(super) fn at<T: Real>(
        inequality: &Inequality<T>,
        (u, jump_multipliers): (&[T], &[T]),
        owns: &(impl Fn(usize) -> bool + Sync),
        (precision, has_all_copies): (Precision, bool),
    ) -> Self {
        let n = inequality.size();
        let epsilon = precision.epsilon();
        if !inequality.is_well_formed() || u.len() != n {
            let (scales, maxima) = (Sums::default(), [0.0, f64::INFINITY, epsilon]);
            return Self { scales, maxima, sums: [0.0; 4] };
        }
        let bounds = &inequality.bounds;
        let mut r = vec![0.0; n];
        residual(inequality, u, jump_multipliers, &mut r);
        let diagonal = collect(n, |i| positive_diagonal(inequality, i));
        let values = (u, &r[..], jump_multipliers);
        let scales = Sums::of(inequality, values, &|i| diagonal[i], owns);
        let jump_residual = largest_jump_residual(inequality, u, jump_multipliers, owns);
        let steps = |i: usize| -r[i] / diagonal[i];
        let jumps = jumps_of_slopes(inequality);
        let shares = has_all_copies.then(|| shares_of_nodes(inequality, u, &steps)).flatten();
        let chunks = map_chunks(n, |range| {
            let (mut feasibility, mut sums) = (0.0_f64, [0.0; 4]);
            for i in range.filter(|&i| owns(i)) {
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
        Self { scales, maxima: [feasibility, jump_residual, epsilon], sums }
    }

    /// The violations at the unknowns of `self` and `other`, which must have no unknown in common.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self {
            scales: self.scales.merge(other.scales),
            maxima: array_of(|k| maximum(self.maxima[k], other.maxima[k])),
            sums: array_of(|k| self.sums[k] + other.sums[k]),
        }
    }

    /// The violations at the unknowns of all parts; all parts call it and have the same result.
    #[must_use]
    pub fn over_parts(mut self, distribution: &dyn Distribution) -> Self {
        distribution.largest(&mut self.maxima);
        distribution.sum(&mut self.sums);
        Self { scales: self.scales.over_parts(distribution), ..self }
    }

    /// All sums and maxima as numbers, to be sent to another part.
    pub fn to_numbers(&self) -> Vec<f64> {
        let Self { scales, maxima, sums } = self;
        [&maxima[..], sums, &[scales.max_norm], &scales.sums].concat()
    }
    /// The violations from the numbers of [`Violations::to_numbers`]; `None` if their number is wrong.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&maxima, numbers) = numbers.split_first_chunk()?;
        let (&sums, numbers) = numbers.split_first_chunk()?;
        let (&max_norm, of_scales) = numbers.split_first()?;
        let scales = Sums { max_norm, sums: of_scales.try_into().ok()? };
        Some(Self { scales, maxima, sums })
    }

    /// The certificate of the unknowns whose violations these are.
    #[must_use]
    pub fn certificate(&self) -> Certificate {
        self.certificate_with_rounding().0
    }

    /// The certificate, and the size of rounding errors relative to machine epsilon: see
    /// `certify_with_rounding`.
    pub(super) fn certificate_with_rounding(&self) -> (Certificate, f64) {
        let [feasibility, jump_residual, epsilon] = self.maxima;
        let [multiplier, complementarity, residual, diagonal_sum] = self.sums;
        let Scales { max_norm, energy_norm } = self.scales.scales(epsilon);
        // a bound that is not a number gives no other violation than of itself
        let numbers = [max_norm, energy_norm, feasibility, multiplier, residual, jump_residual];
        if !numbers.iter().all(|x| x.is_finite()) {
            return (Certificate::INVALID, 0.0);
        }
        let norm = |sum: f64| sum.sqrt() / energy_norm;
        let certificate = Certificate::new([
            feasibility / max_norm,
            norm(multiplier),
            norm(complementarity),
            norm(residual).max(jump_residual / max_norm),
        ]);
        (certificate, max_norm * norm(diagonal_sum))
    }
}

/// The largest jump residual `|g - M u + p / s|` of the jumps whose first unknown is owned; zero without jump
/// multipliers.
fn largest_jump_residual<T: Real>(
    inequality: &Inequality<T>,
    u: &[T],
    jump_multipliers: &[T],
    owns: &(impl Fn(usize) -> bool + Sync),
) -> f64 {
    let Some(penalised) = &inequality.penalised else { return 0.0 };
    if jump_multipliers.len() != penalised.n_jumps() {
        return 0.0;
    }
    let of_jump = |jump: usize| {
        let multiplier = jump_multipliers[jump].to_f64();
        penalised.jump_residual(jump, |i| u[i].to_f64(), multiplier).abs()
    };
    let is_owned = |jump: usize| penalised.first_unknown(jump).is_some_and(owns);
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
