//! The matrix `K + M^T S M` of an over-penalised scheme, kept as that sum.

use std::ops::Range;

use super::jumps::{JumpTerm, Jumps};
use super::mean_jumps::MeanJumps;
use crate::parallel::vectors::{
    all, collect, for_each_chunk, for_each_chunk_of_groups, largest, map_chunks,
};
use crate::real::Real;

/// The matrix `A = K + M^T S M`, stored by `K`, `M` and `S`, and the Dirichlet data `g` that it imposes: the load of
/// `A` is `b = c + M^T S g` for the load `c` of the other data, which is that of the
/// [`Inequality`](super::Inequality::load).
///
/// `K` is block diagonal with dense blocks (the stiffness of cells), `M u` are the jumps of means
/// over facets, `S` is the positive diagonal of penalty weights, `g` the Dirichlet data.
///
/// In the assembled matrix every entry has a rounding error of size `eps eta h^-2`, which perturbs
/// the stiffness on all functions. The residual `c - K u - M^T S (M u - g)` of the sum has rounding
/// errors of that size in the range of `M^T` only, where they change jumps by `eps |u|`.
///
/// The *jump multipliers* are `p = S (M u - g)`. A solver that keeps them as unknowns beside `u` knows
/// them to full relative precision; computed from `u` they suffer from cancellation in `M u`.
#[derive(Clone, Debug, PartialEq)]
pub struct PenalisedMatrix<T> {
    /// `K`: its blocks one after the other, each by rows; positive semidefinite but for a negative reaction.
    pub blocks: Vec<T>,
    /// `M`.
    pub jumps: Jumps<T>,
    /// The diagonal of `S`.
    pub weights: Vec<T>,
    /// `g`.
    pub jump_data: Vec<T>,
    /// The sides of facets to which the jumps belong, where they are those of means of discontinuous linear functions
    /// in two or three dimensions. Products and preconditioners for these functions need them.
    pub mean_jumps: Option<MeanJumps>,
}

