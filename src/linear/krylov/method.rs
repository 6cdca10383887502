//! The Krylov method for the linear systems of an inequality.

use std::borrow::Cow;

use super::conjugate_gradients::ConjugateGradients;
use super::gmres::Gmres;
use super::stopping::{KrylovRun, StoppingRule};
use crate::algebra::{Inequality, SparseMatrix};
use crate::linear::precondition::Preconditioner;
use crate::real::Real;

/// The symmetric part of the matrix of an inequality, without a copy if the matrix is symmetric.
pub(crate) fn symmetric_part<T: Real>(inequality: &Inequality<T>) -> Cow<'_, SparseMatrix<T>> {
    match inequality.symmetric {
        true => Cow::Borrowed(&inequality.matrix),
        false => Cow::Owned(inequality.matrix.symmetric_part()),
    }
}

/// A Krylov method for the matrix of an inequality, with symmetric positive definite preconditioners.
pub(crate) enum KrylovMethod<'m, T> {
    /// For symmetric matrices.
    ConjugateGradients(ConjugateGradients<'m, T>),
    /// For all others.
    Gmres(Gmres<'m, T>),
}

impl<'m, T: Real> KrylovMethod<'m, T> {
    /// Conjugate gradients for a symmetric matrix, else GMRES.
    pub fn new(inequality: &'m Inequality<T>) -> Self {
        let (matrix, distribution) = (&inequality.matrix, inequality.distribution());
        match inequality.symmetric {
            true => Self::ConjugateGradients(ConjugateGradients::new(matrix, distribution)),
            false => Self::Gmres(Gmres::new(matrix, distribution)),
        }
    }

    /// Corrects the iterate `(x, r)`, `r` the residual of `x` on free unknowns and zero on fixed ones.
    /// On return `r` is the residual of the new `x` if its norm reached `rule.absolute_tolerance`; else `x` may
    /// contain a last correction that is not yet subtracted from `r`.
    pub fn solve(
        &mut self,
        fixed: &[bool],
        preconditioner: &mut dyn Preconditioner<T>,
        iterate: (&mut [T], &mut [T]),
        rule: StoppingRule,
    ) -> KrylovRun {
        match self {
            Self::ConjugateGradients(method) => method.solve(fixed, preconditioner, iterate, rule),
            Self::Gmres(method) => method.solve(fixed, preconditioner, iterate, rule),
        }
    }
}
