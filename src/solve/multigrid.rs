//! One multigrid cycle for conforming linear functions that vanish on given vertices.

use std::borrow::Cow;

use super::hierarchy::Coarser;
use super::linear::{FactorError, Factors};
use super::smoother::{backward, forward, invert_diagonal, residual};
use super::transfer::Transfer;
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// A V-cycle with one Gauss-Seidel sweep forward before and one backward after the coarser grid:
/// symmetric and positive definite, so that conjugate gradients can use it.
///
/// Coarse functions are cut off at the fixed fine vertices: R. Kornhuber, Numer. Math. 69 (1994),
/// 167-184. The form on each level is that of its own mesh except for the functions that lost
/// something, for which it is computed from the finer form: few, near the fixed vertices.
pub(super) struct Multigrid<'a, T: Real> {
    grids: Vec<Grid<'a, T>>,
    coarsest: Coarsest<T>,
}

struct Grid<'a, T: Real> {
    original: &'a SparseMatrix<T>,
    matrix: Cow<'a, SparseMatrix<T>>,
    /// Rows of the matrix that are not those of the original.
    cut: Vec<u32>,
    transfer: Option<&'a Transfer<T>>,
    given: &'a [bool],
    diagonal: Vec<T>,
    inverse: Vec<T>,
    fixed: Vec<bool>,
    force: Vec<T>,
    values: Vec<T>,
    residual: Vec<T>,
    old: Vec<T>,
}

struct Coarsest<T> {
    free: Vec<u32>,
    factors: Option<Factors<T>>,
    values: Vec<T>,
}

impl<'a, T: Real> Grid<'a, T> {
    fn new(
        matrix: &'a SparseMatrix<T>,
        given: &'a [bool],
        coarser: Option<&'a Coarser<T>>,
    ) -> Self {
        let n = matrix.size();
        let zeros = || vec![T::lit(0.0); n];
        Self {
            original: matrix,
            matrix: Cow::Borrowed(matrix),
            cut: Vec::new(),
            transfer: coarser.map(|c| &*c.transfer),
            given,
            diagonal: matrix.diagonal(),
            inverse: zeros(),
            fixed: vec![false; n],
            force: zeros(),
            values: zeros(),
            residual: zeros(),
            old: if n > super::pieces::PIECE { zeros() } else { Vec::new() },
        }
    }
}

impl<T: Real> Grid<'_, T> {
    /// Factors the form on some functions. Those that were cut off may have become dependent, which
    /// a slightly larger diagonal mends.
    fn factor(&self, free: &[u32]) -> Result<Factors<T>, FactorError> {
        match Factors::new(&self.matrix, true, free) {
            Err(FactorError::NotPositive | FactorError::Singular) if !self.cut.is_empty() => {
                let mut matrix = self.matrix.clone().into_owned();
                for j in 0..matrix.size() as u32 {
                    let range = row_range(&matrix, j);
                    if let Ok(k) = matrix.columns[range.clone()].binary_search(&j) {
                        matrix.values[range.start + k] *= T::lit(1.0 + T::EPSILON.sqrt());
                    }
                }
                Factors::new(&matrix, true, free)
            }
            other => other,
        }
    }

    /// Sets the rows of functions that lost fixed fine unknowns, and restores those that did before.
    fn cut_off(&mut self, finer: &Grid<'_, T>, transfer: &Transfer<T>) {
        let mut near = vec![false; finer.fixed.len()];
        for i in (0..near.len()).filter(|&i| finer.fixed[i]) {
            near[i] = true;
            finer.matrix.row(i).0.iter().for_each(|&j| near[j as usize] = true);
        }
        finer.cut.iter().for_each(|&i| near[i as usize] = true);
        let fixed = &self.fixed;
        let is_cut = |j: usize| !fixed[j] && transfer.any_child(j, |i| near[i]);
        let cut: Vec<u32> = (0..fixed.len()).filter(|&j| is_cut(j)).map(|j| j as u32).collect();
        let before = std::mem::replace(&mut self.cut, cut);
        if before.is_empty() && self.cut.is_empty() {
            return;
        }
        let matrix = self.matrix.to_mut();
        for &j in &before {
            let range = row_range(matrix, j);
            matrix.values[range.clone()].copy_from_slice(&self.original.values[range]);
            self.diagonal[j as usize] = self.original.get(j as usize, j as usize);
        }
        for &j in &self.cut {
            let range = row_range(matrix, j);
            let columns = &matrix.columns[range.clone()];
            let values = &mut matrix.values[range];
            values.fill(T::lit(0.0));
            transfer.children(j as usize, |i, weight| {
                if !finer.fixed[i] {
                    add_row(&finer.matrix, &finer.fixed, transfer, (i, weight), (columns, values));
                }
            });
            if let Ok(k) = columns.binary_search(&j) {
                self.diagonal[j as usize] = values[k];
            }
        }
    }
}

