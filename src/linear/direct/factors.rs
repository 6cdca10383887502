//! Direct solvers of linear systems. This file and [`kernels`](crate::linear::direct::kernels) alone name the
//! factorisations of faer, [`elimination`](crate::linear::direct::elimination) its orders.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::Perm;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::sparse::linalg::lu::{LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{FaerError, SparseColMatRef};
use faer::{MatMut, Side};

use super::elimination::EliminationOrder;
use super::kernels::{self, PAR};
use crate::algebra::SparseMatrix;
use crate::algebra::submatrix::Submatrix;
use crate::instances::compiled;
use crate::parallel::vectors::signs;
use crate::real::Real;

/// A pivot below this many units of rounding of the diagonal entry it came from has lost every
/// digit to cancellation: the matrix is singular as far as this scalar can tell.
const LOST_PIVOT: f64 = 16.0;

/// Why a matrix could not be factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// A direction of negative curvature: the symmetric matrix is indefinite.
    #[error("the matrix is not positive definite")]
    NotPositive,
    /// Singular to working precision. A symmetric matrix that is positive semidefinite up to
    /// rounding (a body that nothing holds) is singular, not indefinite.
    #[error("the matrix is singular to working precision")]
    Singular,
    /// The factors do not fit into memory or into the index type.
    #[error("the factors do not fit into memory")]
    OutOfMemory,
}

impl From<FaerError> for FactorError {
    fn from(_: FaerError) -> Self {
        // Index overflow and memory are all that faer's own errors tell apart.
        FactorError::OutOfMemory
    }
}

/// The factors of a matrix restricted to some of its rows and columns.
///
/// Symmetric: sparse Cholesky in an [`EliminationOrder`] or that of approximate minimum degree,
/// supernodal where that pays.
/// Otherwise: sparse LU with partial pivoting of the transpose, which is what rows are to a
/// factorisation by columns; a matrix dominant by rows is then eliminated without exchanges.
#[derive(Debug)]
pub struct Factors<T> {
    size: usize,
    kind: Kind<T>,
}

#[derive(Debug)]
enum Kind<T> {
    Empty,
    Cholesky { symbolic: Arc<SymbolicCholesky<u32>>, values: Vec<T> },
    Lu { symbolic: Box<SymbolicLu<u32>>, numeric: Box<NumericLu<u32, T>> },
}

/// Where the entries of the Cholesky factor of a pattern are.
#[derive(Clone, Debug)]
pub(crate) struct Analysis(Arc<SymbolicCholesky<u32>>);

impl Analysis {
    /// Of the entries on and left of the diagonal, for an order of elimination; without one, by
    /// approximate minimum degree.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    pub fn new<T: Real>(
        restricted: &Submatrix<T>,
        order: Option<Vec<u32>>,
    ) -> Result<Self, FactorError> {
        let order = order.map(|order| {
            let mut inverse = vec![0; order.len()];
            order.iter().enumerate().for_each(|(k, &i)| inverse[i as usize] = k as u32);
            Perm::new_checked(order.into(), inverse.into(), restricted.size())
        });
        let ordering = match &order {
            Some(order) => SymmetricOrdering::Custom(order.as_ref()),
            None => SymmetricOrdering::Amd,
        };
        // Row i on and left of the diagonal is column i on and above it.
        let pattern = columns(restricted);
        let params = CholeskySymbolicParams::default();
        let symbolic =
            factorize_symbolic_cholesky(pattern.symbolic(), Side::Upper, ordering, params)?;
        Ok(Self(Arc::new(symbolic)))
    }
}

