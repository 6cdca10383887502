//! The prediction of the active set of a cell by the inequality of its unknowns, with all other values held.
//!
//! A penalty on jumps of means couples unknowns so strongly that the violation of one of them alone says little: where
//! this unknown changes its state, others violate their bounds in the next system. The inequality of a cell takes its
//! unknowns together: radial-3d, `wopsip`, 32 takes 13 systems for 18. Vertex values of triangles keep the prediction of
//! single unknowns, which takes fewer systems on coarse meshes.
//!
//! For an M-matrix, bounds from below and exactly solved systems the iteration remains finite. The solution of a cell
//! has no value below the present one, so that the solutions of all cells, put together, have no negative residual on
//! the new inactive unknowns. The next values are not below these solutions, and some of them are larger than the
//! present ones unless every cell is solved: no active set returns. The argument covers cells that change single
//! unknowns, with the values of these unknowns raised to their bounds.
//!
//! A cell with free or fixed unknowns keeps the prediction of its single unknowns: the values of the neighbours, which
//! are held, would hold the free values too.

use super::contact_state::{prescribed_value, violated_bound};
use super::evaluation::{Evaluation, ROUNDING_BAND};
use super::iterate::Iterate;
use super::linear_solver::LinearSolver;
use crate::algebra::dense::invert_positive_definite;
use crate::algebra::{Bound, Contact};
use crate::parallel::vectors::{concat, map_chunks};
use crate::real::Real;

/// The state changes that follow from the inequalities of the cells in which, by an evaluation, single unknowns change
/// their states. `None` if the unknowns are predicted one by one: without a penalty on jumps of means, and for
/// vertex values of triangles.
///
/// A cell keeps the changes of its single unknowns if some of its unknowns are free or fixed, if its inequality changes
/// no state, because the linear system was not solved accurately, or if rounding hides its solution.
pub(super) fn changes_of_cells<T: Real>(
    iterate: &Iterate<'_, T>,
    evaluation: &Evaluation,
    solver: &dyn LinearSolver<T>,
) -> Option<Vec<(u32, Contact)>> {
    let penalised = iterate.inequality.penalised.as_ref()?;
    let predict = match (penalised.block_size(), penalised.mean_jumps.as_ref()?.are_means) {
        (3, false) => return None,
        (3, true) => changes_by_cells::<T, 3>,
        _ => changes_by_cells::<T, 4>,
    };
    Some(predict(iterate, evaluation, solver))
}

/// The state changes of [`changes_of_cells`], for cells with `N` unknowns.
fn changes_by_cells<T: Real, const N: usize>(
    iterate: &Iterate<'_, T>,
    evaluation: &Evaluation,
    solver: &dyn LinearSolver<T>,
) -> Vec<(u32, Contact)> {
    let cell_of = |change: &(u32, Contact)| change.0 as usize / N;
    let bound_tolerance = evaluation.bound_tolerance::<T>();
    let changes = &evaluation.state_changes;
    let cells: Vec<&[_]> = changes.chunk_by(|a, b| cell_of(a) == cell_of(b)).collect();
    concat(map_chunks(cells.len(), |range| {
        let mut of_chunk = Vec::new();
        for &of_unknowns in &cells[range] {
            let first = cell_of(&of_unknowns[0]) * N;
            let is_above_rounding = |k, r| iterate.is_above_rounding(first + k, r, solver);
            let states = CellInequality::<T, N>::new(iterate, first)
                .and_then(|cell| cell.states(bound_tolerance, is_above_rounding));
            let n_before = of_chunk.len();
            for (i, new) in (first..).zip(states.into_iter().flatten()) {
                if new != iterate.states[i] {
                    of_chunk.push((i as u32, new));
                }
            }
            if of_chunk.len() == n_before {
                of_chunk.extend_from_slice(of_unknowns);
            }
        }
        of_chunk
    }))
}

/// The inequality of the `N` unknowns of a cell, for the steps from the present values to the solution.
struct CellInequality<'a, T, const N: usize> {
    /// Symmetric and positive definite.
    matrix: [[f64; N]; N],
    /// The residual at the present values.
    residual: &'a [f64],
    values: &'a [T],
    bounds: &'a [Bound<T>],
    /// The states of the iterate.
    states: [Contact; N],
}

