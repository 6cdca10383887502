//! A multigrid V-cycle for conforming linear functions with fixed unknowns.
//!
//! The finest level may have another finite element (J. Xu, Computing 56 (1996), 215-235; for discontinuous
//! functions B. Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36). Smoothing before and after
//! the correction takes a third of the iterations that the sum of both takes.
//!
//! On each level, unknown `i` is the coefficient of basis function `i`, and row `i` of the matrix
//! is its equation. On a mesh it is the value at vertex `i`.

use std::borrow::Cow;

use super::coarse_level::{CoarseLevel, MAX_COARSEST_FACTORED, P1Level};
use super::gauss_seidel::GaussSeidel;
use super::preconditioner::Preconditioner;
use super::prolongation::Prolongation;
use super::smoother::Smoother;
use crate::algebra::{NO_INDEX, SparseMatrix};
use crate::linear::direct::{FactorError, Factors};
use crate::parallel::vectors::{for_each_chunk, map_chunks, zeros};
use crate::real::Real;

/// If at most one in so many rows is outdated, the outdated rows of a smoother are replaced, which
/// is then faster than a new smoother.
const ROWS_PER_OUTDATED_ROW: usize = 8;

/// A V-cycle with one forward Gauss-Seidel iteration before and one backward iteration after the
/// coarse correction: symmetric and positive definite.
///
/// Coarse basis functions are truncated: their coefficients at fixed unknowns of the finer level
/// are set to zero (R. Kornhuber, Numer. Math. 69 (1994), 167-184). The matrix of a level is the
/// given one, except for the rows that truncation may change, those of truncated functions and of
/// functions near them: these rows are Galerkin products with the matrix of the finer level.
///
/// All levels but a factored coarsest one work in single precision, with the matrices of all levels
/// divided by the largest entry of the finest matrix, and the right-hand side by its largest entry.
/// A preconditioner need not be exact, and the time is limited by memory bandwidth: numbers with
/// half the bytes of `f64` take half the time. Right-hand side and result are in the scalar `T`.
pub(crate) struct Multigrid<'a, T: Real> {
    levels: Vec<Level<'a, T>>,
    coarsest: CoarsestSolver<T>,
    /// The divisor of the matrices of all levels: the largest absolute entry of the finest matrix.
    scale: f64,
    right_side: Vec<f32>,
    values: Vec<f32>,
    /// The name in reports.
    name: &'static str,
}

struct Level<'a, T: Real> {
    /// Number of unknowns of a cell if cells share none and are smoothed as blocks, else one.
    cell_size: usize,
    /// The unknowns that are not fixed, but not smoothed either; empty for all levels but the finest.
    kept: Vec<u32>,
    /// Further fixed unknowns besides those with Dirichlet data; empty for none.
    fixed_besides: Vec<bool>,
    /// The given matrix, without truncation.
    matrix: Cow<'a, SparseMatrix<T>>,
    /// The rows that may differ from the given matrix because of truncation, ascending.
    recomputed_rows: Vec<u32>,
    /// Start of each of these rows in `recomputed_values`, and the number of values at the end.
    recomputed_starts: Vec<usize>,
    /// The values of these rows, one row after the other; the columns are those of the given matrix.
    recomputed_values: Vec<T>,
    /// The rows that have changed since the smoother was updated, ascending.
    outdated: Vec<u32>,
    /// The prolongation from the next coarser level; `None` for the coarsest.
    prolongation: Option<Cow<'a, Prolongation<T>>>,
    /// The unknowns with Dirichlet data; empty for the finest level.
    dirichlet: &'a [bool],
    /// `None` before the first use, and on a factored coarsest level.
    smoother: Option<Smoother>,
    /// The fixed unknowns.
    fixed: Vec<bool>,
    right_side: Vec<f32>,
    values: Vec<f32>,
    residual: Vec<f32>,
}

/// The factors of the coarsest level on its free unknowns; without factors the level is smoothed.
struct CoarsestSolver<T> {
    free: Vec<u32>,
    factors: Option<Factors<T>>,
    /// Whether the matrix of the factors has recomputed rows.
    has_recomputed_rows: bool,
    values: Vec<T>,
    scale: f64,
}