impl<T: Real> PenalisedMatrix<T> {
    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.blocks.len() / self.block_size()
    }

    /// Number of unknowns of a block of `K`.
    #[inline(always)]
    pub fn block_size(&self) -> usize {
        self.jumps.block_size()
    }

    /// Number of jumps: rows of `M`.
    pub fn n_jumps(&self) -> usize {
        self.weights.len()
    }

    /// Row `jump` of `M`.
    #[inline]
    pub fn terms_of(&self, jump: usize) -> &[JumpTerm<T>] {
        self.jumps.terms_of(jump)
    }

    /// Whether each jump is that of one unknown, or the difference of two: in a basis of facet means.
    pub(crate) fn has_jumps_of_single_unknowns(&self) -> bool {
        all(self.n_jumps(), |jump| self.terms_of(jump).len() <= 1)
    }

    /// Whether all vectors and matrices have consistent sizes for `size` unknowns, and weights are positive.
    pub fn is_well_formed(&self, size: usize) -> bool {
        let n = self.n_jumps();
        size.is_multiple_of(self.block_size())
            && self.blocks.len() == size * self.block_size()
            && self.jump_data.len() == n
            && self.jumps.len() == n
            && self.jumps.n_blocks() == size / self.block_size()
            && all(n, |k| self.weights[k] > T::lit(0.0))
            && self.mean_jumps.as_ref().is_none_or(|means| means.is_well_formed(&self.jumps))
    }

    /// The first unknown that a jump contains.
    pub(crate) fn first_unknown(&self, jump: usize) -> Option<usize> {
        let unknowns = self.terms_of(jump).iter().flat_map(|term| [term.here, term.there]);
        unknowns.map(|i| i as usize).find(|&i| i != JumpTerm::<T>::NO_UNKNOWN as usize)
    }

    /// The entry `(M u)_jump`, in `f64`.
    #[inline]
    pub fn jump(&self, jump: usize, u: impl Fn(usize) -> f64) -> f64 {
        let value = |i: u32| if i == JumpTerm::<T>::NO_UNKNOWN { 0.0 } else { u(i as usize) };
        self.terms_of(jump)
            .iter()
            .fold(0.0, |s, t| s + t.weight.to_f64() * (value(t.here) - value(t.there)))
    }

    /// The entry `(K u)_i`, in `f64`.
    #[inline]
    pub fn stiffness(&self, i: usize, u: impl Fn(usize) -> f64) -> f64 {
        let n = self.block_size();
        let first = i / n * n;
        let row = &self.blocks[i * n..(i + 1) * n];
        row.iter().enumerate().fold(0.0, |s, (j, a)| s + a.to_f64() * u(first + j))
    }

    /// The diagonal entry `K_ii`.
    pub fn stiffness_diagonal(&self, i: usize) -> f64 {
        self.blocks[i * self.block_size() + i % self.block_size()].to_f64()
    }

    /// The largest ratio of a penalty to the stiffness at the first unknown of a jump: `S` times the squares of the
    /// weights of the row of `M`, over `K_ii`.
    pub(crate) fn largest_ratio(&self) -> f64 {
        let of_jump = |k: usize| {
            let squares: f64 = self.terms_of(k).iter().map(|t| t.weight.to_f64().powi(2)).sum();
            let first = self.first_unknown(k);
            let stiffness = first.map_or(f64::INFINITY, |i| self.stiffness_diagonal(i));
            self.weights[k].to_f64() * squares / stiffness
        };
        largest(self.n_jumps(), of_jump)
    }

    /// The jump multipliers `S (M u - g)`.
    pub fn jump_multipliers(&self, u: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let multiplier =
            |k: usize| self.weights[k].to_f64() * (self.jump(k, &u) - self.jump_data[k].to_f64());
        let mut multipliers = vec![0.0; self.n_jumps()];
        for_each_chunk(&mut multipliers, |range, multipliers| {
            multipliers.iter_mut().zip(range).for_each(|(m, jump)| *m = multiplier(jump));
        });
        multipliers
    }

    /// The residual `r = c - K u - M^T p` with a load `c` and jump multipliers `p`.
    pub fn residual_with_jump_multipliers(
        &self,
        load: &[T],
        u: impl Fn(usize) -> f64 + Sync,
        jump_multipliers: impl Fn(usize) -> f64 + Sync,
        r: &mut [f64],
    ) {
        let n = self.block_size();
        for_each_chunk_of_groups(r, n, |range, r| {
            for (block, r) in (range.start / n..).zip(r.chunks_exact_mut(n)) {
                let first = block * n;
                for (i, r) in (first..).zip(&mut *r) {
                    *r = load[i].to_f64() - self.stiffness(i, &u);
                }
                for side in self.jumps.sides_of(block) {
                    let multiplier = side.sign() * jump_multipliers(side.jump());
                    for t in self.terms_of(side.jump()) {
                        // no unknown is beyond the end
                        if let Some(r) = r.get_mut((side.unknown(t) as usize).wrapping_sub(first)) {
                            *r -= t.weight.to_f64() * multiplier;
                        }
                    }
                }
            }
        });
    }

    /// The residual `r = b - A u` with a load `c`.
    pub fn residual(&self, load: &[T], u: impl Fn(usize) -> f64 + Sync, r: &mut [f64]) {
        let multipliers = self.jump_multipliers(&u);
        self.residual_with_jump_multipliers(load, u, |k| multipliers[k], r);
    }

    /// The energy `u.A u / 2 - b.u` with a load `c`, which is `u.K u / 2 - c.u + (M u - g).S (M u - g) / 2 - g.S g /
    /// 2`.
    ///
    /// Of one part of a mesh it has the terms of unknowns for which `counts` is true, and of jumps whose first
    /// unknown is one of them.
    pub fn objective(
        &self,
        load: &[T],
        u: impl Fn(usize) -> f64 + Sync,
        counts: impl Fn(usize) -> bool + Sync,
    ) -> f64 {
        let of_unknown = |i: usize| u(i) * (0.5 * self.stiffness(i, &u) - load[i].to_f64());
        let of_jump = |k: usize| {
            let g = self.jump_data[k].to_f64();
            let jump = self.jump(k, &u) - g;
            0.5 * self.weights[k].to_f64() * (jump * jump - g * g)
        };
        let is_counted = |k: usize| self.first_unknown(k).is_some_and(&counts);
        let of_unknowns = collect(load.len(), |i| if counts(i) { of_unknown(i) } else { 0.0 });
        let of_jumps = collect(self.n_jumps(), |k| if is_counted(k) { of_jump(k) } else { 0.0 });
        of_unknowns.iter().sum::<f64>() + of_jumps.iter().sum::<f64>()
    }

    /// The scale of energies `u.K u + p.(S^-1 p) + Σ |c_i u_i|` with a load `c` and jump multipliers `p`.
    pub fn energy(
        &self,
        load: &[T],
        u: impl Fn(usize) -> f64 + Sync,
        jump_multipliers: impl Fn(usize) -> f64,
    ) -> f64 {
        let of_unknown = |i: usize| u(i) * self.stiffness(i, &u) + (u(i) * load[i].to_f64()).abs();
        let of_jump = |k: usize| jump_multipliers(k).powi(2) / self.weights[k].to_f64();
        (0..load.len()).map(of_unknown).sum::<f64>() + (0..self.n_jumps()).map(of_jump).sum::<f64>()
    }

    /// The sum `p.g` of the jump multipliers `p = S (M u - g)`, or of the given ones if there are as many
    /// as jumps, times the Dirichlet data, over the jumps whose first unknown `counts`.
    pub fn work_on_data(
        &self,
        u: impl Fn(usize) -> f64 + Sync,
        jump_multipliers: &[T],
        counts: impl Fn(usize) -> bool + Sync,
    ) -> f64 {
        let is_given = jump_multipliers.len() == self.n_jumps();
        let of_jump = |k: usize| {
            let g = self.jump_data[k].to_f64();
            if g == 0.0 || !self.first_unknown(k).is_some_and(&counts) {
                return 0.0;
            }
            let multiplier = if is_given {
                jump_multipliers[k].to_f64()
            } else {
                self.weights[k].to_f64() * (self.jump(k, &u) - g)
            };
            multiplier * g
        };
        let of_chunk =
            |jumps: Range<usize>| jumps.map(of_jump).filter(|work| *work != 0.0).collect();
        let not_zero: Vec<Vec<f64>> = map_chunks(self.n_jumps(), of_chunk);
        not_zero.iter().flatten().sum()
    }

    /// Two sums of absolute values of terms of the residual `(c - K u - M^T p)_i`: the sum over the terms with free
    /// unknowns and jump multipliers `p`, and the sum over the terms with fixed unknowns and the load.
    pub(crate) fn residual_term_magnitudes(
        &self,
        (i, load): (usize, T),
        u: impl Fn(usize) -> f64,
        jump_multipliers: &[T],
        is_fixed: impl Fn(usize) -> bool,
    ) -> [f64; 2] {
        let n = self.block_size();
        let block = i / n;
        let (mut free, mut fixed) = (0.0, load.to_f64().abs());
        for j in block * n..(block + 1) * n {
            let size = (self.blocks[i * n + j % n].to_f64() * u(j)).abs();
            *(if is_fixed(j) { &mut fixed } else { &mut free }) += size;
        }
        for side in self.jumps.sides_of(block) {
            let terms = self.terms_of(side.jump());
            let own = terms.iter().find(|t| side.unknown(t) as usize == i);
            let coefficient = own.map_or(0.0, |t| t.weight.to_f64());
            free += (coefficient * jump_multipliers[side.jump()].to_f64()).abs();
        }
        [free, fixed]
    }

    /// The jump residual `g - M u + S^-1 p`, one entry, for the multiplier `p` of that jump.
    #[inline]
    pub fn jump_residual(&self, jump: usize, u: impl Fn(usize) -> f64, multiplier: f64) -> f64 {
        self.jump_data[jump].to_f64() - self.jump(jump, u)
            + multiplier / self.weights[jump].to_f64()
    }
}
