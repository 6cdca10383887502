//! Krylov methods, seen by the preconditioner that they apply to their residuals.

use crate::own_preconditioner::{OnePart, blocks};
use crate::problems::{Random, distance, inequality, laplacian};
use std::sync::{Arc, Mutex};
use unilateral::algebra::{Bound, Inequality, SparseMatrix};
use unilateral::inequality::{ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution};
use unilateral::linear::{FactorError, PreconditionedSystem, Preconditioner, PreconditionerFamily};

/// Multiplication by a diagonal, with the vectors that were multiplied.
#[derive(Clone, Debug)]
struct Recorded {
    factors: Vec<f64>,
    vectors: Arc<Mutex<Vec<Vec<f64>>>>,
}

impl Recorded {
    fn new(factors: Vec<f64>) -> Self {
        Self { factors, vectors: Arc::default() }
    }

    fn vectors(&self) -> Vec<Vec<f64>> {
        self.vectors.lock().unwrap().clone()
    }

    /// Solves an inequality as the only part of a mesh: there are no factors, and no method follows.
    fn solve_from(&self, given: &Inequality<f64>, values: Vec<f64>) -> Solution<f64> {
        let mut given = given.clone();
        given.distribution = Some(Arc::new(OnePart));
        let guess = InitialGuess::default().values(values);
        ActiveSet::default().with_preconditioners(self.clone()).solve_from(&given, &guess)
    }

    fn solve(&self, given: &Inequality<f64>) -> Solution<f64> {
        self.solve_from(given, Vec::new())
    }
}

impl PreconditionerFamily<f64> for Recorded {
    fn name(&self) -> &'static str {
        "recorded"
    }
    fn preconditioner<'a>(
        &self,
        _system: PreconditionedSystem<'a, f64>,
    ) -> Option<Box<dyn Preconditioner<f64> + 'a>> {
        Some(Box::new(self.clone()))
    }
}

impl Preconditioner<f64> for Recorded {
    fn name(&self) -> &'static str {
        "diagonal"
    }
    fn set_fixed(&mut self, _fixed: &[bool]) -> Result<(), FactorError> {
        Ok(())
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.vectors.lock().unwrap().push(r.to_vec());
        for ((z, r), factor) in z.iter_mut().zip(r).zip(&self.factors) {
            *z = factor * r;
        }
    }
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

fn free(matrix: SparseMatrix<f64>, load: &[f64]) -> Inequality<f64> {
    inequality(matrix, load, vec![Bound::Free; load.len()])
}

#[test]
fn residuals_of_conjugate_gradients_are_orthogonal_and_end_with_the_space() {
    let load = [1.0, 0.3, -0.2, 0.7, 0.4];
    let given = free(laplacian(5, 1, 2.0), &load);
    let recorded = Recorded::new(vec![1.0; 5]);
    let solution = recorded.solve(&given);
    assert_eq!((solution.outcome, solution.linear), (Outcome::Converged, 5));
    let mut residual = vec![0.0; 5];
    given.residual_f64(&solution.values, &mut residual);
    assert!(residual.iter().all(|r| r.abs() < 1e-13));
    let residuals = recorded.vectors();
    for (k, r) in residuals[..5].iter().enumerate() {
        for other in &residuals[..k] {
            assert!(dot(r, other).abs() < 1e-12, "{r:?} {other:?}");
        }
    }
}

/// The largest condition number of a preconditioned matrix with which a preconditioner counts as suitable.
const MAX_CONDITION: f64 = 1e4;

/// The smallest and the largest Ritz value are the eigenvalues after as many steps as unknowns: of second differences,
/// `2 - 2 cos(k pi / 6)`, plus a shift.
#[test]
fn the_condition_number_that_conjugate_gradients_find_is_that_of_the_matrix() {
    for (factor, outcome) in [(0.98, Outcome::Converged), (1.02, Outcome::Stalled)] {
        let [low, high] = [-1.0, 1.0].map(|sign| 2.0 + sign * 3.0_f64.sqrt());
        let shift = (high - factor * MAX_CONDITION * low) / (factor * MAX_CONDITION - 1.0);
        let given = free(laplacian(5, 1, 2.0 + shift), &[1.0, 0.3, -0.2, 0.7, 0.4]);
        assert_eq!(Recorded::new(vec![1.0; 5]).solve(&given).outcome, outcome, "{factor}");
    }
}

