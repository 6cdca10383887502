//! A multigrid V-cycle for conforming linear functions with fixed unknowns.
//!
//! The finest level may have another finite element (J. Xu, Computing 56 (1996), 215-235; for discontinuous
//! functions B. Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36). With smoothing before and after
//! the coarse correction, Krylov methods take a third of the iterations that they take with the sum of smoother and
//! coarse correction.
//!
//! On each level, unknown `i` is the coefficient of basis function `i`, and row `i` of the matrix
//! is the equation of this unknown. For conforming linear functions on a mesh, unknown `i` is the value at vertex `i`.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the V-cycle, and the fixed unknowns of all levels |
//! | `level` | one level: matrix, fixed unknowns, smoother |
//! | `truncation` | the rows of a coarse matrix near fixed unknowns of the finer level |
//! | `coarsest_solver` | the coarsest level, with factors |

mod coarsest_solver;
mod level;
mod truncation;

use std::borrow::Cow;

use super::coarse_level::{CoarseLevel, P1Level};
use super::preconditioner::{FacetMeansSolver, Preconditioner};
use super::prolongation::Prolongation;
use crate::algebra::SparseMatrix;
use crate::linear::direct::FactorError;
use crate::parallel::vectors::{for_each_chunk, largest, zeros};
use crate::real::Real;
use coarsest_solver::CoarsestSolver;
use level::Level;

/// A V-cycle with one forward Gauss-Seidel iteration before and one backward iteration after the
/// coarse correction: symmetric and positive definite.
///
/// Coarse basis functions are truncated: their coefficients at fixed unknowns of the finer level
/// are set to zero (R. Kornhuber, Numer. Math. 69 (1994), 167-184). The matrix of a level is the
/// given one, except for the rows that truncation may change, those of truncated functions and of
/// functions near them: these rows are Galerkin products with the matrix of the finer level.
///
/// All levels but a factored coarsest one compute in single precision. The matrices of all levels are
/// divided by the largest entry of the finest matrix, and the right-hand side by its largest entry.
/// A preconditioner need not be exact, and the time is limited by memory bandwidth: numbers with
/// half the bytes of `f64` take half the time. Right-hand side and result are in the scalar `T`.
pub(crate) struct Multigrid<'a, T: Real> {
    levels: Vec<Level<'a, T>>,
    coarsest: CoarsestSolver<T>,
    /// The divisor of the matrices of all levels: the largest absolute entry of the finest matrix.
    scale: f64,
    /// Workspace: right-hand side and result on the finest level.
    right_side: Vec<f32>,
    values: Vec<f32>,
    /// The name in reports.
    name: &'static str,
}

impl<'a, T: Real> Multigrid<'a, T> {
    /// The cycle for a matrix with its coarser levels. [`Preconditioner::set_fixed`] must be called before
    /// the first use.
    pub fn new(matrix: &'a SparseMatrix<T>, coarser: Option<&'a CoarseLevel<T>>) -> Self {
        let prolongation = coarser.map(|c| Cow::Borrowed(&*c.prolongation));
        let finest = Level::finest(Cow::Borrowed(matrix), prolongation);
        Self::with_finest(finest, coarser.map(|c| &*c.level))
    }

    /// The cycle for the matrix of another finite element on the mesh of a level, with the
    /// `prolongation` from the conforming linear functions of the level, which are the auxiliary space
    /// of the element. `cell_size` is the number of unknowns of a cell if cells share no unknowns, else
    /// one.
    pub fn of_element(
        matrix: Cow<'a, SparseMatrix<T>>,
        prolongation: Prolongation,
        level: &'a P1Level<T>,
        cell_size: usize,
    ) -> Self {
        let finest = Level::finest(matrix, Some(Cow::Owned(prolongation)));
        let all = Self::with_finest(Level { cell_size, ..finest }, Some(level));
        Self { name: "auxiliary-space", ..all }
    }

    /// The cycle with a finest level, and the levels from `coarser` on.
    fn with_finest(finest: Level<'a, T>, coarser: Option<&'a P1Level<T>>) -> Self {
        let matrix = &finest.matrix;
        let n = matrix.size();
        let largest = largest(matrix.values.len(), |k| matrix.values[k].to_f64().abs());
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let coarsest = CoarsestSolver::new(scale);
        let mut levels = vec![finest];
        let mut next = coarser;
        while let Some(level) = next {
            levels.push(Level::coarser(level));
            next = level.coarser.as_ref().map(|c| &*c.level);
        }
        let (right_side, values) = (zeros(n), zeros(n));
        Self { levels, coarsest, scale, right_side, values, name: "multigrid" }
    }
}

