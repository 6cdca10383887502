//! A preconditioner from conforming linear functions: what they miss is local.
//!
//! Source: J. Xu, Computing 56 (1996), 215-235 (auxiliary space); for discontinuous functions
//! B. Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36.

use std::sync::atomic::{AtomicBool, Ordering};

use super::multigrid::Multigrid;
use super::prolongation::RectangularMatrix;
use crate::algebra::{SparseMatrix, Support};
use crate::linear::direct::factors::FactorError;
use crate::linear::krylov::conjugate_gradients::Preconditioner;
use crate::memory::in_large_pages;
use crate::parallel::vectors::{each_mut, each_mut_of, zeros};
use crate::real::Real;

/// Largest number of unknowns of a cell.
const LARGEST: usize = 16;

/// The inverse blocks of the cells plus a multigrid cycle on the vertices that no fixed unknown
/// touches.
pub(crate) struct AuxiliarySpace<'a, T: Real> {
    blocks: Blocks<'a, T>,
    vertices: Vertices<'a, T>,
}

impl<'a, T: Real> AuxiliarySpace<'a, T> {
    /// For a matrix whose unknowns live at `supports`; `None` where they do not say enough.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        supports: &[Support],
        vertices: Vertices<'a, T>,
    ) -> Option<Self> {
        Some(Self { blocks: Blocks::new(matrix, cell_size(supports)?)?, vertices })
    }

    /// Sets which unknowns are fixed.
    ///
    /// # Errors
    /// If a block or the form on the coarsest functions is not positive definite.
    pub fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.blocks.fix(fixed)?;
        self.vertices.fix(fixed)
    }
}

impl<T: Real> Preconditioner<T> for AuxiliarySpace<'_, T> {
    fn apply(&mut self, r: &[T], z: &mut [T]) {
        self.blocks.apply(r, z);
        self.vertices.add(r, z);
    }
}

/// How many unknowns a cell owns, one if cells share them: consecutive ones, the same number for
/// all.
pub(crate) fn cell_size(supports: &[Support]) -> Option<usize> {
    let first = supports.first()?.cell();
    if first.is_none() {
        return supports.iter().all(|p| p.cell().is_none()).then_some(1);
    }
    let size = supports.iter().take_while(|p| p.cell() == first).count();
    let whole = |cell: &[Support]| {
        cell.len() == size
            && cell[0].cell().is_some()
            && cell.iter().all(|p| p.cell() == cell[0].cell())
    };
    (size <= LARGEST && supports.chunks(size).all(whole)).then_some(size)
}

/// Conforming linear functions inside another space, through multigrid.
pub(crate) struct Vertices<'a, T: Real> {
    multigrid: Multigrid<'a, T>,
    given: &'a [bool],
    /// The unknowns around each vertex, with weights.
    around: RectangularMatrix<T>,
    /// The vertices around each unknown, with weights.
    of: RectangularMatrix<T>,
    fixed: Vec<bool>,
    force: Vec<T>,
    values: Vec<T>,
}

impl<'a, T: Real> Vertices<'a, T> {
    /// The functions that vanish on `given` vertices. Each unknown is a mean of vertex values;
    /// `None` if some vertex does not exist.
    pub fn new(
        multigrid: Multigrid<'a, T>,
        given: &'a [bool],
        supports: &[Support],
    ) -> Option<Self> {
        let n = given.len();
        let total = supports.iter().map(|support| support.vertices().len()).sum();
        let mut of = RectangularMatrix {
            starts: in_large_pages(Vec::with_capacity(supports.len() + 1)),
            columns: in_large_pages(Vec::with_capacity(total)),
            values: in_large_pages(Vec::with_capacity(total)),
        };
        of.starts.push(0);
        for support in supports {
            let around = support.vertices();
            if around.is_empty() || around.iter().any(|&v| v as usize >= n) {
                return None;
            }
            let weight = T::lit(1.0 / around.len() as f64);
            of.columns.extend(around);
            of.values.extend(around.iter().map(|_| weight));
            of.starts.push(of.columns.len() as u32);
        }
        let around = of.transpose(n);
        let (force, values) = (zeros(n), zeros(n));
        Some(Self { multigrid, given, around, of, fixed: vec![false; n], force, values })
    }

