//! Sparse Cholesky and LU factors of a submatrix.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky};
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::{Conj, MatMut, Par, Side};

use super::error::{FactorError, out_of_memory};
use super::symbolic_factor::{SymbolicFactor, symbolic_factor, transpose_view};
use crate::algebra::SparseMatrix;
use crate::instances::compiled;
use crate::memory::in_large_pages;
use crate::parallel::vectors::pseudorandom_signs;
use crate::real::Real;

/// One thread, always: sums in the same order give the same bits on every machine.
const PAR: Par = Par::Seq;

/// A matrix counts as singular if its condition number is at least the reciprocal of this multiple of machine epsilon.
const SINGULAR: f64 = 16.0;

/// The factors of a submatrix `A_II`, `I` the set of free unknowns.
///
/// For a symmetric matrix these are the sparse Cholesky factors in the order of approximate minimum
/// degree, supernodal where that is faster. For other matrices they are the sparse
/// LU factors of the transpose with partial pivoting; the rows of a matrix are the columns of its
/// transpose, so that a row-dominant matrix needs no exchanges.
#[derive(Debug)]
pub struct Factors<T> {
    size: usize,
    factorisation: Factorisation<T>,
}

#[derive(Debug)]
enum Factorisation<T> {
    Empty,
    Cholesky { symbolic: Arc<SymbolicCholesky<u32>>, values: Vec<T> },
    Lu { symbolic: Box<SymbolicLu<u32>>, numeric: Box<NumericLu<u32, T>> },
}

impl<T: Real> Factors<T> {
    /// The factors of the rows and columns `free` (ascending) of a matrix. Only the lower triangle of
    /// a symmetric matrix is read.
    ///
    /// # Errors
    /// See [`FactorError`]; a matrix with an entry that is not finite always gives one of these errors.
    pub fn new(
        matrix: &SparseMatrix<T>,
        symmetric: bool,
        free: &[u32],
    ) -> Result<Self, FactorError> {
        compiled!(
            T: fn(&SparseMatrix<T>, bool, &[u32]) -> Result<Factors<T>, FactorError>
                = Factors::factor
        )(matrix, symmetric, free)
    }

    fn factor(
        matrix: &SparseMatrix<T>,
        symmetric: bool,
        free: &[u32],
    ) -> Result<Self, FactorError> {
        if !symmetric {
            return Self::lu(&matrix.submatrix(free));
        }
        let mut lower = matrix.lower_triangle(free);
        let symbolic = symbolic_factor(&lower)?;
        Self::cholesky(&mut lower, &symbolic)
    }