impl<T: Real> Preconditioner<T> for Multigrid<'_, T> {
    fn name(&self) -> &'static str {
        self.name
    }

    /// Sets the fixed unknowns of the finest level. On a coarser level an unknown is fixed if it has Dirichlet
    /// data, if all its children are fixed, or if [`FacetMeansSolver::set_fixed`] has fixed it.
    ///
    /// # Errors
    /// [`FactorError`] if the matrix of the coarsest level, or the block of a cell, is not positive definite.
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.levels[0].fixed.copy_from_slice(fixed);
        for k in 0..self.levels.len() {
            let (finer, rest) = self.levels.split_at_mut(k);
            let level = &mut rest[0];
            if let Some(finer) = finer.last_mut() {
                let Level { dirichlet, fixed_besides, .. } = level;
                for_each_chunk(&mut level.fixed, |range, fixed| {
                    fixed.copy_from_slice(&dirichlet[range.clone()]);
                    let besides = fixed_besides.get(range).unwrap_or_default();
                    fixed.iter_mut().zip(besides).for_each(|(fixed, besides)| *fixed |= besides);
                });
                let changed_rows = std::mem::take(&mut finer.changed_rows);
                if let Some(prolongation) = &finer.prolongation {
                    // truncation sets a coarse function to zero if all its children are fixed
                    prolongation.fix_covered(&finer.fixed, &mut level.fixed);
                    level.recompute_rows((finer, &changed_rows), prolongation);
                }
            }
            let is_coarsest = rest.len() == 1;
            if !is_coarsest {
                rest[0].update_smoother(self.scale)?;
            }
        }
        match self.levels.last_mut() {
            Some(coarsest) => self.coarsest.update(coarsest),
            None => Ok(()),
        }
    }

    /// Sets `values` to the result of one cycle from zero for a right-hand side.
    fn apply(&mut self, right_side: &[T], values: &mut [T]) {
        // the quotient of a number that is not finite is not finite
        let largest = largest(right_side.len(), |i| right_side[i].to_f64().abs());
        let unit = if largest > 0.0 { largest } else { 1.0 };
        for_each_chunk(&mut self.right_side, |range, single| {
            let pairs = single.iter_mut().zip(&right_side[range]);
            pairs.for_each(|(s, f)| *s = (f.to_f64() / unit) as f32);
        });
        cycle(&mut self.levels, &mut self.coarsest, &self.right_side, &mut self.values);
        let (single, unit) = (&self.values, unit / self.scale);
        for_each_chunk(values, |range, values| {
            let pairs = values.iter_mut().zip(&single[range]);
            pairs.for_each(|(v, &s)| *v = T::lit(f64::from(s) * unit));
        });
    }
}

impl<T: Real> FacetMeansSolver<T> for Multigrid<'_, T> {
    fn set_fixed(
        &mut self,
        fixed_facets: &[bool],
        kept_facets: &[u32],
        fixed_vertices: &[bool],
    ) -> Result<(), FactorError> {
        self.levels[0].kept = kept_facets.to_vec();
        if let Some(next) = self.levels.get_mut(1) {
            next.fixed_besides = fixed_vertices.to_vec();
        }
        Preconditioner::set_fixed(self, fixed_facets)
    }

    fn apply(&mut self, residual: &[T], means: &mut [T]) {
        Preconditioner::apply(self, residual, means);
    }
}

/// Sets `x` to the result of one V-cycle from zero on the first of `levels`.
fn cycle<T: Real>(
    levels: &mut [Level<'_, T>],
    coarsest: &mut CoarsestSolver<T>,
    right_side: &[f32],
    x: &mut [f32],
) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    if coarser.is_empty() && coarsest.has_factors() {
        coarsest.solve(right_side, x);
        return;
    }
    let Level { smoother: Some(smoother), fixed, .. } = level else { return };
    smoother.forward(right_side, x, &mut level.residual);
    if let (Some(prolongation), Some(coarse)) = (&level.prolongation, coarser.first_mut()) {
        let mut coarse_right_side = std::mem::take(&mut coarse.right_side);
        let mut coarse_values = std::mem::take(&mut coarse.values);
        prolongation.restrict(&level.residual, &mut coarse_right_side);
        cycle(coarser, coarsest, &coarse_right_side, &mut coarse_values);
        prolongation.add_prolongation(&coarse_values, |i| !fixed[i], x);
        coarser[0].right_side = coarse_right_side;
        coarser[0].values = coarse_values;
    }
    smoother.backward(right_side, x, &mut level.residual);
}