    /// Fixes the vertices in whose reach some unknown is fixed.
    pub fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let (around, given) = (&self.around, self.given);
        each_mut(&mut self.fixed, |range, piece| {
            for (v, out) in range.zip(piece) {
                let touched = |&i: &u32| fixed[i as usize];
                *out = given[v] || around.row(v).0.iter().any(touched);
            }
        });
        self.multigrid.fix(&self.fixed)
    }

    /// Adds the functions' part of the approximate solution for the force `r`.
    pub fn add(&mut self, r: &[T], z: &mut [T]) {
        let (around, of, fixed) = (&self.around, &self.of, &self.fixed);
        each_mut(&mut self.force, |range, piece| {
            for (v, force) in range.zip(piece) {
                *force = if fixed[v] { T::lit(0.0) } else { product(around.row(v), r) };
            }
        });
        self.multigrid.apply(&self.force, &mut self.values);
        let values = &self.values;
        each_mut(z, |range, piece| {
            for (i, z) in range.zip(piece) {
                *z += product(of.row(i), values);
            }
        });
    }
}

#[inline(always)]
fn product<T: Real>((columns, weights): (&[u32], &[T]), x: &[T]) -> T {
    columns.iter().zip(weights).fold(T::lit(0.0), |s, (&j, &w)| s + w * x[j as usize])
}

/// The inverses of the diagonal blocks of all cells, on the unknowns that are free.
struct Blocks<'a, T> {
    matrix: &'a SparseMatrix<T>,
    size: usize,
    inverse: Vec<T>,
}

impl<'a, T: Real> Blocks<'a, T> {
    fn new(matrix: &'a SparseMatrix<T>, size: usize) -> Option<Self> {
        let n = matrix.size();
        n.is_multiple_of(size).then(|| Self { matrix, size, inverse: zeros(n * size) })
    }

    fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let Self { matrix, size, ref mut inverse } = *self;
        let is_positive = AtomicBool::new(true);
        each_mut_of(inverse, size * size, |range, piece| {
            let cells = range.start / (size * size)..;
            for (cell, block) in cells.zip(piece.chunks_exact_mut(size * size)) {
                let first = cell * size;
                let fixed = &fixed[first..first + size];
                block_of(matrix, first, fixed, block);
                if !invert(block, size, fixed) {
                    is_positive.store(false, Ordering::Relaxed);
                }
            }
        });
        if is_positive.into_inner() { Ok(()) } else { Err(FactorError::NotPositive) }
    }

    fn apply(&self, r: &[T], z: &mut [T]) {
        let (size, inverse) = (self.size, &self.inverse);
        each_mut_of(z, size, |range, piece| {
            for (k, z) in (range.start / size..).zip(piece.chunks_exact_mut(size)) {
                let r = &r[k * size..(k + 1) * size];
                let block = &inverse[k * size * size..(k + 1) * size * size];
                for (z, row) in z.iter_mut().zip(block.chunks_exact(size)) {
                    *z = row.iter().zip(r).fold(T::lit(0.0), |s, (&a, &r)| s + a * r);
                }
            }
        });
    }
}

/// The diagonal block that begins with an unknown, zero where fixed.
fn block_of<T: Real>(matrix: &SparseMatrix<T>, first: usize, fixed: &[bool], block: &mut [T]) {
    let size = fixed.len();
    block.fill(T::lit(0.0));
    for (k, row) in block.chunks_exact_mut(size).enumerate().filter(|&(k, _)| !fixed[k]) {
        let (columns, values) = matrix.row(first + k);
        let from = columns.partition_point(|&j| (j as usize) < first);
        for (&j, &a) in columns[from..].iter().zip(&values[from..]) {
            match fixed.get(j as usize - first) {
                Some(true) => {}
                Some(false) => row[j as usize - first] = a,
                None => break,
            }
        }
    }
}

/// Inverts a symmetric positive definite block in support on what is not fixed, by exchange steps;
/// false if a pivot is not positive.
fn invert<T: Real>(a: &mut [T], size: usize, fixed: &[bool]) -> bool {
    let one = T::lit(1.0);
    for k in (0..size).filter(|&k| !fixed[k]) {
        let pivot = a[k * size + k];
        if pivot <= T::lit(0.0) || !pivot.is_finite() {
            return false;
        }
        let inverse = one / pivot;
        a[k * size + k] = one;
        for j in 0..size {
            a[k * size + j] *= inverse;
        }
        for i in (0..size).filter(|&i| i != k) {
            let factor = a[i * size + k];
            a[i * size + k] = T::lit(0.0);
            for j in 0..size {
                let term = factor * a[k * size + j];
                a[i * size + j] -= term;
            }
        }
    }
    true
}
