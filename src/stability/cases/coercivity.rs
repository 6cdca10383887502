//! Interior penalty across its threshold of coercivity, by inertia.

use crate::algebra::SparseMatrix;
use crate::error::Error;
use crate::inequality::Outcome;
use crate::kit::spectrum::{CholeskyMatrix, Diagonal, Lanczos};
use crate::scenes;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{free_matrix, row, sines};

/// The factor below which `sigma/h_F` is indefinite on right isosceles triangles.
const THRESHOLD: f64 = 3.0;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(8, 16);
    for sigma in [0.5, 1.0, 2.0, 2.9, 3.1, 4.0, 10.0, 1000.0] {
        let choice = Choice::new("sipg", Penalty::Sigma(sigma));
        plan.add("coercivity", choice, "", move |c, sink| factor(c, sigma, level, sink));
    }
    for choice in plan.compared() {
        plan.add("coercivity", choice, "", move |c, sink| {
            sink(inertia(c, level)?);
            Ok(())
        });
    }
}

fn inertia(choice: &Choice, level: usize) -> Result<crate::stability::StabilityRow, Error> {
    let scene = sines::<2>();
    let mesh = scene.domain.mesh(level)?;
    let matrix = free_matrix(&scene.problem, &mesh, choice)?;
    let negative = negative_pivots(&matrix);
    let is_weak = matches!(choice.penalty, Penalty::Sigma(sigma) if sigma < THRESHOLD);
    let least = smallest_eigenvalue(&matrix);
    let claim = RowBuilder::new("inertia", choice).on("sines-2d").level(level);
    let claim = match choice.penalty {
        Penalty::Sigma(sigma) => claim.at("sigma", sigma),
        _ => claim,
    };
    Ok(claim
        .quantity("negative eigenvalues")
        .at_most(0.0)
        .known_to_fail(is_weak)
        .detail(
            least.map_or(String::new(), |l| {
                format!("smallest eigenvalue {l:.3e} of {}", matrix.size())
            }),
        )
        .measured(Some(negative as f64)))
}

fn factor(choice: &Choice, sigma: f64, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    sink(inertia(choice, level)?);
    let found = row::<2>(scenes::radial::<2>(1.0), choice, 2 * level)?;
    // on Dirichlet facets |dK|/|K| with |dK| = (2 + root 2) h and |K| = h^2 / 2
    let proven = 2.0 * (2.0 + 2.0_f64.sqrt());
    let means = row::<2>(scenes::radial::<2>(1.0), &Choice::default("cr"), 2 * level)?;
    sink(
        RowBuilder::new("error-of-interior-penalty", choice)
            .on(&found.scene)
            .level(2 * level)
            .at("sigma", sigma)
            .quantity("H1 error over that of cr")
            .at_most(1.25)
            .known_to_fail(sigma < proven)
            .detail(figures(&found))
            .measured(quotient(of(&found, |r| r.error.h1), of(&means, |r| r.error.h1))),
    );
    let told = found.status == Outcome::NotCoercive || !found.warnings.is_empty();
    let claim = RowBuilder::new("refused-or-warned", choice)
        .on(&found.scene)
        .level(2 * level)
        .at("sigma", sigma)
        .quantity("refused to solve, or warned");
    let claim = if sigma < proven { claim.at_least(1.0) } else { claim.at_most(0.0) };
    let error = of(&found, |r| r.error.h1).is_some();
    let detail = match (error, found.warnings.is_empty()) {
        (true, false) => format!("warned, {}", figures(&found)),
        _ => figures(&found),
    };
    sink(claim.detail(detail).measured(Some(f64::from(u8::from(told)))));
    Ok(())
}

/// Negative pivots of the factorisation `L D L^T` without exchanges, which by Sylvester's law are
/// as many as negative eigenvalues.
fn negative_pivots(matrix: &SparseMatrix<f64>) -> usize {
    let n = matrix.size();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row = vec![0.0; i + 1];
            let (columns, values) = matrix.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                if j as usize <= i {
                    row[j as usize] = a;
                }
            }
            row
        })
        .collect();
    let mut negative = 0;
    for k in 0..n {
        let pivot = rows[k][k];
        negative += usize::from(pivot < 0.0);
        let column: Vec<f64> = (k + 1..n).map(|i| rows[i][k]).collect();
        for i in k + 1..n {
            let factor = column[i - k - 1] / pivot;
            if factor == 0.0 {
                continue;
            }
            let row = &mut rows[i][k + 1..=i];
            row.iter_mut().zip(&column).for_each(|(a, c)| *a -= factor * c);
        }
    }
    negative
}

/// The smallest eigenvalue, by the method of Lanczos for the matrix shifted until it is definite.
fn smallest_eigenvalue(matrix: &SparseMatrix<f64>) -> Option<f64> {
    let mut shift = 0.0;
    for attempt in 0..20 {
        let mut shifted = matrix.clone();
        for i in 0..matrix.size() {
            let row = matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize;
            for k in row.filter(|&k| matrix.columns[k] as usize == i) {
                shifted.values[k] += shift;
            }
        }
        if let Ok(a) = CholeskyMatrix::new(&shifted) {
            let lanczos = Lanczos::default().with_tolerance(1e-6);
            let found = lanczos.smallest(&a, &Diagonal::identity(matrix.size())).ok()?;
            return Some(found - shift);
        }
        shift = 2.0_f64.powi(attempt - 8);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{negative_pivots, smallest_eigenvalue};
    use crate::algebra::SparseMatrix;

    #[test]
    fn inertia_of_a_matrix_with_known_eigenvalues() {
        // eigenvalues 3 and -1, and 2
        let matrix = SparseMatrix {
            row_starts: vec![0, 2, 4, 5],
            columns: vec![0, 1, 0, 1, 2],
            values: vec![1.0, 2.0, 2.0, 1.0, 2.0],
        };
        assert_eq!(negative_pivots(&matrix), 1);
        assert!((smallest_eigenvalue(&matrix).unwrap() + 1.0).abs() < 1e-6);
    }
}