    /// The Cholesky factor of a symmetric matrix, given by its lower triangle and the symbolic factor
    /// of its pattern. After an error the diagonal of `lower` may have been changed.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub(super) fn cholesky(
        lower: &mut SparseMatrix<T>,
        symbolic: &SymbolicFactor,
    ) -> Result<Self, FactorError> {
        if lower.size() == 0 {
            return Ok(Self { size: 0, factorisation: Factorisation::Empty });
        }
        let factors = Self::try_cholesky(lower, symbolic);
        factors.and_then(|factors| factors.if_regular(&row_norms(lower, true))).map_err(|error| {
            match error {
                FactorError::NotPositive => indefinite_or_singular(lower, symbolic),
                other => other,
            }
        })
    }

    /// The Cholesky factor of a symmetric matrix that is not empty and belongs to a preconditioner: whether it is regular
    /// to working precision is not tested.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a pivot is not positive; [`FactorError::OutOfMemory`].
    pub(crate) fn of_block(matrix: &SparseMatrix<T>) -> Result<Self, FactorError> {
        let all: Vec<u32> = (0..matrix.size() as u32).collect();
        let lower = matrix.lower_triangle(&all);
        Self::try_cholesky(&lower, &symbolic_factor(&lower)?)
    }

    /// Number of unknowns of the factored submatrix.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Replaces right-hand sides by solutions; `x` contains `right_sides` vectors of
    /// [`Factors::size`] entries each, one after the other.
    ///
    /// # Panics
    /// If `x` is not empty and has another length.
    pub fn solve_in_place(&self, x: &mut [T], right_sides: usize) {
        if x.is_empty() {
            return;
        }
        let x = MatMut::from_column_major_slice_mut(x, self.size, right_sides);
        match &self.factorisation {
            Factorisation::Empty => {}
            Factorisation::Cholesky { symbolic, values } => {
                let scratch = symbolic.solve_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                let stack = MemStack::new(&mut memory);
                LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, x, PAR, stack);
            }
            Factorisation::Lu { symbolic, numeric } => {
                let scratch = symbolic.solve_transpose_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                let (stack, factors) =
                    (MemStack::new(&mut memory), LuRef::new_unchecked(symbolic, numeric));
                factors.solve_transpose_in_place_with_conj(Conj::No, x, PAR, stack);
            }
        }
    }

    /// The Cholesky factor of a matrix that is not empty, given by its lower triangle.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a pivot is not positive, also for a singular matrix;
    /// [`FactorError::OutOfMemory`].
    fn try_cholesky(
        lower: &SparseMatrix<T>,
        symbolic: &SymbolicFactor,
    ) -> Result<Self, FactorError> {
        let (a, symbolic) = (transpose_view(lower), symbolic.clone());
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|_| FactorError::OutOfMemory)?;
        values = in_large_pages(values);
        values.resize(symbolic.len_val(), T::lit(0.0));
        let scratch = symbolic.factorize_numeric_llt_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        let (stack, none) = (MemStack::new(&mut memory), LltRegularization::default());
        symbolic
            .factorize_numeric_llt(
                &mut values,
                a,
                Side::Upper,
                none,
                PAR,
                stack,
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { .. }| FactorError::NotPositive)?;
        let factorisation = Factorisation::Cholesky { symbolic, values };
        Ok(Self { size: lower.size(), factorisation })
    }

    /// The LU factors of a matrix.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub(super) fn lu(matrix: &SparseMatrix<T>) -> Result<Self, FactorError> {
        if matrix.size() == 0 {
            return Ok(Self { size: 0, factorisation: Factorisation::Empty });
        }
        let a = transpose_view(matrix);
        let symbolic = factorize_symbolic_lu(a.symbolic(), LuSymbolicParams::default())
            .map_err(out_of_memory)?;
        let mut numeric = NumericLu::new();
        let scratch = symbolic.factorize_numeric_lu_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        let stack = MemStack::new(&mut memory);
        symbolic.factorize_numeric_lu(&mut numeric, a, PAR, stack, Default::default()).map_err(
            |error| match error {
                LuError::SymbolicSingular { .. } => FactorError::Singular,
                LuError::Generic(error) => out_of_memory(error),
            },
        )?;
        let factorisation =
            Factorisation::Lu { symbolic: Box::new(symbolic), numeric: Box::new(numeric) };
        Self { size: matrix.size(), factorisation }.if_regular(&row_norms(matrix, false))
    }

    /// The factors if their matrix, its rows scaled to norm one, is regular to working precision: if the
    /// solution for a right-hand side of pseudorandom signs is smaller than the reciprocal of
    /// [`SINGULAR`] times machine epsilon.
    ///
    /// Rounding gives singular matrices factors too. The norm of the solution is a lower bound of
    /// the condition number, so that no regular matrix is rejected, and close to the condition number
    /// for a right-hand side with a component in the direction of the smallest singular value.
    ///
    /// # Errors
    /// [`FactorError::Singular`].
    fn if_regular(self, row_norms: &[f64]) -> Result<Self, FactorError> {
        let signs = row_norms.iter().zip(pseudorandom_signs());
        let mut x: Vec<T> = signs
            .map(|(norm, is_positive)| T::lit(if is_positive { *norm } else { -norm }))
            .collect();
        self.solve_in_place(&mut x, 1);
        // The comparison is false for numbers that are not finite.
        let is_regular = x.iter().all(|x| x.to_f64().abs() * SINGULAR * T::EPSILON < 1.0);
        if is_regular { Ok(self) } else { Err(FactorError::Singular) }
    }
}

