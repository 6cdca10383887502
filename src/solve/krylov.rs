//! Which iteration solves the linear systems of an inequality, and what its preconditioner is of.

use std::borrow::Cow;

use super::conjugate_gradients::{ConjugateGradients, Preconditioner, Run, Stop};
use super::gmres::MinimalResiduals;
use crate::algebra::{Inequality, SparseMatrix};
use crate::real::Real;

/// The symmetric part of the matrix: the matrix itself where it is symmetric.
pub(super) fn symmetric_part<T: Real>(inequality: &Inequality<T>) -> Cow<'_, SparseMatrix<T>> {
    match inequality.symmetric {
        true => Cow::Borrowed(&inequality.matrix),
        false => Cow::Owned(inequality.matrix.symmetric_part()),
    }
}

/// Iterations with one preconditioner, symmetric and positive definite.
pub(super) enum Krylov<T> {
    /// For symmetric matrices.
    ConjugateGradients(ConjugateGradients<T>),
    /// For all others.
    MinimalResiduals(MinimalResiduals<T>),
}

impl<T: Real> Krylov<T> {
    /// What fits the matrix.
    pub fn new(inequality: &Inequality<T>) -> Self {
        let n = inequality.size();
        match inequality.symmetric {
            true => Self::ConjugateGradients(ConjugateGradients::new(n)),
            false => Self::MinimalResiduals(MinimalResiduals::new(n)),
        }
    }

    /// Corrects `x`, whose residual is `r` where free and zero where fixed; `r` is kept up to date.
    pub fn solve(
        &mut self,
        matrix: &SparseMatrix<T>,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        iterate: (&mut [T], &mut [T]),
        stop: Stop,
    ) -> Run {
        match self {
            Self::ConjugateGradients(method) => {
                method.solve(matrix, fixed, preconditioner, iterate, stop)
            }
            Self::MinimalResiduals(method) => {
                method.solve(matrix, fixed, preconditioner, iterate, stop)
            }
        }
    }
}
