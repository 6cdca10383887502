//! Generalised minimal residuals on the unknowns that are free, for matrices that are not symmetric.
//!
//! Source: Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986), 856-869; in the inner
//! product of a preconditioner of the symmetric part, which makes the rate that of the field of
//! values and independent of the mesh: G. Starke, Numer. Math. 78 (1997), 103-117; S. C. Eisenstat,
//! H. C. Elman, M. H. Schultz, SIAM J. Numer. Anal. 20 (1983), 345-357.

use nalgebra::DMatrix;

use super::conjugate_gradients::{End, Preconditioner, Run, Stop, dot};
use crate::algebra::SparseMatrix;
use crate::parallel::vectors::{each_mut, sum_mut2, zeros};
use crate::real::Real;

/// Directions after which the iteration starts anew.
const RESTART: usize = 25;

/// Share of the residual to which it falls at most before the iteration starts anew: preconditioners
/// work in single precision, and directions lose their orthogonality as the residual falls (A.
/// Greenbaum, M. Rozloznik, Z. Strakos, BIT 37 (1997), 706-719).
const MOST_AT_ONCE: f64 = 1e-4;

/// The least squares problem is solved to a little less than asked: its residual and the computed
/// one differ by rounding.
const MARGIN: f64 = 0.99;

/// Restarted minimal residuals: the norm that is minimised is the one [`Stop`] asks for, so that it
/// never rises. The vectors are kept from one use to the next.
pub(crate) struct MinimalResiduals<T> {
    /// Forces, orthonormal in the inner product of the preconditioner.
    forces: Vec<Vec<T>>,
    /// The preconditioner times each: directions. Both are kept, because what the preconditioner
    /// rounds must not add up.
    directions: Vec<Vec<T>>,
}

impl<T: Real> MinimalResiduals<T> {
    pub fn new(size: usize) -> Self {
        Self { forces: vec![zeros(size)], directions: vec![zeros(size)] }
    }

    /// Corrects `x`, whose residual is `r` where free and zero where fixed; `r` is kept up to date.
    pub fn solve(
        &mut self,
        matrix: &SparseMatrix<T>,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        (x, r): (&mut [T], &mut [T]),
        stop: Stop,
    ) -> Run {
        let mut run = Run { iterations: 0, end: End::Reached, first: 0.0, last: 0.0, ritz: None };
        let mut target = stop.norm;
        let mut before = None;
        loop {
            preconditioner.apply(r, &mut self.directions[0]);
            let square = dot(r, &mut self.directions[0]);
            run.last = square.max(0.0).sqrt();
            if run.iterations == 0 {
                run.first = run.last;
                target = target.max(stop.share * run.first);
            }
            let left = stop.iterations - run.iterations;
            run.end = match before {
                _ if !square.is_finite() => End::NotFinite,
                _ if run.last <= target => End::Reached,
                _ if square < 0.0 => End::NotPositive,
                Some(before) if !arrives(before, run.last, target, left) => End::Limit,
                _ if left == 0 => End::Limit,
                _ => {
                    let goal = target.max(MOST_AT_ONCE * run.last);
                    let most = left.min(RESTART);
                    let projection =
                        self.project(matrix, fixed, preconditioner, r, (run.last, goal), most);
                    run.iterations += projection.size();
                    if !projection.is_finite() {
                        run.end = End::NotFinite;
                        return run;
                    }
                    run.ritz = projection.extremes(run.ritz);
                    if run.ritz.is_some_and(|(low, _)| low <= 0.0) {
                        run.end = End::NotPositive;
                        return run;
                    }
                    before = Some((run.last, projection.size()));
                    self.correct(matrix, fixed, &projection.solution(run.last), (x, r));
                    continue;
                }
            };
            return run;
        }
    }