impl<T: Real> Factors<T> {
    /// Factors the rows and columns `free` (ascending) of a matrix.
    ///
    /// Of a symmetric matrix only the entries on and left of the diagonal are read.
    ///
    /// # Errors
    /// See [`FactorError`]. Numbers that are not finite end as one of them too.
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
            let mut restricted = Submatrix::left_of_diagonal(matrix, free);
            let analysis = Analysis::new(&restricted, None)?;
            Self::definite(&mut restricted, &analysis)
        } else {
            Self::lu(&Submatrix::new(matrix, free))
        }
    }

    /// Factors the rows and columns `free` (ascending) of a symmetric matrix, whose unknowns are
    /// eliminated in an order that is known. Unknowns of the order that are not free, or that the
    /// matrix does not have, are passed over; free ones that the order does not have come last.
    ///
    /// # Errors
    /// See [`Factors::new`].
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
        let mut restricted = Submatrix::left_of_diagonal(matrix, free);
        let analysis = Analysis::new(&restricted, Some(order.among(free, matrix.size())))?;
        Self::definite(&mut restricted, &analysis)
    }

    /// Factors a symmetric matrix of which the entries on and left of the diagonal are given, with
    /// the pattern that was analysed.
    ///
    /// # Errors
    /// See [`Factors::new`].
    pub(crate) fn definite(
        restricted: &mut Submatrix<T>,
        analysis: &Analysis,
    ) -> Result<Self, FactorError> {
        if restricted.size() == 0 {
            return Ok(Self { size: 0, kind: Kind::Empty });
        }
        Self::cholesky(restricted, analysis).map_err(|error| match error {
            FactorError::NotPositive => why_not_positive(restricted, analysis),
            other => other,
        })
    }

    /// How many numbers of a Cholesky factor are stored, zeros inside blocks among them.
    pub fn entries(&self) -> usize {
        match &self.kind {
            Kind::Cholesky { values, .. } => values.len(),
            Kind::Empty | Kind::Lu { .. } => 0,
        }
    }

    /// Number of unknowns of the factored matrix.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Solves for `right_sides` right-hand sides at once, stored one after the other.
    ///
    /// # Panics
    /// If `x` does not hold that many vectors of [`Factors::size`] numbers.
    pub fn solve_in_place(&self, x: &mut [T], right_sides: usize) {
        compiled!(T: fn(&Factors<T>, &mut [T], usize) = Factors::substitute)(self, x, right_sides)
    }
    fn substitute(&self, x: &mut [T], right_sides: usize) {
        if x.is_empty() {
            return;
        }
        let x = MatMut::from_column_major_slice_mut(x, self.size, right_sides);
        match &self.kind {
            Kind::Empty => {}
            Kind::Cholesky { symbolic, values } => {
                let scratch = symbolic.solve_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                kernels::cholesky_solve(symbolic, values, x, MemStack::new(&mut memory));
            }
            Kind::Lu { symbolic, numeric } => {
                let scratch = symbolic.solve_transpose_in_place_scratch::<T>(right_sides, PAR);
                let mut memory = MemBuffer::new(scratch);
                kernels::lu_solve_transpose(symbolic, numeric, x, MemStack::new(&mut memory));
            }
        }
    }

    fn cholesky(restricted: &Submatrix<T>, analysis: &Analysis) -> Result<Self, FactorError> {
        let (a, symbolic) = (columns(restricted), analysis.0.clone());
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|_| FactorError::OutOfMemory)?;
        values.resize(symbolic.len_val(), T::lit(0.0));
        let scratch = symbolic.factorize_numeric_llt_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        kernels::cholesky(&symbolic, a, &mut values, MemStack::new(&mut memory))
            .map_err(|LltError::NonPositivePivot { .. }| FactorError::NotPositive)?;
        if pivots_hold(&symbolic, &values, &restricted.diagonal()) {
            Ok(Self { size: restricted.size(), kind: Kind::Cholesky { symbolic, values } })
        } else {
            Err(FactorError::Singular)
        }
    }

    /// Factors any matrix.
    ///
    /// # Errors
    /// See [`Factors::new`].
    pub(crate) fn lu(restricted: &Submatrix<T>) -> Result<Self, FactorError> {
        if restricted.size() == 0 {
            return Ok(Self { size: 0, kind: Kind::Empty });
        }
        let a = columns(restricted);
        let symbolic = factorize_symbolic_lu(a.symbolic(), LuSymbolicParams::default())?;
        let mut numeric = NumericLu::new();
        let scratch = symbolic.factorize_numeric_lu_scratch::<T>(PAR, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        kernels::lu(&symbolic, a, &mut numeric, MemStack::new(&mut memory)).map_err(|error| {
            match error {
                LuError::SymbolicSingular { .. } => FactorError::Singular,
                LuError::Generic(error) => error.into(),
            }
        })?;
        let kind = Kind::Lu { symbolic: Box::new(symbolic), numeric: Box::new(numeric) };
        let factors = Self { size: restricted.size(), kind };
        if factors.condition_holds(restricted) { Ok(factors) } else { Err(FactorError::Singular) }
    }

    /// Whether the matrix, its rows scaled to norm one, is regular to working precision.
    ///
    /// Partial pivoting divides by whatever pivot is left, so success alone proves nothing. A
    /// right-hand side without structure is dominated by the least singular direction; the size
    /// of its solution bounds the condition number from below, and so raises no false alarm.
    fn condition_holds(&self, restricted: &Submatrix<T>) -> bool {
        let mut x: Vec<T> = (0..self.size)
            .zip(signs())
            .map(|(i, is_positive)| {
                let norm: f64 = restricted.row(i).1.iter().map(|a| a.to_f64().abs()).sum();
                T::lit(if is_positive { norm } else { -norm })
            })
            .collect();
        self.solve_in_place(&mut x, 1);
        // Written so that a number that is not finite fails.
        x.iter().all(|x| x.to_f64().abs() * LOST_PIVOT * T::EPSILON < 1.0)
    }
}

