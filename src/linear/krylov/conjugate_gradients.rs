//! Preconditioned conjugate gradients on the free unknowns.

use super::lanczos::LanczosMatrix;
use super::stopping::{KrylovRun, StopReason, StoppingRule};
use crate::algebra::{Distribution, SparseMatrix, product_of_row, sum_over_parts};
use crate::linear::precondition::Preconditioner;
use crate::parallel::vectors::{dot, for_each_chunk, sum_chunks, sum_chunks_of_two, zeros};
use crate::real::Real;

/// Conjugate gradients for a symmetric matrix, with vectors that are allocated once.
pub(crate) struct ConjugateGradients<'m, T> {
    matrix: &'m SparseMatrix<T>,
    /// The distribution of the unknowns over the parts of a mesh; unknowns that other parts own are fixed.
    distribution: &'m dyn Distribution,
    /// The preconditioned residual.
    z: Vec<T>,
    /// The search direction.
    p: Vec<T>,
    /// The matrix times the search direction.
    q: Vec<T>,
    /// The largest Ritz value of all runs, at least one.
    largest_ritz: f64,
}

impl<'m, T: Real> ConjugateGradients<'m, T> {
    /// The method for a symmetric matrix, or for the rows of one part of a mesh. Unknowns that other parts own must be
    /// fixed, and zero in preconditioned residuals; on return of [`ConjugateGradients::solve`] their values in `x` are
    /// those that the owners computed.
    pub fn new(matrix: &'m SparseMatrix<T>, distribution: &'m dyn Distribution) -> Self {
        let n = matrix.size();
        Self { matrix, distribution, z: zeros(n), p: zeros(n), q: zeros(n), largest_ritz: 1.0 }
    }

    /// Corrects the iterate `(x, r)`, `r` the residual of `x` on free unknowns and zero on fixed ones.
    /// On return `r` is the residual of the new `x` if its norm reached `rule.absolute_tolerance`; else `x` may
    /// contain a last correction that is not yet subtracted from `r`.
    pub fn solve(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        (x, r): (&mut [T], &mut [T]),
        rule: StoppingRule,
    ) -> KrylovRun {
        let mut lanczos = LanczosMatrix::default();
        let mut run = KrylovRun::new();
        preconditioner.apply(r, &mut self.z);
        let mut rz = sum_over_parts(self.distribution, dot(r, &mut self.z));
        let target = rule.target(rz.max(0.0).sqrt());
        self.p.copy_from_slice(&self.z);
        loop {
            run.residual_norm = rz.max(0.0).sqrt();
            run.reason = match () {
                () if !rz.is_finite() => StopReason::NotFinite,
                // a negative square not larger than that of the target is a rounding error
                () if rz < -target * target => StopReason::NotPositive,
                () if run.residual_norm <= target => StopReason::Converged,
                () if run.iterations >= rule.max_iterations => StopReason::IterationLimit,
                () => {
                    let pq = self.multiply(fixed);
                    if !pq.is_finite() {
                        run.reason = StopReason::NotFinite;
                        break;
                    }
                    if pq <= 0.0 {
                        run.reason = StopReason::NotPositive;
                        break;
                    }
                    let alpha = rz / pq;
                    self.update_iterate(T::lit(alpha), x, r);
                    preconditioner.apply(r, &mut self.z);
                    let previous = rz;
                    rz = sum_over_parts(self.distribution, dot(r, &mut self.z));
                    let beta = rz / previous;
                    lanczos.push(alpha, beta);
                    self.update_direction(T::lit(beta));
                    run.iterations += 1;
                    continue;
                }
            };
            break;
        }
        run.ritz = lanczos.extreme_eigenvalues();
        if let Some((_, largest)) = run.ritz {
            self.largest_ritz = self.largest_ritz.max(largest);
        }
        if run.reason == StopReason::Converged && run.residual_norm > rule.absolute_tolerance {
            self.richardson_step(T::lit(1.0 / self.largest_ritz), x);
        }
        self.distribution.update(x);
        run
    }

    /// `q = A p` on free unknowns, zero on fixed ones; returns `p . q`.
    fn multiply(&mut self, fixed: &[bool]) -> f64 {
        self.distribution.update(&mut self.p);
        let (matrix, p) = (&self.matrix, &self.p);
        let own = sum_chunks(&mut self.q, 1, |range, q| {
            let mut sum = 0.0;
            for ((i, row), q) in range.clone().zip(matrix.rows(range)).zip(q) {
                *q = if fixed[i] { T::lit(0.0) } else { product_of_row(row, p) };
                sum += p[i].to_f64() * q.to_f64();
            }
            sum
        });
        sum_over_parts(self.distribution, own)
    }

    /// `p = z + beta p`.
    fn update_direction(&mut self, beta: T) {
        let z = &self.z;
        for_each_chunk(&mut self.p, |range, p| {
            for (p, &z) in p.iter_mut().zip(&z[range]) {
                *p = z + beta * *p;
            }
        });
    }

    /// `x = x + omega z`: a step of Richardson's iteration with the last preconditioned residual,
    /// which needs no further product. It reduces the error in the energy norm if `omega` is less
    /// than two divided by the largest eigenvalue of `B A`.
    fn richardson_step(&self, omega: T, x: &mut [T]) {
        for_each_chunk(x, |range, x| {
            x.iter_mut().zip(&self.z[range]).for_each(|(x, &z)| *x += omega * z);
        });
    }

    /// `x = x + alpha p` and `r = r - alpha q`.
    fn update_iterate(&mut self, alpha: T, x: &mut [T], r: &mut [T]) {
        let (p, q) = (&self.p, &self.q);
        sum_chunks_of_two(x, r, 1, |range, x, r| {
            let directions = p[range.clone()].iter().zip(&q[range]);
            for ((x, r), (&p, &q)) in x.iter_mut().zip(r).zip(directions) {
                *x += alpha * p;
                *r -= alpha * q;
            }
            0.0
        });
    }
}