/// A negative square of the norm of the residual is an error unless it is as small as a rounding error.
#[test]
fn a_negative_square_is_no_small_norm() {
    let mut random = Random::new(3);
    let exact: Vec<f64> = (0..5).map(|_| random.signed()).collect();
    let matrix = laplacian(5, 1, 2.0);
    let load: Vec<f64> = (0..5).map(|i| matrix.row_dot(i, &exact)).collect();
    for symmetric in [true, false] {
        let mut given = free(matrix.clone(), &load);
        given.symmetric = symmetric;
        let negative = Recorded::new(vec![-1.0; 5]);
        assert_eq!(negative.solve(&given).outcome, Outcome::NotCoercive);
        if symmetric {
            let near = exact.iter().map(|x| x + 1e-12).collect();
            assert_eq!(negative.solve_from(&given, near).outcome, Outcome::Converged);
        }
        let residuals = negative.vectors();
        assert!(residuals.iter().all(|r| dot(r, r) > 0.0), "{residuals:?}");
    }
}

/// `diag(1, 2, 4, last)` plus a skew-symmetric tridiagonal matrix.
fn skew(last: f64) -> Inequality<f64> {
    let b = 3.0;
    let matrix = SparseMatrix {
        row_starts: vec![0, 2, 5, 8, 10],
        columns: vec![0, 1, 0, 1, 2, 1, 2, 3, 2, 3],
        values: vec![1.0, b, -b, 2.0, b, -b, 4.0, b, -b, last],
    };
    let mut given = free(matrix, &[1.0, 0.3, -0.2, 0.7]);
    given.symmetric = false;
    given
}

/// The basis of GMRES is orthogonal in the inner product of the preconditioner. It has as many vectors as the space, after
/// which the residual vanishes.
#[test]
fn the_residual_of_gmres_vanishes_after_as_many_steps_as_unknowns() {
    let given = skew(5.0);
    let recorded = Recorded::new(vec![1.0, 0.5, 0.3, 0.1]);
    let solution = recorded.solve(&given);
    assert_eq!(solution.outcome, Outcome::Converged);
    let mut residual = vec![0.0; given.size()];
    given.residual_f64(&solution.values, &mut residual);
    assert!(residual.iter().all(|r| r.abs() < 1e-13), "{residual:?}");
    let vectors = recorded.vectors();
    let norm = |v: &[f64]| {
        let terms = v.iter().zip(&recorded.factors).map(|(v, b)| b * v * v);
        terms.sum::<f64>().sqrt()
    };
    assert_eq!(vectors[0], given.load);
    for (k, v) in vectors[..4].iter().enumerate() {
        for other in &vectors[..k] {
            let scaled: Vec<f64> =
                other.iter().zip(&recorded.factors).map(|(v, b)| b * v).collect();
            assert!(dot(v, &scaled).abs() < 1e-13 * norm(v) * norm(other), "{v:?} {other:?}");
        }
    }
    // the fifth vector, and the residual after the correction
    assert!(vectors[4..6].iter().all(|v| norm(v) < 1e-13), "{vectors:?}");
    // the symmetric part, preconditioned diag(1, 1, 1.2, 0.5), has three eigenvalues
    assert_eq!(solution.linear, 4 + 3);
}

/// The first cycle ends the solve.
#[test]
fn an_indefinite_symmetric_part_stops_gmres() {
    let mut given = skew(-5.0);
    given.load = vec![1.0; 4];
    let recorded = Recorded::new(vec![1.0, 0.5, 0.3, 0.1]);
    assert_eq!(recorded.solve(&given).outcome, Outcome::NotCoercive);
    assert!(recorded.vectors().len() <= 5, "{:?}", recorded.vectors());
}

/// The smallest eigenvalue belongs to the first block, whose coefficient is that of all others divided by a contrast and
/// which GMRES does not see, because it has no load. It is found to a tenth all the same: slightly above and below the
/// limit of the condition number.
#[test]
fn an_eigenvector_in_a_region_with_another_coefficient_is_found() {
    for contrast in [1e-16, 1e-8, 1.0, 1e8, 1e16] {
        for (condition, outcome) in [(0.93, Outcome::Converged), (1.07, Outcome::Stalled)] {
            let condition = condition * MAX_CONDITION;
            let mut given = blocks(0.9);
            // the largest eigenvalue lies between 1.9 and 2, whatever components the right-hand side has
            let s = 1.0 - 2.0 / condition;
            let SparseMatrix { values, .. } = &mut given.matrix;
            for (value, entry) in values.iter_mut().zip([1.0, s + 1.0, s - 1.0, 1.0]) {
                *value = entry / contrast;
            }
            given.load[..2].fill(0.0);
            let diagonal = given.matrix.diagonal();
            let jacobi = Recorded::new(diagonal.iter().map(|d| 1.0 / d).collect());
            let solution = jacobi.solve(&given);
            assert_eq!(solution.outcome, outcome, "{contrast} {condition}");
            assert!(distance(&solution.values[..2], &[0.0; 2]) == 0.0);
        }
    }
}
