//! The numeric kernels of faer's sparse factorisations, for each scalar.
//!
//! These functions are not generic, so they are compiled once, in this crate. Generic ones would be
//! compiled again in every program, test and bench that solves anything.

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu};
use faer::{Conj, MatMut, Par, Side};

/// One thread, always: sums in the same order give the same bits on every machine.
pub(crate) const PAR: Par = Par::Seq;

/// Sparse factorisations over one scalar; implemented for the scalars of this crate and no others.
pub trait SparseKernels: Sized {
    /// The Cholesky factor of a symmetric matrix given by its upper triangle.
    ///
    /// # Errors
    /// A pivot that is not positive.
    #[doc(hidden)]
    fn cholesky(
        symbolic: &SymbolicCholesky<u32>,
        a: SparseColMatRef<'_, u32, Self>,
        values: &mut [Self],
        memory: &mut MemStack,
    ) -> Result<(), LltError>;
    /// Solves with a Cholesky factor.
    #[doc(hidden)]
    fn cholesky_solve(
        symbolic: &SymbolicCholesky<u32>,
        values: &[Self],
        x: MatMut<'_, Self>,
        memory: &mut MemStack,
    );
    /// The factors of any matrix.
    ///
    /// # Errors
    /// A structurally singular matrix, or no memory.
    #[doc(hidden)]
    fn lu(
        symbolic: &SymbolicLu<u32>,
        a: SparseColMatRef<'_, u32, Self>,
        numeric: &mut NumericLu<u32, Self>,
        memory: &mut MemStack,
    ) -> Result<(), LuError>;
    /// Solves with the transpose of a factored matrix.
    #[doc(hidden)]
    fn lu_solve_transpose(
        symbolic: &SymbolicLu<u32>,
        numeric: &NumericLu<u32, Self>,
        x: MatMut<'_, Self>,
        memory: &mut MemStack,
    );
}

macro_rules! kernels {
    ($scalar:ty) => {
        impl SparseKernels for $scalar {
            fn cholesky(
                symbolic: &SymbolicCholesky<u32>,
                a: SparseColMatRef<'_, u32, Self>,
                values: &mut [Self],
                memory: &mut MemStack,
            ) -> Result<(), LltError> {
                let (side, none) = (Side::Upper, LltRegularization::default());
                symbolic
                    .factorize_numeric_llt(values, a, side, none, PAR, memory, Default::default())
                    .map(|_| ())
            }
            fn cholesky_solve(
                symbolic: &SymbolicCholesky<u32>,
                values: &[Self],
                x: MatMut<'_, Self>,
                memory: &mut MemStack,
            ) {
                LltRef::<'_, u32, Self>::new(symbolic, values).solve_in_place_with_conj(
                    Conj::No,
                    x,
                    PAR,
                    memory,
                );
            }
            fn lu(
                symbolic: &SymbolicLu<u32>,
                a: SparseColMatRef<'_, u32, Self>,
                numeric: &mut NumericLu<u32, Self>,
                memory: &mut MemStack,
            ) -> Result<(), LuError> {
                symbolic
                    .factorize_numeric_lu(numeric, a, PAR, memory, Default::default())
                    .map(|_| ())
            }
            fn lu_solve_transpose(
                symbolic: &SymbolicLu<u32>,
                numeric: &NumericLu<u32, Self>,
                x: MatMut<'_, Self>,
                memory: &mut MemStack,
            ) {
                LuRef::<'_, u32, Self>::new_unchecked(symbolic, numeric)
                    .solve_transpose_in_place_with_conj(Conj::No, x, PAR, memory);
            }
        }
    };
}

kernels!(f64);
kernels!(f32);
