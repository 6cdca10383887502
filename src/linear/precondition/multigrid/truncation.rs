//! The rows of a coarse matrix that truncation changes, as Galerkin products with the matrix of the finer level.
//!
//! Coarse basis functions are truncated: their coefficients at fixed unknowns of the finer level are set to zero
//! (R. Kornhuber, Numer. Math. 69 (1994), 167-184).

use super::level::Level;
use crate::algebra::{NO_INDEX, SparseMatrix, SparseSum};
use crate::linear::precondition::prolongation::Prolongation;
use crate::parallel::vectors::{indices, positions};
use crate::parallel::{for_each_item, split};
use crate::real::Real;

/// Rows that one task computes at least.
const ROWS_PER_TASK: usize = 64;

/// Most tasks of a level: each task has an index for every column.
const MAX_TASKS: usize = 32;

impl<T: Real> Level<'_, T> {
    /// Recomputes the rows that truncation at the fixed unknowns of the finer level may change, gives those their
    /// values back that it no longer changes, and marks all rows that have changed since the last call as outdated. The
    /// row of a free unknown is recomputed if one of the children of the unknown is fixed, or is coupled to a fixed
    /// unknown with a free parent, or has a recomputed row. A row that the last call recomputed keeps its values if no
    /// child, and no unknown coupled to a child, has been fixed or freed since the last call, and no row of a child is
    /// among `changed_rows`, the rows of the finer level that have changed.
    pub(super) fn recompute_rows(
        &mut self,
        (finer, changed_rows): (&Level<'_, T>, &[u32]),
        prolongation: &Prolongation,
    ) {
        let (near, changed) = self.mark_children((finer, changed_rows), prolongation);
        let has_child = |j: usize, of: &[bool]| prolongation.children(j).any(|(i, _)| of[i]);
        let fixed = &self.fixed;
        let recomputed = indices(fixed.len(), |j| !fixed[j] && has_child(j, &near));
        let is_in = |list: &[u32], j: u32| list.binary_search(&j).is_ok();
        let before = std::mem::take(&mut self.recomputed_rows);
        let is_outdated = |&j: &u32| !is_in(&before, j) || has_child(j as usize, &changed);
        let computed: Vec<u32> = recomputed.iter().copied().filter(is_outdated).collect();
        let given: Vec<u32> = before.iter().copied().filter(|&j| !is_in(&recomputed, j)).collect();
        if let Some(matrix) = self.given
            && !(computed.is_empty() && given.is_empty())
        {
            let own = self.matrix.to_mut();
            for &j in &given {
                own.row_mut(j as usize).1.copy_from_slice(matrix.row(j as usize).1);
            }
            let images = Images::new(finer, prolongation, &computed);
            images.recompute(own, &computed, prolongation);
        }
        self.outdated = [computed, given].concat();
        self.outdated.sort_unstable();
        if self.prolongation.is_some() {
            // the next coarser level takes the list
            self.changed_rows.extend_from_slice(&self.outdated);
        }
        self.recomputed_rows = recomputed;
        self.fixed_on_finer.clone_from(&finer.fixed);
    }

    /// Flags of the unknowns of the finer level for which rows of their parents are recomputed, and of those for which
    /// these rows may have changed since the last call.
    fn mark_children(
        &self,
        (finer, changed_rows): (&Level<'_, T>, &[u32]),
        prolongation: &Prolongation,
    ) -> (Vec<bool>, Vec<bool>) {
        let n = finer.fixed.len();
        // if all parents of a fixed unknown are fixed, as for most Dirichlet data, no free function is truncated there
        let is_truncated =
            |i: usize| finer.fixed[i] && prolongation.parents(i).any(|(j, _)| !self.fixed[j]);
        let mut near = vec![false; n];
        let mut changed = vec![false; n];
        let mark = |flags: &mut [bool], i: u32| {
            flags[i as usize] = true;
            finer.matrix.row(i as usize).0.iter().for_each(|&j| flags[j as usize] = true);
        };
        indices(n, is_truncated).iter().for_each(|&i| mark(&mut near, i));
        finer.recomputed_rows.iter().for_each(|&i| near[i as usize] = true);
        let before = &self.fixed_on_finer;
        let has_changed = indices(before.len(), |i| before[i] != finer.fixed[i]);
        has_changed.iter().for_each(|&i| mark(&mut changed, i));
        changed_rows.iter().for_each(|&i| changed[i as usize] = true);
        (near, changed)
    }
}

/// Rows of `A P`, with the matrix `A` of the finer level and the prolongation `P`, both restricted to free unknowns of
/// the finer level. Most unknowns have several parents: without these rows each parent would compute them anew.
struct Images<T> {
    /// The number of the row of each unknown of the finer level, [`NO_INDEX`] for an unknown without one.
    numbers: Vec<u32>,
    rows: SparseMatrix<T>,
}

impl<T: Real> Images<T> {
    /// The rows of all free children of the unknowns `parents`.
    fn new(finer: &Level<'_, T>, prolongation: &Prolongation, parents: &[u32]) -> Self {
        let n = finer.fixed.len();
        let mut is_child = vec![false; n];
        for &j in parents {
            prolongation.children(j as usize).for_each(|(i, _)| is_child[i] = true);
        }
        let children = indices(n, |i| is_child[i] && !finer.fixed[i]);
        let numbers = positions(n, &children);
        let n_coarse = prolongation.n_coarse();
        let rows = SparseMatrix::by_groups(children.len(), &|range| {
            let mut sum = SparseSum::new(n_coarse);
            SparseMatrix::by_rows(range, |k, columns, values| {
                let (neighbours, entries) = finer.matrix.row(children[k] as usize);
                let free =
                    neighbours.iter().zip(entries).filter(|(j, _)| !finer.fixed[**j as usize]);
                for (&j, &a) in free {
                    sum.add(a, prolongation.rows().row(j as usize));
                }
                sum.move_to(columns, values);
            })
        });
        Self { numbers, rows }
    }

    /// Replaces rows of the coarse matrix by the products of the transposed prolongation with these rows.
    fn recompute(&self, coarse: &mut SparseMatrix<T>, rows: &[u32], prolongation: &Prolongation) {
        let n = coarse.size();
        let SparseMatrix { row_starts, columns, values } = coarse;
        let start = |row: u32| row_starts[row as usize] as usize;
        let tasks = || rows.chunks(ROWS_PER_TASK.max(n / MAX_TASKS));
        // the values from the first row of a task on, up to the first row of the next one
        let n_values = values.len();
        let ends = tasks().skip(1).map(|rows| start(rows[0])).chain([n_values]);
        let lengths = tasks().zip(ends).map(|(rows, end)| end - start(rows[0]));
        let first = rows.first().map_or(n_values, |&row| start(row));
        let tasks = tasks().zip(split(&mut values[first..], lengths)).collect();
        for_each_item(tasks, &|_, (rows, values): (&[u32], &mut [T])| {
            let mut places = vec![NO_INDEX; n];
            for &j in rows {
                let columns = &columns[start(j)..start(j + 1)];
                let row = &mut values[start(j) - start(rows[0])..][..columns.len()];
                row.fill(T::lit(0.0));
                (0..).zip(columns).for_each(|(place, &column)| places[column as usize] = place);
                for (i, weight) in prolongation.children(j as usize) {
                    if self.numbers[i] == NO_INDEX {
                        continue;
                    }
                    let (columns, image) = self.rows.row(self.numbers[i] as usize);
                    for (&column, &value) in columns.iter().zip(image) {
                        // products outside of the pattern are dropped
                        if let Some(entry) = row.get_mut(places[column as usize] as usize) {
                            *entry += T::lit(weight.into()) * value;
                        }
                    }
                }
                columns.iter().for_each(|&column| places[column as usize] = NO_INDEX);
            }
        });
    }
}