impl<'a, T: Real> Level<'a, T> {
    /// The finest level.
    fn finest(
        matrix: Cow<'a, SparseMatrix<T>>,
        prolongation: Option<Cow<'a, Prolongation<T>>>,
    ) -> Self {
        let n = matrix.size();
        Self {
            cell_size: 1,
            kept: Vec::new(),
            fixed_besides: Vec::new(),
            matrix,
            recomputed_rows: Vec::new(),
            recomputed_starts: vec![0],
            recomputed_values: Vec::new(),
            outdated: Vec::new(),
            prolongation,
            dirichlet: &[],
            smoother: None,
            fixed: vec![false; n],
            right_side: Vec::new(),
            values: Vec::new(),
            residual: zeros(n),
        }
    }

    /// A coarser level.
    fn coarser(level: &'a P1Level<T>) -> Self {
        let prolongation = level.coarser.as_ref().map(|c| Cow::Borrowed(&*c.prolongation));
        let n = level.size();
        Self {
            dirichlet: &level.fixed,
            right_side: zeros(n),
            values: zeros(n),
            ..Self::finest(Cow::Borrowed(&level.matrix), prolongation)
        }
    }
}

impl<T: Real> Level<'_, T> {
    /// Columns and values of row `i`, after truncation.
    fn row(&self, i: usize) -> (&[u32], &[T]) {
        let (columns, values) = self.matrix.row(i);
        match self.recomputed_rows.binary_search(&(i as u32)) {
            Ok(k) if !self.recomputed_rows.is_empty() => {
                let range = self.recomputed_starts[k]..self.recomputed_starts[k + 1];
                (columns, &self.recomputed_values[range])
            }
            _ => (columns, values),
        }
    }

    /// The Cholesky factor on the unknowns `free`. Truncated functions can be linearly dependent;
    /// the matrix is then made positive definite by multiplication of its diagonal by
    /// `1 + sqrt(eps)`, `eps` machine epsilon.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor(&self, free: &[u32]) -> Result<Factors<T>, FactorError> {
        if self.recomputed_rows.is_empty() {
            return Factors::new(&self.matrix, true, free);
        }
        let mut matrix = SparseMatrix::clone(&self.matrix);
        for &j in &self.recomputed_rows {
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

    /// Recomputes the rows that truncation at the fixed unknowns of the finer level may change, and
    /// marks them, with all rows recomputed before, as outdated. A free unknown is concerned if one
    /// of its children is fixed, is coupled to a fixed unknown with a free parent, or has a recomputed
    /// row itself.
    fn recompute_rows(&mut self, finer: &Level<'_, T>, prolongation: &Prolongation<T>) {
        let mut is_near = vec![false; finer.fixed.len()];
        // where all parents are fixed, as at most Dirichlet data, no free function is truncated
        let is_truncated =
            |&i: &usize| finer.fixed[i] && prolongation.any_parent(i, |j| !self.fixed[j as usize]);
        for i in (0..is_near.len()).filter(is_truncated) {
            is_near[i] = true;
            finer.matrix.row(i).0.iter().for_each(|&j| is_near[j as usize] = true);
        }
        finer.recomputed_rows.iter().for_each(|&i| is_near[i as usize] = true);
        let fixed = &self.fixed;
        let is_recomputed = |j: usize| !fixed[j] && prolongation.any_child(j, |i| is_near[i]);
        let recomputed_rows: Vec<u32> =
            (0..fixed.len()).filter(|&j| is_recomputed(j)).map(|j| j as u32).collect();
        self.outdated = union(&self.recomputed_rows, &recomputed_rows);
        self.recomputed_rows = recomputed_rows;
        self.recomputed_values.clear();
        self.recomputed_starts.truncate(1);
        let mut places = vec![NO_INDEX; self.matrix.size()];
        for &j in &self.recomputed_rows {
            let columns = self.matrix.row(j as usize).0;
            let start = self.recomputed_values.len();
            self.recomputed_values.resize(start + columns.len(), T::lit(0.0));
            let values = &mut self.recomputed_values[start..];
            (0..).zip(columns).for_each(|(place, &column)| places[column as usize] = place);
            prolongation.for_each_child(j as usize, |i, weight| {
                if !finer.fixed[i] {
                    add_row(finer.row(i), &finer.fixed, prolongation, weight, (&places, values));
                }
            });
            columns.iter().for_each(|&column| places[column as usize] = NO_INDEX);
            self.recomputed_starts.push(self.recomputed_values.len());
        }
    }

    /// Updates the smoother to the rows and the fixed unknowns of the level.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if the block of a cell is not positive definite.
    fn update_smoother(&mut self, scale: f64) -> Result<(), FactorError> {
        let mut smoother = match self.smoother.take() {
            Some(Smoother::Unknowns(smoother)) => {
                Smoother::Unknowns(self.smoother_by_unknowns(Some(smoother), scale))
            }
            // the finest level, whose rows stay as they are
            Some(by_cells) => by_cells,
            None => Smoother::by_cells(&self.matrix, self.cell_size, scale)
                .unwrap_or_else(|| Smoother::Unknowns(self.smoother_by_unknowns(None, scale))),
        };
        self.outdated.clear();
        smoother.set_fixed(&self.fixed, &self.kept)?;
        self.smoother = Some(smoother);
        Ok(())
    }

    /// The smoother by unknowns for the present rows, from the one before if few rows are outdated.
    fn smoother_by_unknowns(&self, before: Option<GaussSeidel>, scale: f64) -> GaussSeidel {
        let few = self.matrix.size() / ROWS_PER_OUTDATED_ROW;
        match before {
            Some(mut smoother) if self.outdated.len() <= few => {
                smoother.replace_rows(&self.outdated, |i| self.row(i), scale);
                smoother
            }
            _ if self.recomputed_rows.is_empty() => {
                GaussSeidel::new(&self.matrix, |i| self.matrix.row(i), scale)
            }
            _ => GaussSeidel::new(&self.matrix, |i| self.row(i), scale),
        }
    }
}

