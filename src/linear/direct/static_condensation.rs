//! Direct solution with a matrix that is kept factored: blocks first, then means over facets.
//!
//! An over-penalty `s (here - there)^2` on the means over the sides of a facet is the least value of
//! `2 s (here - a)^2 + 2 s (there - a)^2` over a number `a`. With these numbers given, blocks are
//! independent of each other; what is left for the numbers is, up to `1 / s`, the matrix of
//! Crouzeix-Raviart elements: half the unknowns in the plane, and a condition of `h^-2` whatever the
//! weight. Blocks are eliminated together with the forces of their jumps, in the quasidefinite form
//!
//! ```text
//! [ K  M^T  ] [ u ]   [ r     ]
//! [ M  -1/w ] [ p ] = [ a + t ]
//! ```
//!
//! in which no weight meets a stiffness. Only where a block can move in fewer ways than it has jumps
//! (some unknowns are fixed; quadratic functions that vanish at both Gauss points of every edge),
//! weights remain beside stiffnesses; there they are cut down, and refinement restores them.
//!
//! Source of the elimination: static condensation of hybrid methods, B. Cockburn,
//! J. Gopalakrishnan, R. Lazarov, SIAM J. Numer. Anal. 47 (2009), 1319-1365.

use super::elimination::KnownPattern;
use super::factors::{FactorError, Factors};
use crate::algebra::dense::{invert_in_place, rank};
use crate::algebra::{PenalisedMatrix, SparseMatrix, Term};
use crate::real::Real;

/// Weights that hide a stiffness are cut down to this part of what hides it entirely, where fixed
/// unknowns tie a block; refinement restores them.
const KEPT: f64 = 1e-3;

/// The same where a block is tied as it is, times the root of what hides it: there are many of them,
/// so that half the digits are left for stiffnesses. Forces are in balance with stiffnesses there,
/// and every refinement restores as many digits of them.
const KEPT_BY_ROOT: f64 = 4.0;

/// No mean: the jump has one side only.
const NONE: u32 = u32::MAX;

/// One side of a jump, as its block sees it.
struct Side {
    jump: u32,
    /// The mean that the two sides share.
    mean: u32,
    /// One here, minus one there.
    sign: f64,
}

/// Which blocks meet in which jumps: the same for all sets of fixed unknowns.
pub(crate) struct StaticCondensation<'a, T> {
    factored: &'a PenalisedMatrix<T>,
    /// Start of each block's sides, and their number at the end.
    starts: Vec<usize>,
    sides: Vec<Side>,
    /// The pattern of the matrix on means, on and left of the diagonal.
    pattern: SparseMatrix<T>,
    /// What is known of its factors, whatever the active set.
    known: KnownPattern,
}

/// What has been eliminated, and the factors of what is left.
pub(crate) struct CondensedFactors<T> {
    /// The inverses of all blocks with their jumps, by rows: free unknowns, then forces.
    inverses: Vec<f64>,
    /// Start of each block's inverse.
    starts: Vec<usize>,
    means: Factors<T>,
}

impl<'a, T: Real> StaticCondensation<'a, T> {
    pub fn new(factored: &'a PenalisedMatrix<T>) -> Self {
        let n_blocks = factored.load.len() / factored.block;
        let between: Vec<[Option<u32>; 2]> =
            (0..factored.n_jumps()).map(|jump| factored.sides(jump)).collect();
        let mut starts = vec![0; n_blocks + 1];
        for block in between.iter().flatten().flatten() {
            starts[*block as usize + 1] += 1;
        }
        for k in 0..n_blocks {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let none = || Side { jump: NONE, mean: NONE, sign: 0.0 };
        let mut sides: Vec<Side> = (0..starts[n_blocks]).map(|_| none()).collect();
        let mut n_means = 0;
        for (jump, blocks) in between.iter().enumerate() {
            let is_shared = blocks.iter().all(Option::is_some);
            let mean = if is_shared { n_means } else { NONE };
            for (block, sign) in blocks.iter().zip([1.0, -1.0]) {
                if let Some(block) = block {
                    let place = &mut next[*block as usize];
                    sides[*place] = Side { jump: jump as u32, mean, sign };
                    *place += 1;
                }
            }
            n_means += u32::from(is_shared);
        }
        let known = KnownPattern::default();
        let mut hybrid = Self { factored, starts, sides, pattern: empty(), known };
        hybrid.pattern = hybrid.find_pattern(n_means as usize);
        hybrid
    }

    /// The same with the points of unknowns, if these are known.
    #[must_use]
    pub fn at(mut self, points: Option<&[[f32; 3]]>) -> Self {
        self.known = KnownPattern::of_jumps(self.factored, points);
        self
    }

    /// The means of both blocks of a mean up to itself, ascending.
    fn find_pattern(&self, n_means: usize) -> SparseMatrix<T> {
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n_means];
        for block in 0..self.starts.len() - 1 {
            let means = || self.sides(block).iter().map(|s| s.mean).filter(|&m| m != NONE);
            for row in means() {
                rows[row as usize].extend(means().filter(|&m| m <= row));
            }
        }
        let mut pattern = empty();
        for mut row in rows {
            row.sort_unstable();
            row.dedup();
            pattern.columns.extend(row);
            pattern.row_starts.push(pattern.columns.len() as u32);
        }
        pattern.values = vec![T::lit(0.0); pattern.columns.len()];
        pattern
    }

