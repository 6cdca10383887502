//! Preconditioned conjugate gradients on the unknowns that are free.

use crate::algebra::SparseMatrix;
use crate::parallel::vectors::{each_mut, sum_mut, sum_mut2, zeros};
use crate::real::Real;

/// An approximate inverse: symmetric and positive definite on the free unknowns, zero elsewhere.
pub(crate) trait Preconditioner<T> {
    /// `z` becomes the approximate solution for the force `r`, which is zero where fixed.
    fn apply(&mut self, r: &[T], z: &mut [T]);
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// The preconditioned norm of the residual, the root of `r . B r`, falls to this.
    pub norm: f64,
    /// Or to this share of what it is at the start.
    pub share: f64,
    /// Or this many iterations are done.
    pub iterations: usize,
}

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The norm fell as far as asked.
    Reached,
    /// The limit of iterations was reached.
    Limit,
    /// A direction in which matrix or preconditioner is not positive.
    NotPositive,
    /// A number that is not finite.
    NotFinite,
}

/// What an iteration did.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub iterations: usize,
    pub end: End,
    /// The preconditioned norm of the residual at the start and at the end. The norm of an energy
    /// error is this over the root of an eigenvalue of the preconditioned matrix.
    pub first: f64,
    pub last: f64,
    /// Smallest and largest Ritz value: the smallest lies above the smallest eigenvalue of the
    /// preconditioned matrix and comes down to it.
    pub ritz: Option<(f64, f64)>,
}

/// The matrix and the vectors of the iteration, kept from one use to the next.
pub(crate) struct ConjugateGradients<'m, T> {
    matrix: &'m SparseMatrix<T>,
    z: Vec<T>,
    p: Vec<T>,
    q: Vec<T>,
    /// Largest Ritz value so far, at least one.
    highest: f64,
}

impl<'m, T: Real> ConjugateGradients<'m, T> {
    /// For a symmetric matrix.
    pub fn new(matrix: &'m SparseMatrix<T>) -> Self {
        let n = matrix.size();
        Self { matrix, z: zeros(n), p: zeros(n), q: zeros(n), highest: 1.0 }
    }

    /// Corrects `x`, whose residual is `r` where free and zero where fixed. Where the norm fell to that
    /// of `stop` `r` is the residual of what `x` has become.
    pub fn solve(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        (x, r): (&mut [T], &mut [T]),
        stop: Stop,
    ) -> Run {
        let mut lanczos = Lanczos::default();
        let mut run = Run { iterations: 0, end: End::Reached, first: 0.0, last: 0.0, ritz: None };
        preconditioner.apply(r, &mut self.z);
        let mut rz = dot(r, &mut self.z);
        run.first = rz.max(0.0).sqrt();
        let target = stop.norm.max(stop.share * run.first);
        self.p.copy_from_slice(&self.z);
        loop {
            run.last = rz.max(0.0).sqrt();
            run.end = match () {
                () if !rz.is_finite() => End::NotFinite,
                () if run.last <= target => End::Reached,
                () if rz < 0.0 => End::NotPositive,
                () if run.iterations >= stop.iterations => End::Limit,
                () => {
                    let pq = self.multiply(fixed);
                    if !pq.is_finite() {
                        run.end = End::NotFinite;
                        break;
                    }
                    if pq <= 0.0 {
                        run.end = End::NotPositive;
                        break;
                    }
                    let alpha = rz / pq;
                    self.step(T::lit(alpha), x, r);
                    preconditioner.apply(r, &mut self.z);
                    let before = rz;
                    rz = dot(r, &mut self.z);
                    let beta = rz / before;
                    lanczos.push(alpha, beta);
                    self.turn(T::lit(beta));
                    run.iterations += 1;
                    continue;
                }
            };
            break;
        }
        run.ritz = lanczos.extremes();
        if let Some((_, high)) = run.ritz {
            self.highest = self.highest.max(high);
        }
        if run.end == End::Reached && run.last > stop.norm {
            self.relax(T::lit(1.0 / self.highest), x);
        }
        run
    }

    /// `q` becomes the product of the matrix with `p` where free and zero where fixed; returns `p . q`.
    fn multiply(&mut self, fixed: &[bool]) -> f64 {
        let (matrix, p) = (self.matrix, &self.p);
        sum_mut(&mut self.q, |range, q| {
            let mut sum = 0.0;
            for (i, q) in range.zip(q) {
                *q = if fixed[i] { T::lit(0.0) } else { matrix.row_dot(i, p) };
                sum += p[i].to_f64() * q.to_f64();
            }
            sum
        })
    }