/// Adds a nonnegative diagonal, given by its entries for all unknowns or empty for zero, to the submatrix of the unknowns
/// `free` or to the lower triangle of that submatrix.
///
/// # Errors
/// [`FactorError::NotPositive`] if a row to which a positive number is added stores no diagonal entry.
pub(super) fn add_to_diagonal<T: Real>(
    submatrix: &mut SparseMatrix<T>,
    free: &[u32],
    diagonal: &[f64],
) -> Result<(), FactorError> {
    for (k, &i) in free.iter().enumerate() {
        let Some(&entry) = diagonal.get(i as usize).filter(|&&entry| entry > 0.0) else { continue };
        let (columns, values) = submatrix.row_mut(k);
        let position = columns.binary_search(&(k as u32)).map_err(|_| FactorError::NotPositive)?;
        values[position] += T::lit(entry);
    }
    Ok(())
}

/// The sum of the absolute values of each row of a matrix, of which only the lower triangle is given if it is symmetric.
fn row_norms<T: Real>(matrix: &SparseMatrix<T>, symmetric: bool) -> Vec<f64> {
    let mut norms = vec![0.0; matrix.size()];
    for i in 0..matrix.size() {
        let (columns, values) = matrix.row(i);
        for (&j, a) in columns.iter().zip(values) {
            norms[i] += a.to_f64().abs();
            if symmetric && j as usize != i {
                norms[j as usize] += a.to_f64().abs();
            }
        }
    }
    norms
}

/// Whether a matrix is positive definite on the unknowns `free` (ascending): whether its symmetric
/// part has a Cholesky factor. The matrix of a bilinear form is positive definite if the form is
/// coercive.
///
/// # Errors
/// [`FactorError::OutOfMemory`].
pub fn is_positive_definite<T: Real>(
    matrix: &SparseMatrix<T>,
    symmetric: bool,
    free: &[u32],
) -> Result<bool, FactorError> {
    compiled!(
        T: fn(&SparseMatrix<T>, bool, &[u32]) -> Result<bool, FactorError>
            = has_cholesky_factor
    )(matrix, symmetric, free)
}

fn has_cholesky_factor<T: Real>(
    matrix: &SparseMatrix<T>,
    symmetric: bool,
    free: &[u32],
) -> Result<bool, FactorError> {
    let part = (!symmetric).then(|| matrix.symmetric_part());
    match Factors::new(part.as_ref().unwrap_or(matrix), true, free) {
        Ok(_) => Ok(true),
        Err(FactorError::OutOfMemory) => Err(FactorError::OutOfMemory),
        Err(_) => Ok(false),
    }
}

/// The error for a matrix with a pivot that is not positive: [`FactorError::Singular`] if the matrix without its zero
/// rows (those whose stored entries, one on the diagonal among them, are zero) is positive definite with its diagonal
/// multiplied by `1 + sqrt(eps)`, `eps` machine epsilon, else [`FactorError::NotPositive`] or
/// [`FactorError::OutOfMemory`]. Changes the diagonal of `lower`. The increase is large compared with rounding errors
/// and small compared with the negative eigenvalues that a matrix has if a penalty is too small.
fn indefinite_or_singular<T: Real>(
    lower: &mut SparseMatrix<T>,
    symbolic: &SymbolicFactor,
) -> FactorError {
    let mut is_zero = vec![false; lower.size()];
    for i in 0..lower.size() {
        let (columns, values) = lower.row_mut(i);
        let is_stored = columns.last().is_some_and(|&j| j as usize == i);
        match values.last_mut() {
            Some(a) if is_stored && a.to_f64() > 0.0 => *a *= T::lit(1.0 + T::EPSILON.sqrt()),
            // no relative increase makes zero positive; the matrix is singular if row and column are zero too
            Some(a) if is_stored && a.to_f64() == 0.0 => {
                *a = T::lit(1.0);
                is_zero[i] = true;
            }
            _ => return FactorError::NotPositive,
        }
    }
    for i in 0..lower.size() {
        let (columns, values) = lower.row_mut(i);
        let entries = columns.iter().zip(values.iter());
        let mut entries = entries.filter(|(j, a)| **j as usize != i && a.to_f64() != 0.0);
        if entries.any(|(&j, _)| is_zero[i] || is_zero[j as usize]) {
            return FactorError::NotPositive;
        }
    }
    match Factors::try_cholesky(lower, symbolic) {
        Ok(_) => FactorError::Singular,
        Err(error) => error,
    }
}
