//! GMRES on the free unknowns, for matrices that are not symmetric.
//!
//! Source: Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986), 856-869. The inner product
//! is `v . B w` with a preconditioner `B` of the symmetric part: the rate of convergence then
//! depends on the field of values of `B A` only, and not on the mesh (G. Starke, Numer. Math. 78
//! (1997), 103-117; S. C. Eisenstat, H. C. Elman, M. H. Schultz, SIAM J. Numer. Anal. 20 (1983),
//! 345-357).

use nalgebra::{DMatrix, DVector};

use super::stopping::{KrylovRun, StopReason, StoppingRule};
use crate::algebra::{Distribution, SparseMatrix, sum_over_parts};
use crate::linear::precondition::Preconditioner;
use crate::parallel::vectors::{dot, for_each_chunk, sum_chunks_of_two, zeros};
use crate::real::Real;

/// Largest dimension of the Krylov space before a restart.
const RESTART: usize = 25;

/// Least ratio of the norm of the residual after a cycle to that before it; smaller norms are reached by a restart.
/// Preconditioners work in single precision, and the basis loses its orthogonality as the residual falls
/// (A. Greenbaum, M. Rozloznik, Z. Strakos, BIT 37 (1997), 706-719).
const LEAST_CYCLE_RATIO: f64 = 1e-4;

/// A cycle ends when the residual of the least squares problem is at most this factor times the wanted norm. The true
/// residual is larger by rounding errors.
const LEAST_SQUARES_FACTOR: f64 = 0.99;

/// Restarted GMRES. It minimises the preconditioned norm `(r . B r)^(1/2)` of [`StoppingRule`]. A cycle is the part of
/// a run between two restarts. The vectors are kept for all runs.
pub(crate) struct Gmres<'m, T> {
    matrix: &'m SparseMatrix<T>,
    /// The distribution of the unknowns over the parts of a mesh; unknowns that other parts own are fixed, and zero in
    /// preconditioned residuals.
    distribution: &'m dyn Distribution,
    /// The Krylov basis `v_k`, orthonormal in the inner product `v . B w`.
    basis: Vec<Vec<T>>,
    /// The directions `B v_k`. The correction of `x` is a combination of them, without a further application of `B`, so
    /// that rounding errors of the preconditioner do not accumulate.
    directions: Vec<Vec<T>>,
}

impl<'m, T: Real> Gmres<'m, T> {
    /// The method for a matrix.
    pub fn new(matrix: &'m SparseMatrix<T>, distribution: &'m dyn Distribution) -> Self {
        let vectors = || vec![zeros(matrix.size())];
        Self { matrix, distribution, basis: vectors(), directions: vectors() }
    }

    /// Corrects the iterate `(x, r)`, `r` the residual of `x` on free unknowns and zero on fixed ones,
    /// before and after the call.
    pub fn solve(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        (x, r): (&mut [T], &mut [T]),
        rule: StoppingRule,
    ) -> KrylovRun {
        let mut run = KrylovRun::new();
        let mut target = rule.absolute_tolerance;
        let mut last_cycle = None;
        loop {
            preconditioner.apply(r, &mut self.directions[0]);
            let square = sum_over_parts(self.distribution, dot(r, &mut self.directions[0]));
            run.residual_norm = square.max(0.0).sqrt();
            if run.iterations == 0 {
                target = rule.target(run.residual_norm);
            }
            let remaining = rule.max_iterations - run.iterations;
            run.reason = match last_cycle {
                _ if !square.is_finite() => StopReason::NotFinite,
                // a negative square not larger than that of the target is a rounding error
                _ if square < -target * target => StopReason::NotPositive,
                _ if run.residual_norm <= target => StopReason::Converged,
                Some(cycle) if !converges_within(cycle, run.residual_norm, target, remaining) => {
                    StopReason::IterationLimit
                }
                _ if remaining == 0 => StopReason::IterationLimit,
                _ => {
                    let goal = target.max(LEAST_CYCLE_RATIO * run.residual_norm);
                    let max_dimension = remaining.min(RESTART);
                    let hessenberg = self.arnoldi(
                        fixed,
                        preconditioner,
                        r,
                        (run.residual_norm, goal),
                        max_dimension,
                    );
                    run.iterations += hessenberg.size();
                    if !hessenberg.is_finite() {
                        run.reason = StopReason::NotFinite;
                        return run;
                    }
                    run.ritz = hessenberg.extreme_ritz_values(run.ritz);
                    if run.ritz.is_some_and(|(smallest, _)| smallest <= 0.0) {
                        run.reason = StopReason::NotPositive;
                        return run;
                    }
                    last_cycle = Some((run.residual_norm, hessenberg.size()));
                    let (weights, _) = hessenberg.least_squares(run.residual_norm);
                    self.correct(fixed, weights.as_slice(), (x, r));
                    continue;
                }
            };
            return run;
        }
    }