    fn turn(&mut self, beta: T) {
        let z = &self.z;
        each_mut(&mut self.p, |range, p| {
            for (p, &z) in p.iter_mut().zip(&z[range]) {
                *p = z + beta * *p;
            }
        });
    }

    /// A step of Richardson's iteration with what the preconditioner made of the last residual. It
    /// costs no product where the residual is not asked for afterwards. A step shorter than two over
    /// the largest eigenvalue makes no error larger; those of multigrid are at most one.
    fn relax(&self, omega: T, x: &mut [T]) {
        each_mut(x, |range, x| {
            x.iter_mut().zip(&self.z[range]).for_each(|(x, &z)| *x += omega * z);
        });
    }

    fn step(&mut self, alpha: T, x: &mut [T], r: &mut [T]) {
        let (p, q) = (&self.p, &self.q);
        sum_mut2(x, r, |range, x, r| {
            let directions = p[range.clone()].iter().zip(&q[range]);
            for ((x, r), (&p, &q)) in x.iter_mut().zip(r).zip(directions) {
                *x += alpha * p;
                *r -= alpha * q;
            }
            0.0
        });
    }
}

/// The inner product in `f64`.
pub(crate) fn dot<T: Real>(x: &[T], y: &mut [T]) -> f64 {
    sum_mut(y, |range, y| {
        let products = x[range].iter().zip(y.iter());
        products.fold(0.0, |sum, (x, y)| sum + x.to_f64() * y.to_f64())
    })
}

/// The coefficients of the Lanczos tridiagonal matrix that the iteration implies.
#[derive(Default)]
struct Lanczos {
    diagonal: Vec<f64>,
    /// Squares of the entries beside the diagonal.
    beside: Vec<f64>,
    last: Option<(f64, f64)>,
}

impl Lanczos {
    fn push(&mut self, alpha: f64, beta: f64) {
        let carried = self.last.map_or(0.0, |(alpha, beta)| beta / alpha);
        if let Some((alpha, beta)) = self.last {
            self.beside.push(beta.max(0.0) / (alpha * alpha));
        }
        self.diagonal.push(1.0 / alpha + carried);
        self.last = Some((alpha, beta));
    }

    /// The smallest and largest eigenvalue, by bisection with the inertia of the shifted matrix.
    fn extremes(&self) -> Option<(f64, f64)> {
        let n = self.diagonal.len();
        if n == 0 {
            return None;
        }
        let reach = |i: usize| {
            let left = if i > 0 { self.beside[i - 1].sqrt() } else { 0.0 };
            let right = if i + 1 < n { self.beside[i].sqrt() } else { 0.0 };
            self.diagonal[i] + left + right
        };
        let largest = (0..n).map(reach).fold(0.0, f64::max);
        let find = |count: usize| {
            let (mut low, mut high) = (0.0, largest);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.below(middle) >= count { high = middle } else { low = middle }
            }
            0.5 * (low + high)
        };
        Some((find(1), find(n)))
    }

    /// How many eigenvalues lie below a number.
    fn below(&self, shift: f64) -> usize {
        let mut count = 0;
        let mut pivot = 1.0;
        for (i, &d) in self.diagonal.iter().enumerate() {
            let carried = if i > 0 { self.beside[i - 1] / pivot } else { 0.0 };
            pivot = d - shift - carried;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Identity;
    impl Preconditioner<f64> for Identity {
        fn apply(&mut self, r: &[f64], z: &mut [f64]) {
            z.copy_from_slice(r);
        }
    }

    #[test]
    fn ritz_values_are_the_eigenvalues_after_as_many_steps_as_unknowns() {
        // second differences: eigenvalues 2 - 2 cos(k pi / 6)
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 5, 8, 11, 13],
            columns: vec![0, 1, 0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4],
            values: vec![2., -1., -1., 2., -1., -1., 2., -1., -1., 2., -1., -1., 2.],
        };
        let mut x = vec![0.0; 5];
        let mut r = vec![1.0, 0.3, -0.2, 0.7, 0.4];
        let b = r.clone();
        let stop = Stop { norm: 1e-13, share: 0.0, iterations: 20 };
        let run = ConjugateGradients::new(&matrix).solve(
            &[false; 5],
            &mut Identity,
            (&mut x, &mut r),
            stop,
        );
        assert_eq!((run.end, run.iterations), (End::Reached, 5));
        let (low, high) = run.ritz.unwrap();
        assert!((low - (2.0 - 3.0_f64.sqrt())).abs() < 1e-10, "{low}");
        assert!((high - (2.0 + 3.0_f64.sqrt())).abs() < 1e-10, "{high}");
        assert!(matrix.residual(&b, &x).iter().all(|r| r.abs() < 1e-13));
    }
}
