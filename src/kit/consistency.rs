//! The patch test.

use super::discrete::{Tested, solve_and_judge};
use super::error::{Fault, KitErrorKind, Law};
use super::meshes::Sample;
use super::report::LawReport;
use super::{meshes, problems};
use crate::arrays::map_entries;
use crate::measure::Errors;
use crate::mesh::describe_point;
use crate::problem::Problem;

/// Rounding units that the error may have: some hundreds for the condition of a small matrix,
/// some tens for the sums of its entries.
const UNITS: f64 = 8192.0;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<LawReport, Fault> {
    let (domain, n) = (meshes::mixed(), meshes::subdivisions(D));
    let declared = scheme.is_consistent();
    let degree = scheme.degree();
    let problem = problems::polynomial::<D>(degree);
    let tolerance = UNITS * f64::EPSILON;
    let mut error = if declared { 0.0 } else { f64::INFINITY };
    for sample in [meshes::regular(&domain, n)?, meshes::moved(&domain, n)?] {
        let (errors, vertex_values) = solve_and_judge(scheme, &problem, &sample)?;
        let here = relative_error(&errors, &problem, &sample);
        let mesh = sample.name;
        match (declared, here <= tolerance) {
            (true, true) => error = f64::max(error, here),
            (false, false) => error = f64::min(error, here),
            (false, true) => {
                let message = format!(
                    "the scheme is declared inconsistent, but on {mesh} it reproduces a polynomial of degree {degree} to {here:.3e}: declare it consistent"
                );
                return Err(Fault::new(KitErrorKind::ConsistentAfterAll, message));
            }
            (true, false) => {
                let (cell, at) = worst_cell(&vertex_values, &problem, &sample);
                let message = format!(
                    "on {mesh} the error against a polynomial of degree {degree} is {here:.3e}, rounding explains {tolerance:.1e}; worst in cell {cell}, near {at}"
                );
                return Err(Fault::new(KitErrorKind::NotConsistent, message));
            }
        }
    }
    let word = if declared { "consistent" } else { "not consistent" };
    let sentence = format!("{word}, error {error:.1e}");
    Ok(LawReport::new(Law::Consistency, sentence, &[("error", error)]))
}

/// The larger of the errors at nodes and of mesh size times that of the gradient, relative to the
/// polynomial; not a number where there is none.
fn relative_error<const D: usize>(
    errors: &Errors,
    problem: &Problem<D>,
    sample: &Sample<D>,
) -> f64 {
    let [value, gradient] = map_entries([errors.max, errors.h1], |e| e.unwrap_or(f64::NAN));
    let vertices = sample.mesh.vertices();
    let size = vertices.iter().fold(1.0, |m, x| f64::max(m, problem.dirichlet_at(x).abs()));
    let gradient = gradient * sample.mesh.mesh_size();
    if value.is_nan() || gradient.is_nan() { f64::NAN } else { value.max(gradient) / size }
}

/// The cell with the largest error at a vertex, and its barycentre.
fn worst_cell<const D: usize>(
    vertex_values: &[f64],
    problem: &Problem<D>,
    sample: &Sample<D>,
) -> (usize, String) {
    let mesh = &sample.mesh;
    let (mut largest, mut worst) = (0.0, 0);
    for (cell, values) in vertex_values.chunks_exact(D + 1).enumerate() {
        for (&v, value) in mesh.cell(cell).iter().zip(values) {
            let exact = problem.dirichlet_at(&mesh.vertices()[v as usize]);
            let error = (value - exact).abs();
            if error > largest {
                (largest, worst) = (error, cell);
            }
        }
    }
    (worst, describe_point(&mesh.barycentre(worst)))
}
