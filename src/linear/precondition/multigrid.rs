//! One multigrid cycle for conforming linear functions that vanish on given vertices.

use super::coarse_level::CoarseLevel;
use super::gauss_seidel::Sweeps;
use super::prolongation::Prolongation;
use crate::algebra::SparseMatrix;
use crate::linear::direct::factors::{FactorError, Factors};
use crate::parallel::vectors::{each_mut, map, zeros};
use crate::real::Real;

/// A V-cycle with one Gauss-Seidel sweep forward before and one backward after the coarser grid:
/// symmetric and positive definite, so that conjugate gradients can use it.
///
/// Coarse functions are cut off at the fixed fine vertices: R. Kornhuber, Numer. Math. 69 (1994),
/// 167-184. The form on each level is that of its own mesh except for the functions that lost
/// something, for which it is computed from the finer form: few, near the fixed vertices.
///
/// All but the coarsest grid works in single precision, on forces over the largest of them and
/// matrices over their largest entry: a preconditioner need not be exact, and half the bytes are
/// twice the speed. What it is asked for is told in the scalar's own precision.
pub(crate) struct Multigrid<'a, T: Real> {
    grids: Vec<Grid<'a, T>>,
    coarsest: Coarsest<T>,
    /// What the matrices are divided by.
    scale: f64,
    force: Vec<f32>,
    values: Vec<f32>,
}

struct Grid<'a, T: Real> {
    matrix: &'a SparseMatrix<T>,
    /// RectangularMatrix that are not those of the matrix, ascending, and their values, one row after the other.
    cut: Vec<u32>,
    cut_starts: Vec<usize>,
    cut_values: Vec<T>,
    /// RectangularMatrix that are not what the sweeps think they are, ascending.
    stale: Vec<u32>,
    transfer: Option<&'a Prolongation<T>>,
    given: &'a [bool],
    sweeps: Option<Sweeps>,
    fixed: Vec<bool>,
    force: Vec<f32>,
    values: Vec<f32>,
    residual: Vec<f32>,
}

struct Coarsest<T> {
    free: Vec<u32>,
    factors: Option<Factors<T>>,
    /// Whether they are of a form of which functions were cut off.
    was_cut: bool,
    values: Vec<T>,
    scale: f64,
}

impl<'a, T: Real> Grid<'a, T> {
    fn new(
        matrix: &'a SparseMatrix<T>,
        given: &'a [bool],
        coarser: Option<&'a CoarseLevel<T>>,
        is_finest: bool,
    ) -> Self {
        let n = matrix.size();
        let inner = if is_finest { 0 } else { n };
        Self {
            matrix,
            cut: Vec::new(),
            cut_starts: vec![0],
            cut_values: Vec::new(),
            stale: Vec::new(),
            transfer: coarser.map(|c| &*c.transfer),
            given,
            sweeps: None,
            fixed: vec![false; n],
            force: zeros(inner),
            values: zeros(inner),
            residual: zeros(n),
        }
    }
}