impl<'a, T: Real, const N: usize> CellInequality<'a, T, N> {
    /// The inequality of the unknowns from `first` on; `None` if some of them are free or fixed.
    fn new(iterate: &'a Iterate<'_, T>, first: usize) -> Option<Self> {
        let of_cell = first..first + N;
        let bounds = &iterate.inequality.bounds[of_cell.clone()];
        let row = |k: usize| {
            let (columns, entries) = iterate.inequality.matrix.row(first + k);
            let mut row = [0.0; N];
            for (&j, a) in columns.iter().zip(entries) {
                if of_cell.contains(&(j as usize)) {
                    row[j as usize - first] = a.to_f64();
                }
            }
            row
        };
        bounds.iter().all(Bound::is_inequality).then(|| Self {
            matrix: std::array::from_fn(row),
            residual: &iterate.residual[of_cell.clone()],
            values: &iterate.values[of_cell.clone()],
            bounds,
            states: std::array::from_fn(|k| iterate.states[first + k]),
        })
    }

    /// The states of the solution, `None` if it is not found; `is_above_rounding(k, r)` tells whether a multiplier `r`
    /// of unknown `k` is larger than its rounding.
    ///
    /// The first unknown that violates a condition changes its state, until none does (K. G. Murty, Opsearch 11 (1974),
    /// 123-130). This ends after less than `3^N` changes: the residual of the last unknown decreases in its value, so
    /// that this unknown changes its state twice at most, and between these changes the same holds for the other
    /// unknowns.
    fn states(
        &self,
        bound_tolerance: f64,
        is_above_rounding: impl Fn(usize, f64) -> bool,
    ) -> Option<[Contact; N]> {
        let mut states = self.states;
        for _ in 0..3_usize.pow(N as u32) {
            let steps = self.steps(&states)?;
            let change =
                |k| self.change(k, (states[k], &steps), bound_tolerance, &is_above_rounding);
            match (0..N).find_map(|k| change(k).map(|state| (k, state))) {
                Some((k, state)) => states[k] = state,
                None => return Some(states),
            }
        }
        None
    }

    /// The new state of unknown `k` if the unknown violates a condition after `steps`, which are those of the states of
    /// the cell; `state` is the present one.
    fn change(
        &self,
        k: usize,
        (state, steps): (Contact, &[f64; N]),
        bound_tolerance: f64,
        is_above_rounding: impl Fn(usize, f64) -> bool,
    ) -> Option<Contact> {
        let bound = &self.bounds[k];
        if bound.fixed_value().is_some() {
            return None;
        }
        let wrong_multiplier = match state {
            Contact::Inactive => {
                let x = self.values[k].to_f64() + steps[k];
                return violated_bound(bound, x, bound_tolerance).map(|(state, _)| state);
            }
            Contact::Lower => self.residual_after(k, steps),
            Contact::Upper => -self.residual_after(k, steps),
        };
        let terms = self.matrix[k].iter().zip(steps).map(|(a, step)| (a * step).abs());
        let rounding = ROUNDING_BAND * T::EPSILON * terms.sum::<f64>();
        let is_wrong = wrong_multiplier > rounding && is_above_rounding(k, wrong_multiplier);
        is_wrong.then_some(Contact::Inactive)
    }

    /// The steps of the values: active unknowns go to their bounds, the linear system gives the steps of the inactive
    /// ones. `None` if its matrix is not positive definite.
    fn steps(&self, states: &[Contact; N]) -> Option<[f64; N]> {
        let prescribed: [Option<T>; N] =
            std::array::from_fn(|k| prescribed_value(&self.bounds[k], states[k]));
        let is_active = prescribed.map(|value| value.is_some());
        let mut steps: [f64; N] = std::array::from_fn(|k| {
            prescribed[k].map_or(0.0, |value| (value - self.values[k]).to_f64())
        });
        let mut inverse = self.matrix;
        if !invert_positive_definite(inverse.as_flattened_mut(), N, &is_active) {
            return None;
        }
        let load: [f64; N] = std::array::from_fn(|k| self.residual_after(k, &steps));
        for k in (0..N).filter(|&k| !is_active[k]) {
            let inactive = (0..N).filter(|&j| !is_active[j]);
            steps[k] = inactive.map(|j| inverse[k][j] * load[j]).sum();
        }
        Some(steps)
    }

    /// The residual of unknown `k` after steps of all values.
    fn residual_after(&self, k: usize, steps: &[f64; N]) -> f64 {
        self.matrix[k].iter().zip(steps).fold(self.residual[k], |r, (a, step)| r - a * step)
    }
}