/// The union of two sets, as an ascending list.
fn union(one: &[u32], other: &[u32]) -> Vec<u32> {
    let mut all = [one, other].concat();
    all.sort_unstable();
    all.dedup();
    all
}

/// The positions of row `j` in the columns and values of a matrix.
fn row_range<T>(matrix: &SparseMatrix<T>, j: u32) -> std::ops::Range<usize> {
    let j = j as usize;
    matrix.row_starts[j] as usize..matrix.row_starts[j + 1] as usize
}

/// Adds `weight` times a fine row, restricted to free unknowns and multiplied by the prolongation,
/// to the values of a coarse row, by the places of its columns among these values. Products in other
/// columns are dropped.
fn add_row<T: Real>(
    (neighbours, entries): (&[u32], &[T]),
    fixed: &[bool],
    prolongation: &Prolongation<T>,
    weight: T,
    (places, values): (&[u32], &mut [T]),
) {
    for (&k, &a) in neighbours.iter().zip(entries) {
        if fixed[k as usize] {
            continue;
        }
        prolongation.for_each_parent(k as usize, |parent, parent_weight| {
            let place = places[parent as usize];
            if place != NO_INDEX {
                values[place as usize] += weight * a * parent_weight;
            }
        });
    }
}

impl<'a, T: Real> Multigrid<'a, T> {
    /// The cycle for a matrix with its coarser levels. [`Multigrid::set_fixed`] must be called before
    /// the first use.
    pub fn new(matrix: &'a SparseMatrix<T>, coarser: Option<&'a CoarseLevel<T>>) -> Self {
        let prolongation = coarser.map(|c| Cow::Borrowed(&*c.prolongation));
        let finest = Level::finest(Cow::Borrowed(matrix), prolongation);
        Self::with_finest(finest, coarser.map(|c| &*c.level))
    }

    /// The cycle for the matrix of another finite element on the mesh of a level, with the
    /// `prolongation` from the conforming linear functions of the level: these are the auxiliary space
    /// of the element. `cell_size` is the number of unknowns of a cell if cells own their unknowns, else
    /// one.
    pub fn of_element(
        matrix: Cow<'a, SparseMatrix<T>>,
        prolongation: Prolongation<T>,
        level: &'a P1Level<T>,
        cell_size: usize,
    ) -> Self {
        let finest = Level::finest(matrix, Some(Cow::Owned(prolongation)));
        let all = Self::with_finest(Level { cell_size, ..finest }, Some(level));
        Self { name: "auxiliary-space", ..all }
    }

