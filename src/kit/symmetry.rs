//! A matrix is as symmetric as its form declares.

use super::discrete::{Tested, assemble};
use super::error::{Fault, KitErrorKind, Law};
use super::matrix::{describe, row_sizes};
use super::report::LawReport;
use super::{meshes, problems};
use crate::algebra::Inequality;

/// Rounding units by which an entry may differ from its mirror image.
const UNITS: f64 = 256.0;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<LawReport, Fault> {
    let sample = meshes::moved(&meshes::mixed(), meshes::subdivisions(D))?;
    let inequality = assemble(scheme, &problems::rich(), &sample.mesh)?;
    compare(&inequality, UNITS * f64::EPSILON)
}

fn compare(inequality: &Inequality<f64>, tolerance: f64) -> Result<LawReport, Fault> {
    let matrix = &inequality.matrix;
    let sizes = row_sizes(matrix);
    let (mut difference, mut at) = (0.0, (0, 0));
    for i in 0..matrix.size() {
        let (columns, values) = matrix.row(i);
        for (&j, &a) in columns.iter().zip(values) {
            let j = j as usize;
            let relative = (a - matrix.get(j, i)).abs() / (sizes[i] * sizes[j]).sqrt();
            // written so that a number that is not finite is the largest
            if !(relative <= difference || difference.is_nan()) {
                (difference, at) = (relative, (i, j));
            }
        }
    }
    let small = difference <= tolerance;
    match (inequality.symmetric, small) {
        (true, false) => {
            let (row, column) = at;
            let message = format!(
                "the form is declared symmetric, but the entry at ({row}, {column}) is {:.6e} and its mirror image {:.6e}; row: {}; column: {}",
                matrix.get(row, column),
                matrix.get(column, row),
                describe(inequality, row),
                describe(inequality, column),
            );
            Err(Fault::new(KitErrorKind::NotSymmetric, message))
        }
        (false, true) => {
            let message = format!(
                "the form is declared not symmetric, but no entry differs from its mirror image by more than {difference:.1e} of its rows: declare it symmetric"
            );
            Err(Fault::new(KitErrorKind::SymmetricAfterAll, message))
        }
        (declared, _) => {
            let word = if declared { "symmetric" } else { "not symmetric" };
            let sentence = format!("{word}, difference {difference:.1e}");
            Ok(LawReport::new(Law::Symmetry, sentence, &[("difference", difference)]))
        }
    }
}
