//! The scales to which violations of the complementarity conditions are relative: a largest value and an energy norm,
//! for the certificate and for every stopping test.

use std::cmp::Ordering;

use crate::algebra::Inequality;
use crate::arrays::array_of;
use crate::parallel::vectors::map_chunks;
use crate::real::{Precision, Real, maximum};

/// The multiple of machine epsilon times the sum of the absolute values of its terms below which an energy counts as
/// zero.
const VANISHING: f64 = 8.0;

/// The scales of values `u` of an inequality.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// The largest of all `|u_i|` and `|v_i|`, `v_i` the admissible value nearest to `u_i`; one if all
    /// are zero.
    pub max_norm: f64,
    /// The energy norm `E`: the square root of the first of these numbers that is not zero.
    ///
    /// 1. The energy with data: `u.A u`; with weak Dirichlet data `u.A u - l.u + q`
    ///    ([`DirichletEnergy`](crate::algebra::DirichletEnergy)), for a penalised matrix `u.K u + p.(S^-1 p)`. The
    ///    energy with data does not contain the penalty times the square of the data, which for an over-penalised
    ///    scheme exceeds the energy by any factor on fine meshes. An energy below rounding of its terms, and of the
    ///    products `u_i a_ij u_j` that cancel in them, counts as zero.
    /// 2. `sum c_i^2 / d_i`, `c` the load without Dirichlet data.
    /// 3. `sum d_i u_i^2`, for constants.
    /// 4. One.
    pub energy_norm: f64,
}

/// Positions among [`Sums::sums`].
const LOAD_ENERGY: usize = 2;
const DIAGONAL_ENERGY: usize = 3;
const STIFFNESS_ENERGY: usize = 4;

/// The maximum and the sums over unknowns from which [`Scales`] are computed.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// The largest `|u_i|` or `|v_i|`.
    max_norm: f64,
    /// The energy with data ([`Scales::energy_norm`]), the sum of the absolute values of its terms, `sum c_i^2 / d_i`,
    /// `sum d_i u_i^2`, and `sum k_i u_i^2` with the diagonal `k` of the matrix without a penalty that is kept apart.
    sums: [f64; 5],
}

impl Scales {
    /// The scales of `u`, given as `values` with the residual and the jump multipliers: `b - A u`, or `c - K u - M^T p`
    /// with jump multipliers `p` if they are not empty. `diagonal` is the positive diagonal, `precision` that in which
    /// the values were computed. A jump belongs to the part of a mesh that owns its first unknown. Numbers that are not
    /// finite give norms that are not finite.
    pub fn of<T: Real>(
        inequality: &Inequality<T>,
        values: (&[T], &[f64], &[T]),
        diagonal: &(dyn Fn(usize) -> f64 + Sync),
        precision: Precision,
    ) -> Self {
        let Sums { mut max_norm, mut sums } = Sums::of(inequality, values, diagonal);
        let distribution = inequality.distribution();
        distribution.largest(std::slice::from_mut(&mut max_norm));
        distribution.sum(&mut sums);
        let [energy, terms, load_energy, diagonal_energy, stiffness_energy] = sums;
        let epsilon = precision.epsilon();
        // products are summed in double precision, of values that are rounded to theirs
        let products = (f64::EPSILON + epsilon * epsilon) * stiffness_energy;
        let least = VANISHING * maximum(epsilon * terms, products);
        let energy = [(energy, least), (load_energy, 0.0), (diagonal_energy, 0.0)]
            .into_iter()
            // true for NaN
            .find(|(energy, least)| energy.partial_cmp(least).is_none_or(Ordering::is_gt))
            .map_or(1.0, |(energy, _)| energy);
        Self { max_norm: if max_norm == 0.0 { 1.0 } else { max_norm }, energy_norm: energy.sqrt() }
    }
}

impl Sums {
    /// The sums over the unknowns of this part.
    fn of<T: Real>(
        inequality: &Inequality<T>,
        (u, residual, jump_multipliers): (&[T], &[f64], &[T]),
        diagonal: &(dyn Fn(usize) -> f64 + Sync),
    ) -> Self {
        let Inequality { load, bounds, penalised, dirichlet_energy, .. } = inequality;
        let owns = |i: usize| inequality.owns(i);
        let chunks = map_chunks(u.len(), |range| {
            let mut chunk = Sums::default();
            for i in range.filter(|&i| owns(i)) {
                let (x, c, d) = (u[i].to_f64(), load[i].to_f64(), diagonal(i));
                let nearest = bounds[i].nearest(u[i]).to_f64();
                chunk.max_norm = maximum(chunk.max_norm, maximum(x.abs(), nearest.abs()));
                chunk.add_energy(x * (c - residual[i]));
                chunk.sums[LOAD_ENERGY] += c * c / d;
                chunk.sums[DIAGONAL_ENERGY] += d * x * x;
                let k = penalised.as_ref().map_or(d, |penalised| penalised.stiffness_diagonal(i));
                chunk.sums[STIFFNESS_ENERGY] += k * x * x;
            }
            chunk
        });
        let mut sums = chunks.into_iter().fold(Sums::default(), Sums::merge);
        if let Some(penalised) = penalised {
            // u.K u + p.(S^-1 p) = u.(c - r) - p.g, without the cancellation of penalties
            let work = penalised.work_on_data(|i| u[i].to_f64(), jump_multipliers, owns);
            sums.add_energy(-work);
        } else if let Some(data) = dirichlet_energy {
            for term in data.terms.iter().filter(|term| owns(term.unknown as usize)) {
                let i = term.unknown as usize;
                let (x, c, d) = (u[i].to_f64(), load[i].to_f64(), diagonal(i));
                sums.add_energy(-term.linear * x);
                sums.sums[LOAD_ENERGY] += ((c - term.load).powi(2) - c * c) / d;
                sums.add_energy(term.constant);
            }
        }
        sums
    }
    /// The sums over the unknowns of `self` and `other`.
    fn merge(self, other: Self) -> Self {
        Self {
            max_norm: maximum(self.max_norm, other.max_norm),
            sums: array_of(|k| self.sums[k] + other.sums[k]),
        }
    }
    fn add_energy(&mut self, energy: f64) {
        self.sums[0] += energy;
        self.sums[1] += energy.abs();
    }
}