    /// The Arnoldi process from the residual `r` of norm `initial`, until the norm of the minimal residual is at most
    /// [`LEAST_SQUARES_FACTOR`] times `goal`, or the Krylov space has dimension `max_dimension`. `directions[0]` must
    /// contain `B r`.
    fn arnoldi(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        r: &[T],
        (initial, goal): (f64, f64),
        max_dimension: usize,
    ) -> HessenbergMatrix {
        let matrix = self.matrix;
        let mut hessenberg = HessenbergMatrix::default();
        // the norm of the last basis vector, which is not yet scaled
        let mut norm = initial;
        let mut residual_norm = initial;
        self.basis[0].copy_from_slice(r);
        while hessenberg.size() < max_dimension
            && residual_norm > LEAST_SQUARES_FACTOR * goal
            && norm > 0.0
            && norm.is_finite()
        {
            let k = hessenberg.size();
            if self.basis.len() == k + 1 {
                self.basis.push(zeros(r.len()));
                self.directions.push(zeros(r.len()));
            }
            let (basis, next) = self.basis.split_at_mut(k + 1);
            let next = &mut next[0];
            scale(&mut basis[k], 1.0 / norm);
            scale(&mut self.directions[k], 1.0 / norm);
            self.distribution.update(&mut self.directions[k]);
            let last = &self.directions[k];
            for_each_chunk(next, |range, next| {
                for (i, next) in range.zip(next) {
                    *next = if fixed[i] { T::lit(0.0) } else { matrix.row_dot(i, last) };
                }
            });
            let mut column = Vec::with_capacity(k + 2);
            for (vector, direction) in basis.iter().zip(&self.directions) {
                let coefficient = sum_over_parts(self.distribution, dot(direction, next));
                subtract_multiple(next, coefficient, vector);
                column.push(coefficient);
            }
            preconditioner.apply(next, &mut self.directions[k + 1]);
            let square = dot(next, &mut self.directions[k + 1]);
            norm = sum_over_parts(self.distribution, square).max(0.0).sqrt();
            column.push(norm);
            hessenberg.columns.push(column);
            residual_norm = hessenberg.least_squares(initial).1;
        }
        hessenberg
    }

    /// Adds the combination of the directions with the given weights to `x`, and subtracts the matrix times
    /// this combination from `r` on free unknowns.
    fn correct(&mut self, fixed: &[bool], weights: &[f64], (x, r): (&mut [T], &mut [T])) {
        let directions = &self.directions;
        let change = &mut self.basis[0];
        sum_chunks_of_two(change, x, 1, |range, change, x| {
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
        let (change, matrix) = (&self.basis[0], self.matrix);
        for_each_chunk(r, |range, r| {
            for (i, r) in range.zip(r) {
                if !fixed[i] {
                    *r -= matrix.row_dot(i, change);
                }
            }
        });
    }
}

/// Whether `remaining` iterations reduce the norm of the residual from `norm` to `target`, at the rate of the last
/// cycle, which reduced it from `previous` to `norm` in `count` iterations.
fn converges_within(
    (previous, count): (f64, usize),
    norm: f64,
    target: f64,
    remaining: usize,
) -> bool {
    let rate = (previous / norm).ln() / count as f64;
    (norm / target).ln() <= rate * remaining as f64
}

/// `x = factor x`.
fn scale<T: Real>(x: &mut [T], factor: f64) {
    let factor = T::lit(factor);
    for_each_chunk(x, |_, x| x.iter_mut().for_each(|x| *x *= factor));
}

/// `x = x - factor y`.
fn subtract_multiple<T: Real>(x: &mut [T], factor: f64, y: &[T]) {
    let factor = T::lit(factor);
    for_each_chunk(x, |range, x| {
        x.iter_mut().zip(&y[range]).for_each(|(x, &y)| *x -= factor * y);
    });
}

/// The upper Hessenberg matrix of the Arnoldi process: column `k` has `k + 2` entries.
#[derive(Default)]
struct HessenbergMatrix {
    columns: Vec<Vec<f64>>,
}

impl HessenbergMatrix {
    /// Number of columns.
    fn size(&self) -> usize {
        self.columns.len()
    }

    fn is_finite(&self) -> bool {
        self.columns.iter().flatten().all(|x| x.is_finite())
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.columns[j].get(i).copied().unwrap_or(0.0)
    }

    /// The minimiser `y` of `|norm e_1 - H y|`, the weights of the directions, and the minimum.
    fn least_squares(&self, norm: f64) -> (DVector<f64>, f64) {
        let n = self.size();
        let qr = DMatrix::from_fn(n + 1, n, |i, j| self.entry(i, j)).qr();
        let mut right = DVector::zeros(n + 1);
        right[0] = norm;
        qr.q_tr_mul(&mut right);
        let residual = right[n].abs();
        // without a solution the matrix is singular: no correction
        let y = qr.unpack_r().solve_upper_triangular(&right.rows(0, n));
        (y.unwrap_or_else(|| DVector::zeros(n)), residual)
    }

    /// The smallest and the largest among the eigenvalues of the symmetric part of the square matrix (without the last
    /// row) and the two values `previous`; `None` without columns and `previous`. They lie between the smallest and the
    /// largest eigenvalue of `B` times the symmetric part of `A`.
    fn extreme_ritz_values(&self, previous: Option<(f64, f64)>) -> Option<(f64, f64)> {
        let n = self.size();
        let part = DMatrix::from_fn(n, n, |i, j| 0.5 * (self.entry(i, j) + self.entry(j, i)));
        let ritz = part.symmetric_eigenvalues();
        let all = ritz.iter().copied().chain(previous.into_iter().flat_map(|(l, h)| [l, h]));
        all.fold(None, |range: Option<(f64, f64)>, x| {
            Some(range.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
        })
    }
}
