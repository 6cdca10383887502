//! A form is positive definite, its symmetric part if it is not symmetric.

use nalgebra::DMatrix;

use super::discrete::{Tested, assemble};
use super::error::{Fault, KitErrorKind, Law};
use super::matrix::scaled_symmetric_part;
use super::meshes::Sample;
use super::report::LawReport;
use super::spectrum::{SpectrumError, extreme_eigenvalues};
use super::{meshes, problems};
use crate::algebra::SparseMatrix;
use crate::linear::FactorError;

/// The relative residual of the eigenvalue.
const TOLERANCE: f64 = 1e-10;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<LawReport, Fault> {
    let (domain, n) = (meshes::clamped(), meshes::subdivisions(D));
    let mut smallest = f64::INFINITY;
    // without reaction, which would help
    let problem = problems::smooth();
    for sample in [meshes::regular(&domain, n)?, meshes::moved(&domain, n)?] {
        let Sample { name, mesh } = sample;
        let inequality = assemble(scheme, &problem, &mesh)?;
        let part = scaled_symmetric_part(&inequality);
        smallest = f64::min(smallest, smallest_eigenvalue(&part, name)?);
    }
    let sentence = format!("smallest eigenvalue {smallest:.3e}");
    Ok(LawReport::new(Law::Coercivity, sentence, &[("smallest", smallest)]))
}

/// The smallest eigenvalue of a positive definite matrix; of another one, that and their number
/// in the error.
fn smallest_eigenvalue(part: &SparseMatrix<f64>, name: &str) -> Result<f64, Fault> {
    if part.size() == 0 {
        return Ok(f64::INFINITY);
    }
    let identity = SparseMatrix::from_diagonal(vec![1.0; part.size()]);
    match extreme_eigenvalues(part, &identity, TOLERANCE) {
        Ok(found) => Ok(found.smallest),
        Err(SpectrumError::NotFactored(FactorError::NotPositive | FactorError::Singular)) => {
            Err(not_coercive(part, name))
        }
        Err(why) => {
            let message = format!("no smallest eigenvalue on {name}: {why}");
            Err(Fault::new(KitErrorKind::NoEigenvalue, message).caused_by(why))
        }
    }
}

fn not_coercive(part: &SparseMatrix<f64>, mesh: &str) -> Fault {
    let unknowns = part.size();
    let dense = DMatrix::from_fn(unknowns, unknowns, |i, j| part.get(i, j));
    let eigenvalues = dense.symmetric_eigenvalues();
    // a Cholesky factorisation calls those singular that are not positive but for rounding
    let rounding = 16.0 * f64::EPSILON * unknowns as f64;
    let not_positive = unknowns - eigenvalues.iter().filter(|&&e| e > rounding).count();
    let smallest = eigenvalues.min();
    let message = format!(
        "on {mesh} the form has {not_positive} of {unknowns} eigenvalues that are not positive, the smallest {smallest:.3e} (diagonal scaled to ones)"
    );
    Fault::new(KitErrorKind::NotCoercive, message)
}
