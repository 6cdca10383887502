//! The rows of a coarse matrix that truncation changes, as Galerkin products with the matrix of the finer level.
//!
//! Coarse basis functions are truncated: their coefficients at fixed unknowns of the finer level are set to zero
//! (R. Kornhuber, Numer. Math. 69 (1994), 167-184).

use super::level::Level;
use crate::algebra::NO_INDEX;
use crate::linear::precondition::prolongation::Prolongation;
use crate::real::Real;

impl<T: Real> Level<'_, T> {
    /// Recomputes the rows that truncation at the fixed unknowns of the finer level may change, and marks these rows,
    /// and the rows of the last call, as outdated. The row of a free unknown is recomputed if one of the children of
    /// the unknown is fixed, or is coupled to a fixed unknown with a free parent, or has a recomputed row.
    pub(super) fn recompute_rows(&mut self, finer: &Level<'_, T>, prolongation: &Prolongation<T>) {
        let mut is_near = vec![false; finer.fixed.len()];
        // if all parents of a fixed unknown are fixed, as for most Dirichlet data, no free function is truncated there
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
}

/// The union of two sets, as an ascending list.
fn union(one: &[u32], other: &[u32]) -> Vec<u32> {
    let mut all = [one, other].concat();
    all.sort_unstable();
    all.dedup();
    all
}

/// Adds `weight` times a fine row, restricted to free unknowns and multiplied by the prolongation,
/// to the values of a coarse row. `places` has the position of each column among the values of the coarse row,
/// [`NO_INDEX`] for columns outside of its pattern; products in these columns are dropped.
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