fn row_range<T>(matrix: &SparseMatrix<T>, j: u32) -> std::ops::Range<usize> {
    let j = j as usize;
    matrix.row_starts[j] as usize..matrix.row_starts[j + 1] as usize
}

/// Adds a fine row, times a weight, to a coarse one.
fn add_row<T: Real>(
    matrix: &SparseMatrix<T>,
    fixed: &[bool],
    transfer: &Transfer<T>,
    (i, weight): (usize, T),
    (columns, values): (&[u32], &mut [T]),
) {
    let (neighbours, entries) = matrix.row(i);
    for (&k, &a) in neighbours.iter().zip(entries) {
        if fixed[k as usize] {
            continue;
        }
        transfer.parents(k as usize, |parent, other| {
            if let Ok(at) = columns.binary_search(&parent) {
                values[at] += weight * a * other;
            }
        });
    }
}

impl<'a, T: Real> Multigrid<'a, T> {
    /// The cycle for a matrix with its coarser levels; call [`Multigrid::fix`] before use.
    pub fn new(matrix: &'a SparseMatrix<T>, coarser: Option<&'a Coarser<T>>) -> Self {
        let mut grids = vec![Grid::new(matrix, &[], coarser)];
        let mut next = coarser;
        while let Some(Coarser { level, .. }) = next {
            next = level.coarser.as_ref();
            grids.push(Grid::new(&level.matrix, &level.fixed, next));
        }
        let coarsest = Coarsest { free: Vec::new(), factors: None, values: Vec::new() };
        Self { grids, coarsest }
    }

    /// Sets which unknowns are fixed.
    ///
    /// # Errors
    /// If the form on the coarsest functions is not positive definite.
    pub fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.grids[0].fixed.copy_from_slice(fixed);
        for k in 0..self.grids.len() {
            let (finer, rest) = self.grids.split_at_mut(k);
            let grid = &mut rest[0];
            if let Some(finer) = finer.last() {
                grid.fixed.copy_from_slice(grid.given);
                if let Some(transfer) = finer.transfer {
                    transfer.fix_covered(&finer.fixed, &mut grid.fixed);
                    grid.cut_off(finer, transfer);
                }
            }
            invert_diagonal(&grid.diagonal, &grid.fixed, &mut grid.inverse);
        }
        let Some(last) = self.grids.last() else { return Ok(()) };
        let free = (0..last.fixed.len() as u32).filter(|&i| !last.fixed[i as usize]);
        let free: Vec<u32> = free.collect();
        if free.len() > super::hierarchy::LARGEST_FACTORED {
            // a level that could not be coarsened any further is smoothed only
            self.coarsest.factors = None;
            return Ok(());
        }
        if self.coarsest.factors.is_none() || free != self.coarsest.free || !last.cut.is_empty() {
            self.coarsest.factors = Some(last.factor(&free)?);
            self.coarsest.free = free;
        }
        Ok(())
    }

    /// An approximate solution for a force.
    pub fn apply(&mut self, force: &[T], values: &mut [T]) {
        cycle(&mut self.grids, &mut self.coarsest, force, values);
    }
}

fn cycle<T: Real>(grids: &mut [Grid<'_, T>], coarsest: &mut Coarsest<T>, force: &[T], x: &mut [T]) {
    let Some((grid, rest)) = grids.split_first_mut() else { return };
    if rest.is_empty() && coarsest.factors.is_some() {
        coarsest.solve(force, x);
        return;
    }
    forward(&grid.matrix, &grid.inverse, force, x);
    if let (Some(transfer), Some(coarse)) = (grid.transfer, rest.first_mut()) {
        residual(&grid.matrix, &grid.inverse, force, x, &mut grid.residual);
        let mut coarse_force = std::mem::take(&mut coarse.force);
        let mut coarse_values = std::mem::take(&mut coarse.values);
        transfer.restrict(&grid.residual, &mut coarse_force);
        cycle(rest, coarsest, &coarse_force, &mut coarse_values);
        transfer.prolongate(&coarse_values, &grid.inverse, x);
        rest[0].force = coarse_force;
        rest[0].values = coarse_values;
    }
    backward(&grid.matrix, &grid.inverse, force, x, &mut grid.old);
}

impl<T: Real> Coarsest<T> {
    fn solve(&mut self, force: &[T], x: &mut [T]) {
        let Some(factors) = &self.factors else { return };
        self.values.clear();
        self.values.extend(self.free.iter().map(|&i| force[i as usize]));
        factors.solve_in_place(&mut self.values, 1);
        x.fill(T::lit(0.0));
        for (&i, &value) in self.free.iter().zip(&self.values) {
            x[i as usize] = value;
        }
    }
}