    /// New directions until the residual `r`, of this norm at first, is expected to have that of the
    /// goal. The first direction is there but for its length.
    fn project(
        &mut self,
        matrix: &SparseMatrix<T>,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        r: &[T],
        (first, goal): (f64, f64),
        most: usize,
    ) -> Projection {
        let mut projection = Projection::default();
        let mut norm = first;
        let mut rest = first;
        self.forces[0].copy_from_slice(r);
        while projection.size() < most && rest > MARGIN * goal && norm > 0.0 && norm.is_finite() {
            let k = projection.size();
            if self.forces.len() == k + 1 {
                self.forces.push(zeros(r.len()));
                self.directions.push(zeros(r.len()));
            }
            let (forces, next) = self.forces.split_at_mut(k + 1);
            let next = &mut next[0];
            scale(&mut forces[k], 1.0 / norm);
            scale(&mut self.directions[k], 1.0 / norm);
            let last = &self.directions[k];
            each_mut(next, |range, next| {
                for (i, next) in range.zip(next) {
                    *next = if fixed[i] { T::lit(0.0) } else { matrix.row_dot(i, last) };
                }
            });
            let mut column = Vec::with_capacity(k + 2);
            for (force, direction) in forces.iter().zip(&self.directions) {
                let share = dot(direction, next);
                subtract(next, share, force);
                column.push(share);
            }
            preconditioner.apply(next, &mut self.directions[k + 1]);
            norm = dot(next, &mut self.directions[k + 1]).max(0.0).sqrt();
            column.push(norm);
            rest *= projection.push(column);
        }
        projection
    }

    /// Adds a combination of the directions to `x`, and subtracts its forces from `r`.
    fn correct(
        &mut self,
        matrix: &SparseMatrix<T>,
        fixed: &[bool],
        weights: &[f64],
        (x, r): (&mut [T], &mut [T]),
    ) {
        let directions = &self.directions;
        let change = &mut self.forces[0];
        sum_mut2(change, x, |range, change, x| {
            change.fill(T::lit(0.0));
            for (&weight, direction) in weights.iter().zip(directions) {
                let weight = T::lit(weight);
                for (change, &z) in change.iter_mut().zip(&direction[range.clone()]) {
                    *change += weight * z;
                }
            }
            x.iter_mut().zip(change).for_each(|(x, &mut change)| *x += change);
            0.0
        });
        let change = &self.forces[0];
        each_mut(r, |range, r| {
            for (i, r) in range.zip(r) {
                if !fixed[i] {
                    *r -= matrix.row_dot(i, change);
                }
            }
        });
    }
}

/// Whether as many iterations as are left reach the target at the rate of the last ones: those
/// since the norm was `before`.
fn arrives((before, count): (f64, usize), last: f64, target: f64, left: usize) -> bool {
    let rate = (before / last).ln() / count as f64;
    (last / target).ln() <= rate * left as f64
}

fn scale<T: Real>(x: &mut [T], factor: f64) {
    let factor = T::lit(factor);
    each_mut(x, |_, x| x.iter_mut().for_each(|x| *x *= factor));
}

fn subtract<T: Real>(x: &mut [T], factor: f64, other: &[T]) {
    let factor = T::lit(factor);
    each_mut(x, |range, x| {
        x.iter_mut().zip(&other[range]).for_each(|(x, &y)| *x -= factor * y);
    });
}

/// The matrix on the directions, and its triangular factor by rotations.
#[derive(Default)]
struct Projection {
    /// Column `k` has `k + 2` entries.
    columns: Vec<Vec<f64>>,
    /// The same after rotation, `k + 1` entries.
    triangle: Vec<Vec<f64>>,
    /// Cosine and sine of each rotation.
    rotations: Vec<(f64, f64)>,
}

impl Projection {
    fn size(&self) -> usize {
        self.columns.len()
    }

    fn is_finite(&self) -> bool {
        self.columns.iter().flatten().all(|x| x.is_finite())
    }

    /// Adds a column; returns by which factor the residual shrinks.
    fn push(&mut self, column: Vec<f64>) -> f64 {
        let mut rotated = column.clone();
        for (k, &(c, s)) in self.rotations.iter().enumerate() {
            let (a, b) = (rotated[k], rotated[k + 1]);
            (rotated[k], rotated[k + 1]) = (c * a + s * b, c * b - s * a);
        }
        self.columns.push(column);
        let below = rotated.pop().unwrap_or(0.0);
        let last =
            rotated.last_mut().map_or(0.0, |last| std::mem::replace(last, last.hypot(below)));
        let length = last.hypot(below);
        let (c, s) = if length > 0.0 { (last / length, below / length) } else { (1.0, 0.0) };
        self.rotations.push((c, s));
        self.triangle.push(rotated);
        s.abs()
    }

