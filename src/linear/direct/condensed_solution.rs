//! Solutions by the factors of a [`StaticCondensation`].

use super::static_condensation::{BlockInverses, CondensedFactors, StaticCondensation};
use crate::algebra::NO_INDEX;
use crate::real::Real;

impl<T: Real> StaticCondensation<'_, T> {
    /// Solves `K u + M^T p = r` on the free unknowns and `M u - S^-1 p = t`. Replaces `r` by `u`, which
    /// is zero on fixed unknowns, and `t` by the jump multipliers `p`. Returns the energy
    /// `u.K u + p.(S^-1 p) = u.r - p.t`.
    pub fn solve(
        &self,
        CondensedFactors { inverses, schur_complement }: &CondensedFactors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        let mut load = vec![0.0; schur_complement.size()];
        let mut local = Vec::new();
        for block in 0..self.n_blocks() {
            self.block_right_side(block, is_free, r, t, &|_| 0.0, &mut local);
            let n_free = local.len() - self.sides(block).len();
            for (k, &side) in (n_free..).zip(self.sides(block)) {
                let mean = self.mean(side);
                if mean != NO_INDEX {
                    load[mean as usize] += inverses.row_dot(block, k, &local);
                }
            }
        }
        let mut means: Vec<T> = load.into_iter().map(T::lit).collect();
        schur_complement.solve_in_place(&mut means, 1);
        let mean = |k: u32| if k == NO_INDEX { 0.0 } else { means[k as usize].to_f64() };
        let jump_right_side = t.to_vec();
        let mut energy = 0.0;
        for block in 0..self.n_blocks() {
            self.block_right_side(block, is_free, r, &jump_right_side, &mean, &mut local);
            let n = self.penalised.block_size();
            let mut k = 0;
            for i in block * n..(block + 1) * n {
                let value = if is_free[i] { inverses.row_dot(block, k, &local) } else { 0.0 };
                energy += value * r[i];
                r[i] = value;
                k += usize::from(is_free[i]);
            }
            for (k, &side) in (k..).zip(self.sides(block)) {
                // The multipliers of the two sides of a facet are equal up to the signs of the sides: one is used.
                if side.is_here() || self.mean(side) == NO_INDEX {
                    let multiplier = side.sign() * inverses.row_dot(block, k, &local);
                    energy -= multiplier * jump_right_side[side.jump()];
                    t[side.jump()] = multiplier;
                }
            }
        }
        energy
    }

    /// Sets `out` to the right-hand side of the equations of a block: `r` on its free unknowns, then for each side
    /// the facet mean plus the share of the side in `t`.
    fn block_right_side(
        &self,
        block: usize,
        is_free: &[bool],
        r: &[f64],
        t: &[f64],
        mean: &dyn Fn(u32) -> f64,
        out: &mut Vec<f64>,
    ) {
        out.clear();
        out.extend(self.free(block, is_free).map(|i| r[i]));
        let sides = self.sides(block).iter();
        out.extend(sides.map(|&s| mean(self.mean(s)) + self.share(s) * t[s.jump()]));
    }
}

impl BlockInverses {
    /// Row `k` of a block's inverse times a vector.
    fn row_dot(&self, block: usize, k: usize, x: &[f64]) -> f64 {
        let row = &self.entries[self.starts[block] + k * x.len()..][..x.len()];
        row.iter().zip(x).fold(0.0, |s, (a, x)| s + a * x)
    }
}
