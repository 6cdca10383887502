//! The rows of a coarse matrix that truncation changes, as Galerkin products with the matrix of the finer level.
//!
//! Coarse basis functions are truncated: their coefficients at fixed unknowns of the finer level are set to zero
//! (R. Kornhuber, Numer. Math. 69 (1994), 167-184).

use std::ops::Range;

use super::level::Level;
use crate::algebra::{NO_INDEX, RectangularMatrix, SparseSum};
use crate::linear::precondition::prolongation::Prolongation;
use crate::parallel::vectors::{collect, indices, positions};
use crate::parallel::{for_each_item, split};
use crate::real::Real;

/// Rows that one task computes at least.
const ROWS_PER_TASK: usize = 64;

/// Most tasks of a level: each task has an index for every column.
const MAX_TASKS: usize = 32;

impl<T: Real> Level<'_, T> {
    /// Recomputes the rows that truncation at the fixed unknowns of the finer level may change, and marks all rows that
    /// have changed since the last call as outdated. The row of a free unknown is recomputed if one of the children of
    /// the unknown is fixed, or is coupled to a fixed unknown with a free parent, or has a recomputed row. A row that
    /// the last call recomputed keeps its values if no child, and no unknown coupled to a child, has been fixed or
    /// freed since the last call, and no row of a child is among `changed_rows`, the rows of the finer level that have
    /// changed.
    pub(super) fn recompute_rows(
        &mut self,
        (finer, changed_rows): (&Level<'_, T>, &[u32]),
        prolongation: &Prolongation<T>,
    ) {
        let (near, changed) = self.mark_children((finer, changed_rows), prolongation);
        let fixed = &self.fixed;
        let is_recomputed = |j: usize| !fixed[j] && prolongation.any_child(j, |i| near[i]);
        let rows = indices(fixed.len(), is_recomputed);
        let is_kept = collect(rows.len(), |k| {
            let j = rows[k] as usize;
            self.recomputed_index(j).is_some() && !prolongation.any_child(j, |i| changed[i])
        });
        let computed = rows.iter().zip(&is_kept).filter(|(_, is_kept)| !**is_kept);
        let mut outdated: Vec<u32> = computed.map(|(j, _)| *j).collect();
        let images = Images::new(finer, prolongation, &outdated);
        let (starts, values) = self.products((&rows, &is_kept), prolongation, &images);
        let given = self.recomputed_rows.iter().filter(|j| rows.binary_search(j).is_err());
        outdated.extend(given);
        outdated.sort_unstable();
        if self.prolongation.is_some() {
            // the next coarser level takes the list
            self.changed_rows.extend_from_slice(&outdated);
        }
        self.outdated = outdated;
        self.recomputed_indices = positions(self.matrix.size(), &rows);
        self.recomputed_rows = rows;
        self.recomputed_starts = starts;
        self.recomputed_values = values;
        self.fixed_on_finer.clone_from(&finer.fixed);
    }

    /// Flags of the unknowns of the finer level for which rows of their parents are recomputed, and of those for which
    /// these rows may have changed since the last call.
    fn mark_children(
        &self,
        (finer, changed_rows): (&Level<'_, T>, &[u32]),
        prolongation: &Prolongation<T>,
    ) -> (Vec<bool>, Vec<bool>) {
        let n = finer.fixed.len();
        // if all parents of a fixed unknown are fixed, as for most Dirichlet data, no free function is truncated there
        let is_truncated =
            |i: usize| finer.fixed[i] && prolongation.any_parent(i, |j| !self.fixed[j as usize]);
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

    /// The starts and the values of rows, and the number of values after the starts: rows that are kept from the last
    /// call, and Galerkin products for all others.
    fn products(
        &self,
        (rows, is_kept): (&[u32], &[bool]),
        prolongation: &Prolongation<T>,
        images: &Images<T>,
    ) -> (Vec<usize>, Vec<T>) {
        let columns = |j: u32| self.matrix.row(j as usize).0;
        let mut starts = Vec::with_capacity(rows.len() + 1);
        starts.push(0);
        let mut end = 0;
        starts.extend(rows.iter().map(|&j| {
            end += columns(j).len();
            end
        }));
        let mut values = vec![T::lit(0.0); end];
        let length = ROWS_PER_TASK.max(self.matrix.size() / MAX_TASKS);
        let ranges =
            || (0..rows.len()).step_by(length).map(|first| first..(first + length).min(rows.len()));
        let lengths = ranges().map(|range| starts[range.end] - starts[range.start]);
        let tasks = ranges().zip(split(&mut values, lengths)).collect();
        for_each_item(tasks, &|_, (range, mut values): (Range<usize>, &mut [T])| {
            let mut places = vec![NO_INDEX; self.matrix.size()];
            for k in range {
                let columns = columns(rows[k]);
                let (row, tail) = values.split_at_mut(columns.len());
                values = tail;
                if is_kept[k] {
                    row.copy_from_slice(self.row(rows[k] as usize).1);
                    continue;
                }
                (0..).zip(columns).for_each(|(place, &column)| places[column as usize] = place);
                prolongation.for_each_child(rows[k] as usize, |i, weight| {
                    if let Some((columns, image)) = images.row(i) {
                        for (&column, &value) in columns.iter().zip(image) {
                            // products outside of the pattern are dropped
                            if let Some(entry) = row.get_mut(places[column as usize] as usize) {
                                *entry += weight * value;
                            }
                        }
                    }
                });
                columns.iter().for_each(|&column| places[column as usize] = NO_INDEX);
            }
        });
        (starts, values)
    }
}

/// Rows of `A P`, with the matrix `A` of the finer level and the prolongation `P`, both restricted to free unknowns of
/// the finer level. Most unknowns have several parents: without these rows each parent would compute them anew.
struct Images<T> {
    /// The number of the row of each unknown of the finer level, [`NO_INDEX`] for an unknown without one.
    numbers: Vec<u32>,
    rows: RectangularMatrix<T>,
}

impl<T: Real> Images<T> {
    /// The rows of all free children of the unknowns `parents`.
    fn new(finer: &Level<'_, T>, prolongation: &Prolongation<T>, parents: &[u32]) -> Self {
        let n = finer.fixed.len();
        let mut is_child = vec![false; n];
        for &j in parents {
            prolongation.for_each_child(j as usize, |i, _| is_child[i] = true);
        }
        let children = indices(n, |i| is_child[i] && !finer.fixed[i]);
        let numbers = positions(n, &children);
        let n_coarse = prolongation.n_coarse();
        let rows = RectangularMatrix::by_groups(children.len(), &|range| {
            let mut sum = SparseSum::new(n_coarse);
            RectangularMatrix::by_rows(range, |k, columns, values| {
                let (neighbours, entries) = finer.row(children[k] as usize);
                let free =
                    neighbours.iter().zip(entries).filter(|(j, _)| !finer.fixed[**j as usize]);
                for (&j, &a) in free {
                    prolongation.for_each_parent(j as usize, |parent, weight| {
                        sum.add_term(parent, a * weight);
                    });
                }
                sum.move_to(columns, values);
            })
        });
        Self { numbers, rows }
    }

    /// Columns and values of the row of an unknown, if it has one.
    #[inline(always)]
    fn row(&self, i: usize) -> Option<(&[u32], &[T])> {
        let number = self.numbers[i];
        (number != NO_INDEX).then(|| self.rows.row(number as usize))
    }
}