    /// The weights of the directions for which a residual of this norm along the first shrinks most.
    fn solution(&self, norm: f64) -> Vec<f64> {
        let n = self.size();
        let mut right = Vec::with_capacity(n);
        let mut rest = norm;
        for &(c, s) in &self.rotations {
            right.push(c * rest);
            rest *= -s;
        }
        for k in (0..n).rev() {
            right[k] /= self.triangle[k][k];
            for i in 0..k {
                right[i] -= self.triangle[k][i] * right[k];
            }
        }
        right
    }

    /// Smallest and largest eigenvalue of the symmetric part, and of those known before: they lie
    /// between those of the preconditioned symmetric part of the matrix.
    fn extremes(&self, before: Option<(f64, f64)>) -> Option<(f64, f64)> {
        let entry = |i: usize, j: usize| self.columns[j].get(i).copied().unwrap_or(0.0);
        let n = self.size();
        let part = DMatrix::from_fn(n, n, |i, j| 0.5 * (entry(i, j) + entry(j, i)));
        let ritz = part.symmetric_eigenvalues();
        let known = ritz.iter().copied().chain(before.into_iter().flat_map(|(l, h)| [l, h]));
        known.fold(None, |range: Option<(f64, f64)>, x| {
            Some(range.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Diagonal([f64; 4]);
    impl Preconditioner<f64> for Diagonal {
        fn apply(&mut self, r: &[f64], z: &mut [f64]) {
            for (i, z) in z.iter_mut().enumerate() {
                *z = self.0[i] * r[i];
            }
        }
    }

    /// `diag(1, 2, 4, 5)` with entries of opposite sign beside the diagonal.
    fn matrix(beside: f64) -> SparseMatrix<f64> {
        let b = beside;
        SparseMatrix {
            row_starts: vec![0, 2, 5, 8, 10],
            columns: vec![0, 1, 0, 1, 2, 1, 2, 3, 2, 3],
            values: vec![1.0, b, -b, 2.0, b, -b, 4.0, b, -b, 5.0],
        }
    }

    fn solve(matrix: &SparseMatrix<f64>, b: &[f64], iterations: usize) -> (Run, Vec<f64>) {
        let (mut x, mut r) = (vec![0.0; 4], b.to_vec());
        let stop = Stop { norm: 1e-13, share: 0.0, iterations };
        let mut preconditioner = Diagonal([1.0, 0.5, 0.3, 0.1]);
        let run = MinimalResiduals::new(4).solve(
            matrix,
            &[false; 4],
            &mut preconditioner,
            (&mut x, &mut r),
            stop,
        );
        assert!(matrix.residual(b, &x).iter().zip(&r).all(|(a, b)| (a - b).abs() < 1e-14));
        (run, x)
    }

    #[test]
    fn the_norm_falls_to_nothing_in_as_many_steps_as_unknowns() {
        let b = [1.0, 0.3, -0.2, 0.7];
        let mut before = f64::INFINITY;
        for iterations in 0..4 {
            let (run, x) = solve(&matrix(3.0), &b, iterations);
            assert_eq!((run.end, run.iterations), (End::Limit, iterations));
            let r = matrix(3.0).residual(&b, &x);
            let weights = [1.0, 0.5, 0.3, 0.1];
            let norm = r.iter().zip(weights).map(|(r, w)| w * r * r).sum::<f64>().sqrt();
            assert!((run.last - norm).abs() < 1e-14 && norm < before, "{} {norm}", run.last);
            before = norm;
        }
        let (run, _) = solve(&matrix(3.0), &b, 20);
        assert_eq!(run.end, End::Reached);
        // the preconditioned symmetric part is diag(1, 1, 1.2, 0.5); at most 1e-5 at once
        let (low, high) = run.ritz.unwrap();
        assert!((low - 0.5).abs() < 1e-6 && (high - 1.2).abs() < 1e-6, "{low} {high}");
    }

    #[test]
    fn an_indefinite_symmetric_part_is_noticed() {
        let mut matrix = matrix(3.0);
        matrix.values[9] = -5.0;
        assert_eq!(solve(&matrix, &[1.0; 4], 20).0.end, End::NotPositive);
    }
}
