//! Sparse Cholesky and LU factors of a submatrix.

use std::sync::Arc;

use faer::MatMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltError;
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{
    SymbolicCholesky, SymbolicCholeskyRaw, supernodal::SupernodalLltRef,
};
use faer::sparse::linalg::lu::{LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};

use super::elimination_order::EliminationOrder;
use super::error::{FactorError, out_of_memory};
use super::kernels::{self, PAR};
use super::symbolic_factor::{SymbolicFactor, transpose_view};
use crate::algebra::{SparseMatrix, Submatrix};
use crate::instances::compiled;
use crate::memory::in_large_pages;
use crate::parallel::vectors::pseudorandom_signs;
use crate::real::Real;

/// A pivot counts as zero if it is at most this multiple of machine epsilon times the diagonal
/// entry of the matrix: cancellation has then left no correct digit.
const PIVOT_TOLERANCE: f64 = 16.0;

/// The factors of a submatrix `A_II`, `I` the set of free unknowns.
///
/// For a symmetric matrix these are the sparse Cholesky factors for an [`EliminationOrder`] or for
/// approximate minimum degree, supernodal where that is faster. For other matrices they are the sparse
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
    Quasidefinite { symbolic: Arc<SymbolicCholesky<u32>>, values: Vec<T> },
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
        if symmetric {
            let mut lower = Submatrix::lower_triangle(matrix, free);
            let symbolic = SymbolicFactor::new(&lower, None)?;
            Self::cholesky(&mut lower, &symbolic)
        } else {
            Self::lu(&Submatrix::new(matrix, free))
        }
    }

    /// The Cholesky factor of the rows and columns `free` (ascending) of a symmetric matrix, in the
    /// restriction of an order of elimination to `free`. Unknowns of `free` that are not in the order come
    /// last.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn in_order(
        matrix: &SparseMatrix<T>,
        free: &[u32],
        order: &EliminationOrder,
    ) -> Result<Self, FactorError> {
        compiled!(
            T: fn(&SparseMatrix<T>, &[u32], &EliminationOrder) -> Result<Factors<T>, FactorError>
                = Factors::factor_in_order
        )(matrix, free, order)
    }

    fn factor_in_order(
        matrix: &SparseMatrix<T>,
        free: &[u32],
        order: &EliminationOrder,
    ) -> Result<Self, FactorError> {
        let mut lower = Submatrix::lower_triangle(matrix, free);
        let order = order.restricted_to(free, matrix.size());
        let symbolic = SymbolicFactor::new(&lower, Some(order))?;
        Self::cholesky(&mut lower, &symbolic)
    }

    /// The Cholesky factor of a symmetric matrix, given by its lower triangle and the symbolic factor
    /// of its pattern. After an error the diagonal of `lower` may have been changed.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub(crate) fn cholesky(
        lower: &mut Submatrix<T>,
        symbolic: &SymbolicFactor,
    ) -> Result<Self, FactorError> {
        if lower.size() == 0 {
            return Ok(Self { size: 0, factorisation: Factorisation::Empty });
        }
        Self::try_cholesky(lower, symbolic).map_err(|error| match error {
            FactorError::NotPositive => indefinite_or_singular(lower, symbolic),
            other => other,
        })
    }

    /// Number of stored entries of a Cholesky factor, zeros inside supernodes included; zero for LU
    /// factors.
    pub fn entries(&self) -> usize {
        match &self.factorisation {
            Factorisation::Cholesky { values, .. }
            | Factorisation::Quasidefinite { values, .. } => values.len(),
            Factorisation::Empty | Factorisation::Lu { .. } => 0,
        }
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
        compiled!(T: fn(&Factors<T>, &mut [T], usize) = Factors::substitute)(self, x, right_sides)
    }

    fn substitute(&self, x: &mut [T], right_sides: usize) {
        if x.is_empty() {
            return;
        }
        let x = MatMut::from_column_major_slice_mut(x, self.size, right_sides);
        match &self.factorisation {
            Factorisation::Empty => {}
            Factorisation::Cholesky { symbolic, values } => {
                let scratch = symbolic.solve_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                kernels::cholesky_solve(symbolic, values, x, MemStack::new(&mut memory));
            }
            Factorisation::Quasidefinite { symbolic, values } => {
                let scratch = symbolic.solve_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                kernels::quasidefinite_solve(symbolic, values, x, MemStack::new(&mut memory));
            }
            Factorisation::Lu { symbolic, numeric } => {
                let scratch = symbolic.solve_transpose_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                kernels::lu_solve_transpose(symbolic, numeric, x, MemStack::new(&mut memory));
            }
        }
    }

    /// The Cholesky factor of a matrix that is not empty, given by its lower triangle.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a pivot is not positive, also for a singular matrix; else
    /// [`FactorError::Singular`] if a pivot has no significant digit; or [`FactorError::OutOfMemory`].
    fn try_cholesky(lower: &Submatrix<T>, symbolic: &SymbolicFactor) -> Result<Self, FactorError> {
        let (a, symbolic) = (transpose_view(lower), symbolic.symbolic_cholesky());
        let mut values = zero_values(&symbolic)?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        kernels::cholesky(&symbolic, a, &mut values, MemStack::new(&mut memory))
            .map_err(|LltError::NonPositivePivot { .. }| FactorError::NotPositive)?;
        if pivots_are_significant(&symbolic, &values, &lower.diagonal()) {
            let factorisation = Factorisation::Cholesky { symbolic, values };
            Ok(Self { size: lower.size(), factorisation })
        } else {
            Err(FactorError::Singular)
        }
    }

    /// The factors `L D L^T` of a quasidefinite matrix, given by its lower triangle and the symbolic
    /// factor of its pattern, without pivoting: the pivots of the first `n_positive` rows are positive, those of the
    /// others negative (R. J. Vanderbei, SIAM J. Optim. 5 (1995), 100-113).
    ///
    /// # Errors
    /// [`FactorError::Singular`] if a pivot has the wrong sign or is not finite, or if a positive pivot has no
    /// significant digit; [`FactorError::OutOfMemory`].
    pub(crate) fn quasidefinite(
        lower: &Submatrix<T>,
        n_positive: usize,
        symbolic: &SymbolicFactor,
    ) -> Result<Self, FactorError> {
        if lower.size() == 0 {
            return Ok(Self { size: 0, factorisation: Factorisation::Empty });
        }
        let (a, symbolic) = (transpose_view(lower), symbolic.symbolic_cholesky());
        let mut values = zero_values(&symbolic)?;
        let scratch = symbolic.factorize_numeric_ldlt_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        kernels::quasidefinite(&symbolic, a, &mut values, MemStack::new(&mut memory))
            .map_err(|LdltError::ZeroPivot { .. }| FactorError::Singular)?;
        let diagonal = lower.diagonal();
        let is_significant = |i: usize, pivot: f64| {
            let least = PIVOT_TOLERANCE * T::EPSILON * diagonal[i].to_f64();
            pivot.is_finite() && if i < n_positive { pivot > least } else { pivot < 0.0 }
        };
        if all_pivots(&symbolic, &values, |i, pivot| is_significant(i, pivot.to_f64())) {
            let factorisation = Factorisation::Quasidefinite { symbolic, values };
            Ok(Self { size: lower.size(), factorisation })
        } else {
            Err(FactorError::Singular)
        }
    }

    /// The LU factors of a matrix.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub(crate) fn lu(matrix: &Submatrix<T>) -> Result<Self, FactorError> {
        if matrix.size() == 0 {
            return Ok(Self { size: 0, factorisation: Factorisation::Empty });
        }
        let a = transpose_view(matrix);
        let symbolic = factorize_symbolic_lu(a.symbolic(), LuSymbolicParams::default())
            .map_err(out_of_memory)?;
        let mut numeric = NumericLu::new();
        let scratch = symbolic.factorize_numeric_lu_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        kernels::lu(&symbolic, a, &mut numeric, MemStack::new(&mut memory)).map_err(|error| {
            match error {
                LuError::SymbolicSingular { .. } => FactorError::Singular,
                LuError::Generic(error) => out_of_memory(error),
            }
        })?;
        let factorisation =
            Factorisation::Lu { symbolic: Box::new(symbolic), numeric: Box::new(numeric) };
        let factors = Self { size: matrix.size(), factorisation };
        if factors.is_regular(matrix) { Ok(factors) } else { Err(FactorError::Singular) }
    }

    /// Whether the matrix, its rows scaled to norm one, is regular to working precision: whether the
    /// solution for a right-hand side of pseudorandom signs is smaller than the reciprocal of
    /// [`PIVOT_TOLERANCE`] times machine epsilon.
    ///
    /// Partial pivoting succeeds on singular matrices too. The norm of the solution is a lower bound of
    /// the condition number, so that no regular matrix is rejected, and close to the condition number
    /// for a right-hand side with a component in the direction of the smallest singular value.
    fn is_regular(&self, matrix: &Submatrix<T>) -> bool {
        let mut x: Vec<T> = (0..self.size)
            .zip(pseudorandom_signs())
            .map(|(i, is_positive)| {
                let norm: f64 = matrix.row(i).1.iter().map(|a| a.to_f64().abs()).sum();
                T::lit(if is_positive { norm } else { -norm })
            })
            .collect();
        self.solve_in_place(&mut x, 1);
        // The comparison is false for numbers that are not finite.
        x.iter().all(|x| x.to_f64().abs() * PIVOT_TOLERANCE * T::EPSILON < 1.0)
    }
}