    /// As [`Multigrid::set_fixed`], with two further sets: unknowns `kept` of the finest level that are
    /// corrected by the coarser levels alone, and unknowns `fixed_on_next` of the next coarser level
    /// that are fixed besides those with Dirichlet data.
    ///
    /// # Errors
    /// See [`Multigrid::set_fixed`].
    pub fn set_fixed_and_kept(
        &mut self,
        fixed: &[bool],
        kept: &[u32],
        fixed_on_next: &[bool],
    ) -> Result<(), FactorError> {
        self.levels[0].kept.clear();
        self.levels[0].kept.extend_from_slice(kept);
        if let Some(next) = self.levels.get_mut(1) {
            next.fixed_besides.clear();
            next.fixed_besides.extend_from_slice(fixed_on_next);
        }
        self.set_fixed(fixed)
    }

    /// The cycle with a finest level, and the levels from `coarser` on.
    fn with_finest(finest: Level<'a, T>, coarser: Option<&'a P1Level<T>>) -> Self {
        let matrix = &finest.matrix;
        let n = matrix.size();
        let largest = matrix.values.iter().fold(0.0, |m: f64, a| m.max(a.to_f64().abs()));
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let (free, values) = (Vec::new(), Vec::new());
        let coarsest =
            CoarsestSolver { free, factors: None, has_recomputed_rows: false, values, scale };
        let mut levels = vec![finest];
        let mut next = coarser;
        while let Some(level) = next {
            levels.push(Level::coarser(level));
            next = level.coarser.as_ref().map(|c| &*c.level);
        }
        let (right_side, values) = (zeros(n), zeros(n));
        Self { levels, coarsest, scale, right_side, values, name: "multigrid" }
    }

    /// Sets the fixed unknowns of the finest level, and of all coarser levels those with Dirichlet
    /// data or all of whose children are fixed.
    ///
    /// # Errors
    /// [`FactorError`] if the matrix of the coarsest level is not positive definite.
    pub fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.levels[0].fixed.copy_from_slice(fixed);
        for k in 0..self.levels.len() {
            let (finer, rest) = self.levels.split_at_mut(k);
            let level = &mut rest[0];
            if let Some(finer) = finer.last() {
                level.fixed.copy_from_slice(level.dirichlet);
                let fixed_besides = level.fixed.iter_mut().zip(&level.fixed_besides);
                fixed_besides.for_each(|(fixed, besides)| *fixed |= besides);
                if let Some(prolongation) = &finer.prolongation {
                    // functions that truncation sets to zero
                    prolongation.fix_covered(&finer.fixed, &mut level.fixed);
                    level.recompute_rows(finer, prolongation);
                }
            }
            let is_coarsest = rest.len() == 1;
            if !is_coarsest {
                rest[0].update_smoother(self.scale)?;
            }
        }
        self.update_coarsest()
    }

    /// Factors the coarsest level, or updates its smoother if it is too large for factors.
    fn update_coarsest(&mut self) -> Result<(), FactorError> {
        let Some(level) = self.levels.last_mut() else { return Ok(()) };
        let free = (0..level.fixed.len() as u32).filter(|&i| !level.fixed[i as usize]);
        let free: Vec<u32> = free.collect();
        if free.len() > MAX_COARSEST_FACTORED {
            self.coarsest.factors = None;
            level.update_smoother(self.scale)?;
            return Ok(());
        }
        // Discarded, because its rows are not updated while factors are used.
        level.smoother = None;
        let has_recomputed_rows = !level.recomputed_rows.is_empty();
        let coarsest = &mut self.coarsest;
        let is_same_set = coarsest.factors.is_some() && free == coarsest.free;
        if !is_same_set || has_recomputed_rows || coarsest.has_recomputed_rows {
            coarsest.factors = None;
            coarsest.factors = Some(level.factor(&free)?);
            (coarsest.free, coarsest.has_recomputed_rows) = (free, has_recomputed_rows);
        }
        Ok(())
    }

    /// Sets `values` to the result of one cycle from zero for a right-hand side.
    pub fn apply(&mut self, right_side: &[T], values: &mut [T]) {
        let largest = |range: std::ops::Range<usize>| {
            right_side[range].iter().fold(0.0, |m: f64, f| m.max(f.to_f64().abs()))
        };
        // A number that is not finite stays so after the division.
        let largest = map_chunks(right_side.len(), largest).into_iter().fold(0.0, f64::max);
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

impl<T: Real> Preconditioner<T> for Multigrid<'_, T> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        Multigrid::set_fixed(self, fixed)
    }

    fn apply(&mut self, r: &[T], z: &mut [T]) {
        Multigrid::apply(self, r, z);
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
    if coarser.is_empty() && coarsest.factors.is_some() {
        coarsest.solve(right_side, x);
        return;
    }
    let Some(smoother) = &level.smoother else { return };
    smoother.forward(right_side, x, &mut level.residual);
    if let (Some(prolongation), Some(coarse)) = (&level.prolongation, coarser.first_mut()) {
        let mut coarse_right_side = std::mem::take(&mut coarse.right_side);
        let mut coarse_values = std::mem::take(&mut coarse.values);
        prolongation.restrict(&level.residual, &mut coarse_right_side);
        cycle(coarser, coarsest, &coarse_right_side, &mut coarse_values);
        prolongation.add_prolongation(&coarse_values, smoother.mask(), x);
        coarser[0].right_side = coarse_right_side;
        coarser[0].values = coarse_values;
    }
    smoother.backward(right_side, x, &mut level.residual);
}

