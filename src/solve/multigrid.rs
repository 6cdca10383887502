//! One multigrid cycle for conforming linear functions that vanish on given vertices.

use super::hierarchy::Coarser;
use super::linear::{FactorError, Factors};
use super::smoother::{backward, forward, invert_diagonal, residual};
use super::transfer::Transfer;
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// A V-cycle with one Gauss-Seidel sweep forward before and one backward after the coarser grid:
/// symmetric and positive definite, so that conjugate gradients can use it.
///
/// The form on each level is that of its own mesh, on the functions that vanish where a fixed fine
/// vertex lies in their support: a subspace of the fine functions on which coarse and fine form
/// agree, so that nothing is assembled when the fixed vertices change. Source for coarse spaces
/// inside the domain that the fine mesh resolves: R. Kornhuber, H. Yserentant, Numer. Math. 67
/// (1994), 301-314.
pub(super) struct Multigrid<'a, T> {
    grids: Vec<Grid<'a, T>>,
    coarsest: Coarsest<T>,
}

struct Grid<'a, T> {
    matrix: &'a SparseMatrix<T>,
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
            matrix,
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
                    transfer.fix_touched(&finer.fixed, &mut grid.fixed);
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
        if self.coarsest.factors.is_none() || free != self.coarsest.free {
            self.coarsest.factors = Some(Factors::new(last.matrix, true, &free)?);
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
    forward(grid.matrix, &grid.inverse, force, x);
    if let (Some(transfer), Some(coarse)) = (grid.transfer, rest.first_mut()) {
        residual(grid.matrix, &grid.inverse, force, x, &mut grid.residual);
        let mut coarse_force = std::mem::take(&mut coarse.force);
        let mut coarse_values = std::mem::take(&mut coarse.values);
        transfer.restrict(&grid.residual, &mut coarse_force);
        cycle(rest, coarsest, &coarse_force, &mut coarse_values);
        transfer.prolongate(&coarse_values, &grid.inverse, x);
        rest[0].force = coarse_force;
        rest[0].values = coarse_values;
    }
    backward(grid.matrix, &grid.inverse, force, x, &mut grid.old);
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