impl<T: Real> Grid<'_, T> {
    /// A row as it is after functions were cut off.
    fn row(&self, i: usize) -> (&[u32], &[T]) {
        let (columns, values) = self.matrix.row(i);
        match self.cut.binary_search(&(i as u32)) {
            Ok(k) if !self.cut.is_empty() => {
                (columns, &self.cut_values[self.cut_starts[k]..self.cut_starts[k + 1]])
            }
            _ => (columns, values),
        }
    }

    /// Factors the form on some functions. Those that were cut off may have become dependent, which
    /// a slightly larger diagonal mends.
    fn factor(&self, free: &[u32]) -> Result<Factors<T>, FactorError> {
        if self.cut.is_empty() {
            return Factors::new(self.matrix, true, free);
        }
        let mut matrix = self.matrix.clone();
        for &j in &self.cut {
            let range = row_range(&matrix, j);
            matrix.values[range].copy_from_slice(self.row(j as usize).1);
        }
        match Factors::new(&matrix, true, free) {
            Err(FactorError::NotPositive | FactorError::Singular) => {
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
    fn cut_off(&mut self, finer: &Grid<'_, T>, transfer: &Prolongation<T>) {
        let mut near = vec![false; finer.fixed.len()];
        for i in (0..near.len()).filter(|&i| finer.fixed[i]) {
            near[i] = true;
            finer.matrix.row(i).0.iter().for_each(|&j| near[j as usize] = true);
        }
        finer.cut.iter().for_each(|&i| near[i as usize] = true);
        let fixed = &self.fixed;
        let is_cut = |j: usize| !fixed[j] && transfer.any_child(j, |i| near[i]);
        let cut: Vec<u32> = (0..fixed.len()).filter(|&j| is_cut(j)).map(|j| j as u32).collect();
        self.stale = union(&self.cut, &cut);
        self.cut = cut;
        self.cut_values.clear();
        self.cut_starts.truncate(1);
        for &j in &self.cut {
            let columns = self.matrix.row(j as usize).0;
            let start = self.cut_values.len();
            self.cut_values.resize(start + columns.len(), T::lit(0.0));
            let values = &mut self.cut_values[start..];
            transfer.children(j as usize, |i, weight| {
                if !finer.fixed[i] {
                    add_row(finer.row(i), &finer.fixed, transfer, weight, (columns, values));
                }
            });
            self.cut_starts.push(self.cut_values.len());
        }
    }

    /// Makes the sweeps fit matrix and fixed unknowns.
    fn prepare(&mut self, scale: f64) {
        let few = self.matrix.size() / MANY_STALE;
        let mut sweeps = match self.sweeps.take() {
            Some(mut sweeps) if self.stale.len() <= few => {
                sweeps.replace(&self.stale, |i| self.row(i), scale);
                sweeps
            }
            _ if self.cut.is_empty() => Sweeps::new(self.matrix, |i| self.matrix.row(i), scale),
            _ => Sweeps::new(self.matrix, |i| self.row(i), scale),
        };
        self.stale.clear();
        sweeps.fix(&self.fixed);
        self.sweeps = Some(sweeps);
    }
}

/// One in so many rows that have changed makes it quicker to read all anew.
const MANY_STALE: usize = 8;

/// The numbers that are in one of two ascending lists, ascending.
fn union(one: &[u32], other: &[u32]) -> Vec<u32> {
    let mut all = [one, other].concat();
    all.sort_unstable();
    all.dedup();
    all
}

fn row_range<T>(matrix: &SparseMatrix<T>, j: u32) -> std::ops::Range<usize> {
    let j = j as usize;
    matrix.row_starts[j] as usize..matrix.row_starts[j + 1] as usize
}

/// Adds a fine row, times a weight, to a coarse one.
fn add_row<T: Real>(
    (neighbours, entries): (&[u32], &[T]),
    fixed: &[bool],
    transfer: &Prolongation<T>,
    weight: T,
    (columns, values): (&[u32], &mut [T]),
) {
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
    pub fn new(matrix: &'a SparseMatrix<T>, coarser: Option<&'a CoarseLevel<T>>) -> Self {
        let mut grids = vec![Grid::new(matrix, &[], coarser, true)];
        let mut next = coarser;
        while let Some(CoarseLevel { level, .. }) = next {
            next = level.coarser.as_ref();
            grids.push(Grid::new(&level.matrix, &level.fixed, next, false));
        }
        // an entry of a positive matrix is at most as large as the largest on the diagonal
        let largest = matrix.values.iter().fold(0.0, |m: f64, a| m.max(a.to_f64().abs()));
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let (free, values) = (Vec::new(), Vec::new());
        let coarsest = Coarsest { free, factors: None, was_cut: false, values, scale };
        let n = matrix.size();
        Self { grids, coarsest, scale, force: zeros(n), values: zeros(n) }
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
            // how the coarsest is solved is decided below
            if rest.len() > 1 {
                rest[0].prepare(self.scale);
            }
        }
        self.fix_coarsest()
    }

    fn fix_coarsest(&mut self) -> Result<(), FactorError> {
        let Some(last) = self.grids.last_mut() else { return Ok(()) };
        let free = (0..last.fixed.len() as u32).filter(|&i| !last.fixed[i as usize]);
        let free: Vec<u32> = free.collect();
        if free.len() > crate::linear::precondition::coarse_level::LARGEST_FACTORED {
            // a level that could not be coarsened any further is smoothed only
            self.coarsest.factors = None;
            last.prepare(self.scale);
            return Ok(());
        }
        // they would not know what became stale while there are factors
        last.sweeps = None;
        let is_cut = !last.cut.is_empty();
        let coarsest = &mut self.coarsest;
        let is_known = coarsest.factors.is_some() && free == coarsest.free;
        if !is_known || is_cut || coarsest.was_cut {
            coarsest.factors = None;
            coarsest.factors = Some(last.factor(&free)?);
            (coarsest.free, coarsest.was_cut) = (free, is_cut);
        }
        Ok(())
    }

    /// An approximate solution for a force.
    pub fn apply(&mut self, force: &[T], values: &mut [T]) {
        let largest = |range: std::ops::Range<usize>| {
            force[range].iter().fold(0.0, |m: f64, f| m.max(f.to_f64().abs()))
        };
        // a number that is not finite stays one, whatever it is divided by
        let largest = map(force.len(), largest).into_iter().fold(0.0, f64::max);
        let unit = if largest > 0.0 { largest } else { 1.0 };
        each_mut(&mut self.force, |range, single| {
            single.iter_mut().zip(&force[range]).for_each(|(s, f)| *s = (f.to_f64() / unit) as f32);
        });
        cycle(&mut self.grids, &mut self.coarsest, &self.force, &mut self.values);
        let (single, unit) = (&self.values, unit / self.scale);
        each_mut(values, |range, values| {
            let pairs = values.iter_mut().zip(&single[range]);
            pairs.for_each(|(v, &s)| *v = T::lit(f64::from(s) * unit));
        });
    }
}

fn cycle<T: Real>(
    grids: &mut [Grid<'_, T>],
    coarsest: &mut Coarsest<T>,
    force: &[f32],
    x: &mut [f32],
) {
    let Some((grid, rest)) = grids.split_first_mut() else { return };
    if rest.is_empty() && coarsest.factors.is_some() {
        coarsest.solve(force, x);
        return;
    }
    let Some(sweeps) = &grid.sweeps else { return };
    sweeps.forward(force, x, &mut grid.residual);
    if let (Some(transfer), Some(coarse)) = (grid.transfer, rest.first_mut()) {
        let mut coarse_force = std::mem::take(&mut coarse.force);
        let mut coarse_values = std::mem::take(&mut coarse.values);
        transfer.restrict(&grid.residual, &mut coarse_force);
        cycle(rest, coarsest, &coarse_force, &mut coarse_values);
        transfer.prolongate(&coarse_values, sweeps.inverse(), x);
        rest[0].force = coarse_force;
        rest[0].values = coarse_values;
    }
    sweeps.backward(force, x, &mut grid.residual);
}

impl<T: Real> Coarsest<T> {
    fn solve(&mut self, force: &[f32], x: &mut [f32]) {
        let Some(factors) = &self.factors else { return };
        self.values.clear();
        self.values.extend(self.free.iter().map(|&i| T::lit(f64::from(force[i as usize]))));
        factors.solve_in_place(&mut self.values, 1);
        x.fill(0.0);
        for (&i, value) in self.free.iter().zip(&self.values) {
            x[i as usize] = (value.to_f64() * self.scale) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::linear::precondition::coarse_level::P1Level;

    /// Conforming linear functions on an interval cut into `n`: `u'' = u` without boundary values.
    fn level(n: usize) -> P1Level<f64> {
        let h = 1.0 / n as f64;
        let (diagonal, beside) = (1.0 / h + h / 3.0, -1.0 / h + h / 6.0);
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..=n {
            for j in i.saturating_sub(1)..=(i + 1).min(n) {
                let cells = if i == 0 || i == n { 1.0 } else { 2.0 };
                matrix.columns.push(j as u32);
                matrix.values.push(if i == j { cells * diagonal } else { beside });
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        let parents = (0..=n as u32).map(|i| [i / 2, i.div_ceil(2)]).collect();
        let coarser = (n > 4).then(|| {
            let transfer = Prolongation::midpoints(parents, n / 2 + 1);
            CoarseLevel::new(Arc::new(level(n / 2)), Arc::new(transfer))
        });
        P1Level::new(matrix, vec![false; n + 1], coarser.flatten())
    }

    /// A cycle does not remember what was fixed before.
    #[test]
    fn what_was_fixed_before_leaves_no_trace() {
        let finest = level(64);
        let new = || Multigrid::new(&finest.matrix, finest.coarser.as_ref());
        let force: Vec<f64> = (0..65).map(|i| f64::from(i * i % 23) - 9.0).collect();
        let sets = [&[][..], &[40], &[31, 33], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], &[16, 17, 48]];
        let sets = sets.map(|set| (0..65).map(|i| set.contains(&i)).collect::<Vec<_>>());
        let mut answers = Vec::new();
        for (k, after) in sets.iter().enumerate() {
            let mut fresh = new();
            assert_eq!(fresh.grids.len(), 5);
            fresh.fix(after).unwrap();
            let mut expected = vec![0.0; 65];
            fresh.apply(&force, &mut expected);
            assert!(expected.iter().zip(after).all(|(x, &fixed)| fixed == (*x == 0.0)));
            for before in &sets {
                let mut used = new();
                used.fix(before).unwrap();
                used.fix(after).unwrap();
                let mut values = vec![0.0; 65];
                used.apply(&force, &mut values);
                assert_eq!(values, expected, "{k}");
            }
            answers.push(expected);
        }
        assert_ne!(answers[0], answers[1]);
    }
}
