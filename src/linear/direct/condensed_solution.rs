//! Solutions by the factors of a [`StaticCondensation`].

use super::null_directions::NullDirections;
use super::static_condensation::{CondensedFactors, StaticCondensation};
use crate::algebra::NO_INDEX;
use crate::real::Real;

impl<T: Real> StaticCondensation<'_, T> {
    /// Solves `K u + M^T p = r` on the free unknowns and `M u - c S^-1 p = t`, where `c` is the divisor of the weights
    /// in `factors`. Replaces `r` by `u`, which is zero on fixed unknowns, and `t` by the jump multipliers `p`. Returns
    /// the energy `u.r - p.t`.
    pub(super) fn solve_reduced(
        &self,
        factors: &CondensedFactors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        let n_means = self.pattern.size();
        let CondensedFactors { null_directions, .. } = factors;
        let mut load = vec![0.0; n_means];
        let mut local = Vec::new();
        for block in 0..self.starts.len() - 1 {
            self.block_right_side(block, is_free, r, t, &|_| 0.0, &mut local);
            let n_free = local.len() - self.sides(block).len();
            for (k, side) in (n_free..).zip(self.sides(block)) {
                if side.mean != NO_INDEX {
                    load[side.mean as usize] += factors.row_dot(block, k, &local);
                }
            }
        }
        self.append_null_loads(null_directions, is_free, r, t, &mut load);
        // the facet means, then the multipliers of null directions
        let mut condensed: Vec<T> = load.into_iter().map(T::lit).collect();
        factors.schur_complement.solve_in_place(&mut condensed, 1);
        let mean = |k: u32| if k == NO_INDEX { 0.0 } else { condensed[k as usize].to_f64() };
        let jump_right_side = t.to_vec();
        let mut energy = 0.0;
        let mut directions = 0..0;
        for block in 0..self.starts.len() - 1 {
            directions = null_directions.of_block(block, directions.end);
            self.block_right_side(block, is_free, r, &jump_right_side, &mean, &mut local);
            let n = self.penalised.block_size;
            let mut k = 0;
            for i in block * n..(block + 1) * n {
                let response = |direction: usize| {
                    null_directions.responses(direction)[k]
                        * condensed[n_means + direction].to_f64()
                };
                let value = match is_free[i] {
                    true => directions
                        .clone()
                        .map(response)
                        .fold(factors.row_dot(block, k, &local), |s, x| s + x),
                    false => 0.0,
                };
                energy += value * r[i];
                r[i] = value;
                k += usize::from(is_free[i]);
            }
            for (k, side) in (k..).zip(self.sides(block)) {
                // The multipliers of the two sides of a facet are equal up to the signs of the sides: one is used.
                if side.sign > 0.0 || side.mean == NO_INDEX {
                    let multiplier = side.sign * factors.row_dot(block, k, &local);
                    energy -= multiplier * jump_right_side[side.jump as usize];
                    t[side.jump as usize] = multiplier;
                }
            }
        }
        for (k, (&block, q)) in
            null_directions.blocks().iter().zip(&condensed[n_means..]).enumerate()
        {
            let sides = self.sides(block as usize).iter().zip(null_directions.entries(k));
            for (side, y) in sides.filter(|(s, _)| s.sign > 0.0 || s.mean == NO_INDEX) {
                let multiplier = -side.sign * y * q.to_f64();
                energy -= multiplier * jump_right_side[side.jump as usize];
                t[side.jump as usize] += multiplier;
            }
        }
        energy
    }

    /// Appends to `load` the right-hand sides of the equations of the multipliers of null directions.
    fn append_null_loads(
        &self,
        null_directions: &NullDirections,
        is_free: &[bool],
        r: &[f64],
        t: &[f64],
        load: &mut Vec<f64>,
    ) {
        load.extend(null_directions.blocks().iter().enumerate().map(|(k, &block)| {
            let sides = self.sides(block as usize).iter().zip(null_directions.entries(k));
            let unknowns = self.free(block as usize, is_free).zip(null_directions.responses(k));
            let of_unknowns = unknowns.fold(0.0, |s, (i, g)| s + g * r[i]);
            sides.fold(of_unknowns, |s, (side, y)| s - y * side.share() * t[side.jump as usize])
        }));
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
        out.extend(sides.map(|side| mean(side.mean) + side.share() * t[side.jump as usize]));
    }
}

impl<T> CondensedFactors<T> {
    /// Row `k` of a block's inverse times a vector.
    fn row_dot(&self, block: usize, k: usize, x: &[f64]) -> f64 {
        let row = &self.inverses[self.starts[block] + k * x.len()..][..x.len()];
        row.iter().zip(x).fold(0.0, |s, (a, x)| s + a * x)
    }
}
