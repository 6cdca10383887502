//! The start on a mesh without coarser ones: the inequality on spaces by aggregation, the coarsest first.

use crate::algebra::{Bound, Inequality};
use crate::inequality::{InequalitySolver, InitialGuess, MonotoneMultigrid, Solution};
use crate::linear::{CoarseLevel, CoarseSpaces, Prolongation};

/// Relative tolerance in the energy norm on each space.
const ENERGY_TOLERANCE: f64 = 1e-3;

/// Largest number of cycles on each space.
const MAX_CYCLES: usize = 60;

/// A solution by [`MonotoneMultigrid`]. The solution on the next coarser space, by this function, gives its starting
/// values (F. A. Bornemann, P. Deuflhard, Numer. Math. 75 (1996), 135-152); on the coarsest space the starting values are zero.
///
/// A coarse function is bound by the means of the bounds over its children: the coarse solution need not be
/// admissible, because the solver projects its starting values.
pub(super) fn solve_cascade(
    inequality: &Inequality<f64>,
    coarser: Option<&CoarseLevel<f64>>,
) -> Solution<f64> {
    let mut guess = InitialGuess::default().energy_tolerance(ENERGY_TOLERANCE);
    if let Some(coarser) = coarser {
        let (level, prolongation) = (coarser.level(), coarser.prolongation());
        let data = inequality.bounds.iter().map(|b| b.fixed_value().unwrap_or(0.0));
        let mut values: Vec<f64> = data.collect();
        let mut residual = vec![0.0; values.len()];
        inequality.residual_f64(&values, &mut residual);
        let mut load = vec![0.0; level.size()];
        prolongation.restrict(&residual, &mut load);
        let bounds = (0..level.size()).map(|j| mean_bound(&inequality.bounds, prolongation, j));
        let coarse = Inequality::new(level.matrix().clone(), true, load, bounds.collect());
        let solution = solve_cascade(&coarse, level.coarser());
        let correction = prolongation.prolongate(&solution.values);
        values.iter_mut().zip(correction).for_each(|(value, change)| *value += change);
        guess = guess.values(values).coarse_spaces(CoarseSpaces::CoarseLevel(coarser.clone()));
    }
    MonotoneMultigrid::default().max_cycles(MAX_CYCLES).solve_from(inequality, &guess)
}

/// The means of the bounds of the children of a coarse unknown, with the weights of the prolongation.
fn mean_bound(bounds: &[Bound<f64>], prolongation: &Prolongation, j: usize) -> Bound<f64> {
    let mut sums = [(0.0, 0.0); 2];
    for (i, weight) in prolongation.children(j) {
        let weight = f64::from(weight.max(0.0));
        for (sum, bound) in sums.iter_mut().zip([bounds[i].lower(), bounds[i].upper()]) {
            if let Some(bound) = bound {
                *sum = (sum.0 + weight * bound, sum.1 + weight);
            }
        }
    }
    let mean = |(sum, weight): (f64, f64)| (weight > 0.0).then(|| sum / weight);
    match sums.map(mean) {
        [Some(lower), Some(upper)] if lower <= upper => Bound::Both(lower, upper),
        [Some(lower), _] => Bound::Lower(lower),
        [None, Some(upper)] => Bound::Upper(upper),
        [None, None] => Bound::Free,
    }
}