impl<T: Real> CoarsestSolver<T> {
    /// Sets `x` to the solution with the factors on free unknowns, and to zero on fixed ones.
    fn solve(&mut self, right_side: &[f32], x: &mut [f32]) {
        let Some(factors) = &self.factors else { return };
        self.values.clear();
        self.values.extend(self.free.iter().map(|&i| T::lit(f64::from(right_side[i as usize]))));
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

    /// Conforming linear functions on `n` equal intervals of (0, 1), for `-u'' + u` with natural
    /// boundary conditions.
    fn level(n: usize) -> P1Level<f64> {
        let h = 1.0 / n as f64;
        let (diagonal, off_diagonal) = (1.0 / h + h / 3.0, -1.0 / h + h / 6.0);
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..=n {
            for j in i.saturating_sub(1)..=(i + 1).min(n) {
                let cells = if i == 0 || i == n { 1.0 } else { 2.0 };
                matrix.columns.push(j as u32);
                matrix.values.push(if i == j { cells * diagonal } else { off_diagonal });
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        let parents = (0..=n as u32).map(|i| [i / 2, i.div_ceil(2)]).collect();
        let coarser = (n > 4).then(|| {
            let prolongation = Prolongation::midpoints(parents, n / 2 + 1);
            CoarseLevel::new(Arc::new(level(n / 2)), Arc::new(prolongation))
        });
        P1Level::new(matrix, vec![false; n + 1], coarser.flatten()).unwrap()
    }

    /// The result of a cycle is independent of earlier sets of fixed unknowns.
    #[test]
    fn a_cycle_depends_on_the_last_fixed_set_only() {
        let finest = level(64);
        let new = || Multigrid::new(&finest.matrix, finest.coarser.as_ref());
        let right_side: Vec<f64> = (0..65).map(|i| f64::from(i * i % 23) - 9.0).collect();
        let sets = [&[][..], &[40], &[31, 33], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], &[16, 17, 48]];
        let sets = sets.map(|set| (0..65).map(|i| set.contains(&i)).collect::<Vec<_>>());
        let mut results = Vec::new();
        for (k, after) in sets.iter().enumerate() {
            let mut fresh = new();
            assert_eq!(fresh.levels.len(), 5);
            fresh.set_fixed(after).unwrap();
            let mut expected = vec![0.0; 65];
            fresh.apply(&right_side, &mut expected);
            assert!(expected.iter().zip(after).all(|(x, &fixed)| fixed == (*x == 0.0)));
            for before in &sets {
                let mut used = new();
                used.set_fixed(before).unwrap();
                used.set_fixed(after).unwrap();
                let mut values = vec![0.0; 65];
                used.apply(&right_side, &mut values);
                assert_eq!(values, expected, "{k}");
            }
            results.push(expected);
        }
        assert_ne!(results[0], results[1]);
    }
}
