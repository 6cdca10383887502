//! A matrix is as symmetric as its form declares.

use super::discrete::{Tested, assemble};
use super::error::{KitError, Law};
use super::matrix::{Assembled, row_sizes};
use super::report::SymmetryReport;
use super::{meshes, problems};
use crate::instances::compiled;

/// Rounding units by which an entry may differ from its mirror image.
const UNITS: f64 = 256.0;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<SymmetryReport, KitError> {
    compiled!(const D: fn(&Tested<'_, D>) -> Result<SymmetryReport, KitError>
            = check_scheme
    )(scheme)
}

fn check_scheme<const D: usize>(scheme: &Tested<'_, D>) -> Result<SymmetryReport, KitError> {
    let sample = meshes::moved(Law::Symmetry, &meshes::mixed(), meshes::subdivisions(D))?;
    let inequality = assemble(Law::Symmetry, scheme, &problems::rich(), &sample.mesh)?;
    compare(&Assembled::of(&inequality), UNITS * f64::EPSILON)
}

fn compare(assembled: &Assembled, tolerance: f64) -> Result<SymmetryReport, KitError> {
    let matrix = &assembled.matrix;
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
    match (assembled.symmetric, small) {
        (true, false) => Err(KitError::NotSymmetric {
            row: at.0,
            column: at.1,
            entry: matrix.get(at.0, at.1),
            mirrored: matrix.get(at.1, at.0),
            row_place: assembled.describe(at.0),
            column_place: assembled.describe(at.1),
        }),
        (false, true) => Err(KitError::SymmetricAfterAll { difference }),
        (declared, _) => Ok(SymmetryReport { declared, difference }),
    }
}