/// Whether a matrix is positive definite on the unknowns `free` (ascending): its symmetric part
/// has a Cholesky factor. This is the coercivity of the bilinear form, which the size of an error
/// does not reveal.
///
/// # Errors
/// [`FactorError::OutOfMemory`] if the question could not be answered.
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

/// The rows of a restricted matrix as the columns of its transpose.
pub(crate) fn columns<T>(restricted: &Submatrix<T>) -> SparseColMatRef<'_, u32, T> {
    let n = restricted.size();
    let pattern = faer::sparse::SymbolicSparseColMatRef::new_checked(
        n,
        n,
        &restricted.row_starts,
        None,
        &restricted.columns,
    );
    SparseColMatRef::new(pattern, &restricted.values)
}

/// Tells a singular matrix from an indefinite one after a pivot has failed: the former becomes
/// definite if its diagonal grows by the root of the rounding unit, which is far above rounding
/// and far below any curvature that a too small penalty leaves behind.
fn why_not_positive<T: Real>(restricted: &mut Submatrix<T>, analysis: &Analysis) -> FactorError {
    for i in 0..restricted.size() {
        let (columns, values) = restricted.row_mut(i);
        match (columns.last(), values.last_mut()) {
            (Some(&j), Some(a)) if j as usize == i && a.to_f64() > 0.0 => {
                *a *= T::lit(1.0 + T::EPSILON.sqrt());
            }
            // Nothing on the diagonal: curvature is negative somewhere, or the row is empty,
            // which the diagonal alone cannot tell; either way no growth will help.
            _ => return FactorError::NotPositive,
        }
    }
    match Factors::cholesky(restricted, analysis) {
        Ok(_) => FactorError::Singular,
        Err(error) => error,
    }
}

/// Whether every pivot kept digits of the diagonal entry it came from.
fn pivots_hold<T: Real>(symbolic: &SymbolicCholesky<u32>, values: &[T], diagonal: &[T]) -> bool {
    let original = symbolic.perm().map(|permutation| permutation.arrays().0);
    let holds = |j: usize, root: T| {
        let a = diagonal[original.map_or(j, |original| original[j] as usize)].to_f64();
        let root = root.to_f64();
        // Written so that a number that is not finite fails.
        root.is_finite() && root * root > LOST_PIVOT * T::EPSILON * a
    };
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(simplicial) => {
            let starts = &simplicial.col_ptr()[..simplicial.ncols()];
            starts.iter().enumerate().all(|(j, &start)| holds(j, values[start as usize]))
        }
        SymbolicCholeskyRaw::Supernodal(supernodal) => {
            let factor = SupernodalLltRef::<'_, u32, T>::new(supernodal, values);
            (0..supernodal.n_supernodes()).all(|s| {
                let supernode = factor.supernode(s);
                let block = supernode.val();
                (0..block.ncols()).all(|k| holds(supernode.start() + k, block[(k, k)]))
            })
        }
    }
}
