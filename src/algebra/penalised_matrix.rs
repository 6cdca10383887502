//! A matrix that is not multiplied out.

use rayon::prelude::*;

use crate::real::Real;

/// A matrix and a load as the sums they are: `A = K + M^T S M` and `b = c + M^T S g`, `K` made of
/// dense blocks on the diagonal, `S` diagonal and positive, `M` sparse.
///
/// The matrix of an over-penalised scheme is of this kind: `K` is the stiffness of cells, `M u` the
/// jumps of means over facets, `S` the penalty weights, `g` the Dirichlet data. Multiplied out,
/// weights bury the stiffness: rounding of size `eps eta h^-2` in every entry acts on all functions
/// alike. As it stands, a residual `c - K u - M^T S (M u - g)` has rounding of that size in the range
/// of `M^T` only, where it moves jumps by `eps |u|` and nothing else.
///
/// The *forces* of jumps are `p = S (M u - g)`. Where they are kept besides the values they are known
/// to all digits, which jumps, differences of values, are not.
#[derive(Clone, Debug, PartialEq)]
pub struct PenalisedMatrix<T> {
    /// Unknowns of a block.
    pub block: usize,
    /// `K`: its blocks one after the other, each by rows, positive semidefinite.
    pub blocks: Vec<T>,
    /// `c`.
    pub load: Vec<T>,
    /// Start of each row of `M` in `terms`, and the number of terms at the end.
    pub starts: Vec<u32>,
    /// The terms of all rows. What is here in a row is of one block, what is there of another.
    pub terms: Vec<Term<T>>,
    /// `S`.
    pub weights: Vec<T>,
    /// `g`.
    pub data: Vec<T>,
}

/// A weight times the difference of two unknowns: differences come first, so that a function without
/// jump has none in rounded arithmetic either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term<T> {
    /// The unknown here; [`Term::NONE`] for none.
    pub here: u32,
    /// The unknown there; [`Term::NONE`] for none.
    pub there: u32,
    /// The weight.
    pub weight: T,
}

impl<T> Term<T> {
    /// No unknown: zero in the difference.
    pub const NONE: u32 = u32::MAX;
}

/// Items for which another thread pays.
const CHUNK: usize = 4096;

impl<T: Real> PenalisedMatrix<T> {
    /// Number of jumps.
    pub fn n_jumps(&self) -> usize {
        self.weights.len()
    }

    /// The terms of a jump.
    #[inline]
    pub fn terms_of(&self, jump: usize) -> &[Term<T>] {
        &self.terms[self.starts[jump] as usize..self.starts[jump + 1] as usize]
    }

    /// Whether the parts belong together and to a vector of this size, and weights are positive.
    pub fn is_well_formed(&self, size: usize) -> bool {
        let n = self.n_jumps();
        let fits = |i: u32| i == Term::<T>::NONE || (i as usize) < size;
        self.block > 0
            && size.is_multiple_of(self.block)
            && self.blocks.len() == size * self.block
            && self.load.len() == size
            && self.data.len() == n
            && self.starts.len() == n + 1
            && self.starts.first() == Some(&0)
            && self.starts.windows(2).all(|w| w[0] <= w[1])
            && self.starts[n] as usize == self.terms.len()
            && self.terms.iter().all(|t| fits(t.here) && fits(t.there))
            && self.weights.iter().all(|&s| s > T::lit(0.0))
    }

    /// The blocks that a jump is between: here and there, where it has terms.
    pub fn sides(&self, jump: usize) -> [Option<u32>; 2] {
        let block = |unknown: fn(&Term<T>) -> u32| {
            let mut unknowns = self.terms_of(jump).iter().map(unknown);
            let found = unknowns.find(|&i| i != Term::<T>::NONE);
            found.map(|i| i / self.block as u32)
        };
        [block(|t| t.here), block(|t| t.there)]
    }

    /// `M u`, one entry, in `f64`.
    #[inline]
    pub fn jump(&self, jump: usize, u: impl Fn(usize) -> f64) -> f64 {
        let value = |i: u32| if i == Term::<T>::NONE { 0.0 } else { u(i as usize) };
        self.terms_of(jump)
            .iter()
            .fold(0.0, |s, t| s + t.weight.to_f64() * (value(t.here) - value(t.there)))
    }

    /// `K u`, one entry, in `f64`.
    #[inline]
    pub fn stiffness(&self, i: usize, u: impl Fn(usize) -> f64) -> f64 {
        let n = self.block;
        let first = i / n * n;
        let row = &self.blocks[i * n..(i + 1) * n];
        row.iter().enumerate().fold(0.0, |s, (j, a)| s + a.to_f64() * u(first + j))
    }

    /// `K`, one entry of its diagonal.
    pub fn diagonal(&self, i: usize) -> f64 {
        self.blocks[i * self.block + i % self.block].to_f64()
    }

    /// `S (M u - g)`.
    pub fn forces(&self, u: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let force =
            |f: usize| self.weights[f].to_f64() * (self.jump(f, &u) - self.data[f].to_f64());
        (0..self.n_jumps()).into_par_iter().with_min_len(CHUNK).map(force).collect()
    }

    /// `r = c - K u - M^T p`.
    pub fn residual_with_forces(
        &self,
        u: impl Fn(usize) -> f64 + Sync,
        forces: impl Fn(usize) -> f64,
        r: &mut [f64],
    ) {
        r.par_iter_mut()
            .with_min_len(CHUNK)
            .enumerate()
            .for_each(|(i, r)| *r = self.load[i].to_f64() - self.stiffness(i, &u));
        for jump in 0..self.n_jumps() {
            let force = forces(jump);
            for t in self.terms_of(jump) {
                let pull = t.weight.to_f64() * force;
                if t.here != Term::<T>::NONE {
                    r[t.here as usize] -= pull;
                }
                if t.there != Term::<T>::NONE {
                    r[t.there as usize] += pull;
                }
            }
        }
    }

    /// `r = b - A u`.
    pub fn residual(&self, u: impl Fn(usize) -> f64 + Sync, r: &mut [f64]) {
        let forces = self.forces(&u);
        self.residual_with_forces(u, |f| forces[f], r);
    }

    /// The size of energies: `u.K u + p.p / s + |c.u|`, the last by its terms.
    pub fn energy(&self, u: impl Fn(usize) -> f64 + Sync, forces: impl Fn(usize) -> f64) -> f64 {
        let of_unknown =
            |i: usize| u(i) * self.stiffness(i, &u) + (u(i) * self.load[i].to_f64()).abs();
        let of_jump = |f: usize| forces(f).powi(2) / self.weights[f].to_f64();
        (0..self.load.len()).map(of_unknown).sum::<f64>()
            + (0..self.n_jumps()).map(of_jump).sum::<f64>()
    }

    /// By how much jumps and forces disagree: `g - M u + p / s`, one entry.
    #[inline]
    pub fn mismatch(&self, jump: usize, u: impl Fn(usize) -> f64, force: f64) -> f64 {
        self.data[jump].to_f64() - self.jump(jump, u) + force / self.weights[jump].to_f64()
    }
}
