//! Which iteration solves the linear systems of an inequality, and what its preconditioner is of.

pub(crate) mod conjugate_gradients;
pub(crate) mod gmres;

use std::borrow::Cow;

use crate::algebra::{Inequality, SparseMatrix};
use crate::real::Real;
use conjugate_gradients::{ConjugateGradients, Preconditioner, Run, Stop};
use gmres::MinimalResiduals;

/// The symmetric part of the matrix: the matrix itself where it is symmetric.
pub(crate) fn symmetric_part<T: Real>(inequality: &Inequality<T>) -> Cow<'_, SparseMatrix<T>> {
    match inequality.symmetric {
        true => Cow::Borrowed(&inequality.matrix),
        false => Cow::Owned(inequality.matrix.symmetric_part()),
    }
}

/// Iterations for one matrix with one preconditioner, symmetric and positive definite.
pub(crate) enum Krylov<'m, T> {
    /// For symmetric matrices.
    ConjugateGradients(ConjugateGradients<'m, T>),
    /// For all others.
    MinimalResiduals(&'m SparseMatrix<T>, MinimalResiduals<T>),
}

impl<'m, T: Real> Krylov<'m, T> {
    /// What fits the matrix.
    pub fn new(inequality: &'m Inequality<T>) -> Self {
        let matrix = &inequality.matrix;
        match inequality.symmetric {
            true => Self::ConjugateGradients(ConjugateGradients::new(matrix)),
            false => Self::MinimalResiduals(matrix, MinimalResiduals::new(matrix.size())),
        }
    }

    /// Corrects `x`, whose residual is `r` where free and zero where fixed. `r` becomes the residual of
    /// the new `x` if the norm fell to that of `stop`; else it may lack the last correction.
    pub fn solve(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        iterate: (&mut [T], &mut [T]),
        stop: Stop,
    ) -> Run {
        match self {
            Self::ConjugateGradients(method) => method.solve(fixed, preconditioner, iterate, stop),
            Self::MinimalResiduals(matrix, method) => {
                method.solve(matrix, fixed, preconditioner, iterate, stop)
            }
        }
    }
}