    fn sides(&self, block: usize) -> &[Side] {
        &self.sides[self.starts[block]..self.starts[block + 1]]
    }

    /// The free unknowns of a block.
    fn free<'f>(
        &self,
        block: usize,
        is_free: &'f [bool],
    ) -> impl Iterator<Item = usize> + use<'f, T> {
        let n = self.factored.block;
        (block * n..(block + 1) * n).filter(|&i| is_free[i])
    }

    /// The weight of an unknown in the mean over a side.
    fn in_mean(&self, side: &Side, unknown: usize) -> f64 {
        let own = |t: &&Term<T>| {
            let i = if side.sign > 0.0 { t.here } else { t.there };
            i as usize == unknown
        };
        self.factored
            .terms_of(side.jump as usize)
            .iter()
            .find(own)
            .map_or(0.0, |t| t.weight.to_f64())
    }

    /// The weight with which a mean over a side is tied to what is across: twice that of the jump,
    /// because the number between the two sides is half way.
    fn weight(&self, side: &Side) -> f64 {
        let weight = self.factored.weights[side.jump as usize].to_f64();
        if side.mean == NONE { weight } else { 2.0 * weight }
    }

    /// In how many ways a block can move its means with the unknowns that may.
    fn freedom(&self, block: usize, may_move: impl Fn(usize) -> bool) -> usize {
        let (n, sides) = (self.factored.block, self.sides(block));
        let moving = (block * n..(block + 1) * n).filter(|&i| may_move(i));
        let means = |i: usize| sides.iter().map(|side| self.in_mean(side, i)).collect();
        rank(moving.map(means).collect(), T::EPSILON.sqrt())
    }

    /// Eliminates blocks and factors what is left.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&self, is_free: &[bool]) -> Result<CondensedFactors<T>, FactorError> {
        self.factor_shifted(is_free, &[])
    }

    /// The same with a nonnegative diagonal added to `K`, if there is any.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor_shifted(
        &self,
        is_free: &[bool],
        shift: &[f64],
    ) -> Result<CondensedFactors<T>, FactorError> {
        let mut matrix = self.pattern.clone();
        let (mut inverses, mut starts) = (Vec::new(), vec![0]);
        let mut local = Vec::new();
        for block in 0..self.starts.len() - 1 {
            let first_side = self.invert(block, is_free, shift, &mut local)?;
            let sides = self.sides(block);
            let n = first_side + sides.len();
            for (i, row) in sides.iter().enumerate().filter(|(_, s)| s.mean != NONE) {
                let columns = matrix.row(row.mean as usize).0.to_vec();
                let start = matrix.row_starts[row.mean as usize] as usize;
                for (j, column) in sides.iter().enumerate().filter(|(_, s)| s.mean <= row.mean) {
                    if let Ok(place) = columns.binary_search(&column.mean) {
                        let entry = -local[(first_side + i) * n + first_side + j];
                        matrix.values[start + place] += T::lit(entry);
                    }
                }
            }
            inverses.extend_from_slice(&local);
            starts.push(inverses.len());
        }
        let means = self.known.factor(matrix)?;
        Ok(CondensedFactors { inverses, starts, means })
    }

    /// The inverse of a block with its jumps; returns the number of free unknowns.
    fn invert(
        &self,
        block: usize,
        is_free: &[bool],
        shift: &[f64],
        out: &mut Vec<f64>,
    ) -> Result<usize, FactorError> {
        let (size, sides) = (self.factored.block, self.sides(block));
        let stiffness = |i: usize, j: usize| self.factored.blocks[i * size + j % size].to_f64();
        let n_free = self.free(block, is_free).count();
        let n = n_free + sides.len();
        // forces in units of the stiffness
        let diagonal = || self.free(block, is_free).map(|i| stiffness(i, i));
        let largest = diagonal().fold(0.0, f64::max);
        let least = diagonal().filter(|&d| d > 0.0).fold(largest, f64::min);
        let unit = if largest > 0.0 { largest } else { 1.0 };
        // a shift that hides the stiffness fixes an unknown
        let by_root = least * KEPT_BY_ROOT / T::EPSILON.sqrt();
        let may_move = |i: usize| is_free[i] && shift.get(i).is_none_or(|&shift| shift <= by_root);
        let moves = (block * size..(block + 1) * size).all(may_move);
        let hidden = if moves { by_root } else { least * KEPT / T::EPSILON };
        out.clear();
        out.resize(n * n, 0.0);
        for (k, i) in self.free(block, is_free).enumerate() {
            for (l, j) in self.free(block, is_free).enumerate() {
                out[k * n + l] = stiffness(i, j) / unit;
            }
            if let Some(&shift) = shift.get(i) {
                out[k * n + k] += shift / unit;
            }
            for (l, side) in (n_free..).zip(sides) {
                let weight = self.in_mean(side, i);
                out[k * n + l] = weight;
                out[l * n + k] = weight;
            }
        }
        // a block that can move in fewer ways than it has jumps is tied to what is across more than
        // once: there weights hide its stiffness
        let is_heavy = n_free > 0 && sides.iter().any(|side| self.weight(side) > hidden);
        let is_tied = is_heavy && self.freedom(block, may_move) < sides.len();
        let most = if is_tied { hidden } else { f64::INFINITY };
        for (l, side) in (n_free..).zip(sides) {
            out[l * n + l] = -unit / self.weight(side).min(most);
        }
        let sign = invert_in_place(out, n).ok_or(FactorError::Singular)?;
        // as many negative eigenvalues as jumps, if the stiffness has none
        if sign != (sides.len() % 2 == 0) {
            return Err(FactorError::NotPositive);
        }
        for k in 0..n {
            for l in 0..n {
                match (k < n_free, l < n_free) {
                    (true, true) => out[k * n + l] /= unit,
                    (false, false) => out[k * n + l] *= unit,
                    _ => {}
                }
            }
        }
        Ok(n_free)
    }

    /// Solves `K u + M^T p = r` on the free unknowns, `M u - p / s = t`; `r` becomes `u`, zero where
    /// fixed, and `t` becomes `p`. Returns the energy `u.K u + p.p / s = u.r - p.t`.
    pub fn solve(
        &self,
        factors: &CondensedFactors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        let mut load = vec![0.0; self.pattern.size()];
        let mut local = Vec::new();
        for block in 0..self.starts.len() - 1 {
            self.right_side(block, is_free, r, t, &|_| 0.0, &mut local);
            let n_free = local.len() - self.sides(block).len();
            for (k, side) in (n_free..).zip(self.sides(block)) {
                if side.mean != NONE {
                    load[side.mean as usize] += factors.row(block, k, &local);
                }
            }
        }
        let mut means: Vec<T> = load.into_iter().map(T::lit).collect();
        factors.means.solve_in_place(&mut means, 1);
        let mean = |k: u32| if k == NONE { 0.0 } else { means[k as usize].to_f64() };
        let given = t.to_vec();
        let mut energy = 0.0;
        for block in 0..self.starts.len() - 1 {
            self.right_side(block, is_free, r, &given, &mean, &mut local);
            let n = self.factored.block;
            let mut k = 0;
            for i in block * n..(block + 1) * n {
                let value = if is_free[i] { factors.row(block, k, &local) } else { 0.0 };
                energy += value * r[i];
                r[i] = value;
                k += usize::from(is_free[i]);
            }
            for (k, side) in (k..).zip(self.sides(block)) {
                // both sides know the force; one is enough
                if side.sign > 0.0 || side.mean == NONE {
                    let force = side.sign * factors.row(block, k, &local);
                    energy -= force * given[side.jump as usize];
                    t[side.jump as usize] = force;
                }
            }
        }
        energy
    }

    /// What stands on the right of a block's equations.
    fn right_side(
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
        out.extend(self.sides(block).iter().map(|side| {
            let share = if side.mean == NONE { 1.0 } else { 0.5 };
            mean(side.mean) + side.sign * share * t[side.jump as usize]
        }));
    }

    /// The sizes of the terms that make up the force on an unknown, those of known values apart, with
    /// forces `p`.
    pub fn force_sizes(
        &self,
        i: usize,
        u: &dyn Fn(usize) -> f64,
        p: &[T],
        is_known: &dyn Fn(usize) -> bool,
    ) -> (f64, f64) {
        let n = self.factored.block;
        let block = i / n;
        let (mut free, mut known) = (0.0, self.factored.load[i].to_f64().abs());
        for j in block * n..(block + 1) * n {
            let size = (self.factored.blocks[i * n + j % n].to_f64() * u(j)).abs();
            *(if is_known(j) { &mut known } else { &mut free }) += size;
        }
        for side in self.sides(block) {
            free += (self.in_mean(side, i) * p[side.jump as usize].to_f64()).abs();
        }
        (free, known)
    }
}

impl<T> CondensedFactors<T> {
    /// A row of a block's inverse times a vector.
    fn row(&self, block: usize, k: usize, x: &[f64]) -> f64 {
        let row = &self.inverses[self.starts[block] + k * x.len()..][..x.len()];
        row.iter().zip(x).fold(0.0, |s, (a, x)| s + a * x)
    }
}

fn empty<T>() -> SparseMatrix<T> {
    SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() }
}