/// Zeros for the values of a factor.
///
/// # Errors
/// [`FactorError::OutOfMemory`].
fn zero_values<T: Real>(symbolic: &SymbolicCholesky<u32>) -> Result<Vec<T>, FactorError> {
    let mut values = Vec::new();
    values.try_reserve_exact(symbolic.len_val()).map_err(|_| FactorError::OutOfMemory)?;
    let mut values = in_large_pages(values);
    values.resize(symbolic.len_val(), T::lit(0.0));
    Ok(values)
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
    lower: &mut Submatrix<T>,
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

/// Whether every pivot, the square of a diagonal entry of the factor, is significant: larger than
/// [`PIVOT_TOLERANCE`] times machine epsilon times the corresponding entry of `diagonal`, the
/// diagonal of the matrix.
fn pivots_are_significant<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    values: &[T],
    diagonal: &[T],
) -> bool {
    all_pivots(symbolic, values, |i, root| {
        let (a, root) = (diagonal[i].to_f64(), root.to_f64());
        // The comparison is false for numbers that are not finite.
        root.is_finite() && root * root > PIVOT_TOLERANCE * T::EPSILON * a
    })
}

/// Whether a condition holds for every row of a matrix and the diagonal entry of its factor.
fn all_pivots<T: Real>(
    symbolic: &SymbolicCholesky<u32>,
    values: &[T],
    condition: impl Fn(usize, T) -> bool,
) -> bool {
    let original = symbolic.perm().map(|permutation| permutation.arrays().0);
    let holds = |j: usize, pivot: T| condition(original.map_or(j, |rows| rows[j] as usize), pivot);
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(simplicial) => {
            let starts = &simplicial.col_ptr()[..simplicial.ncols()];
            starts.iter().enumerate().all(|(j, &start)| holds(j, values[start as usize]))
        }
        SymbolicCholeskyRaw::Supernodal(supernodal) => {
            // factors `L D L^T` are stored alike, with `D` on the diagonal
            let factor = SupernodalLltRef::<'_, u32, T>::new(supernodal, values);
            (0..supernodal.n_supernodes()).all(|s| {
                let supernode = factor.supernode(s);
                let block = supernode.val();
                (0..block.ncols()).all(|k| holds(supernode.start() + k, block[(k, k)]))
            })
        }
    }
}
