//! A matrix is as symmetric as its form declares.

use super::discrete::{Tested, assemble};
use super::error::{KitError, KitErrorKind, Law};
use super::matrix::{describe, row_sizes};
use super::report::SymmetryReport;
use super::{meshes, problems};
use crate::algebra::Inequality;

/// Rounding units by which an entry may differ from its mirror image.
const UNITS: f64 = 256.0;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<SymmetryReport, KitError> {
    let sample = meshes::moved(Law::Symmetry, &meshes::mixed(), meshes::subdivisions(D))?;
    let inequality = assemble(Law::Symmetry, scheme, &problems::rich(), &sample.mesh)?;
    compare(&inequality, UNITS * f64::EPSILON)
}

fn compare(inequality: &Inequality<f64>, tolerance: f64) -> Result<SymmetryReport, KitError> {
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
            Err(KitError::new(Law::Symmetry, KitErrorKind::NotSymmetric, message))
        }
        (false, true) => {
            let message = format!(
                "the form is declared not symmetric, but no entry differs from its mirror image by more than {difference:.1e} of its rows: declare it symmetric"
            );
            Err(KitError::new(Law::Symmetry, KitErrorKind::SymmetricAfterAll, message))
        }
        (declared, _) => Ok(SymmetryReport { declared, difference }),
    }
}
