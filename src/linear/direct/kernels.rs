//! The numeric kernels of faer's sparse factorisations.

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{LdltRef, LltRef, SymbolicCholesky};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu};
use faer::{Conj, MatMut, Par, Side};

use crate::real::Real;

/// One thread, always: sums in the same order give the same bits on every machine.
pub(crate) const PAR: Par = Par::Seq;

/// Sets `values` to the Cholesky factor of a symmetric matrix, given by its upper triangle.
///
/// # Errors
/// A pivot is not positive.
pub(crate) fn cholesky<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    a: SparseColMatRef<'_, u32, T>,
    values: &mut [T],
    memory: &mut MemStack,
) -> Result<(), LltError> {
    let (side, none) = (Side::Upper, LltRegularization::default());
    symbolic
        .factorize_numeric_llt(values, a, side, none, PAR, memory, Default::default())
        .map(|_| ())
}

/// Replaces the right-hand sides `x` by solutions, with a Cholesky factor.
pub(crate) fn cholesky_solve<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    values: &[T],
    x: MatMut<'_, T>,
    memory: &mut MemStack,
) {
    let factor = LltRef::<'_, u32, T>::new(symbolic, values);
    factor.solve_in_place_with_conj(Conj::No, x, PAR, memory);
}

/// Sets `values` to the factors `L D L^T` of a quasidefinite matrix, given by its upper triangle.
///
/// # Errors
/// A pivot is zero or not finite.
pub(crate) fn quasidefinite<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    a: SparseColMatRef<'_, u32, T>,
    values: &mut [T],
    memory: &mut MemStack,
) -> Result<(), LdltError> {
    let (side, none) = (Side::Upper, LdltRegularization::default());
    symbolic
        .factorize_numeric_ldlt(values, a, side, none, PAR, memory, Default::default())
        .map(|_| ())
}

/// Replaces the right-hand sides `x` by solutions, with the factors of a quasidefinite matrix.
pub(crate) fn quasidefinite_solve<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    values: &[T],
    x: MatMut<'_, T>,
    memory: &mut MemStack,
) {
    let factor = LdltRef::<'_, u32, T>::new(symbolic, values);
    factor.solve_in_place_with_conj(Conj::No, x, PAR, memory);
}

/// Computes the LU factors of any matrix.
///
/// # Errors
/// The matrix is structurally singular, or the factors do not fit into memory.
pub(crate) fn lu<T: Real>(
    symbolic: &SymbolicLu<u32>,
    a: SparseColMatRef<'_, u32, T>,
    numeric: &mut NumericLu<u32, T>,
    memory: &mut MemStack,
) -> Result<(), LuError> {
    symbolic.factorize_numeric_lu(numeric, a, PAR, memory, Default::default()).map(|_| ())
}

/// Replaces the right-hand sides `x` by solutions for the transpose of the factored matrix.
pub(crate) fn lu_solve_transpose<T: Real>(
    symbolic: &SymbolicLu<u32>,
    numeric: &NumericLu<u32, T>,
    x: MatMut<'_, T>,
    memory: &mut MemStack,
) {
    let factors = LuRef::<'_, u32, T>::new_unchecked(symbolic, numeric);
    factors.solve_transpose_in_place_with_conj(Conj::No, x, PAR, memory);
}
