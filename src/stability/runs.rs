//! Runs of a scheme on a scene, and properties of its matrix.

use std::sync::Arc;

use super::choice::Choice;
use super::criterion::Criterion;
use super::plan::Sink;
use super::row_builder::{RowBuilder, of, quotient};
use crate::algebra::{Inequality, SparseMatrix};
use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, in_precision};
use crate::linear::{LinearMethod, is_positive_definite};
use crate::mesh::Mesh;
use crate::nested::{Hierarchy, NestedIteration, Solved};
use crate::problem::Problem;
use crate::real::Precision;
use crate::scenes::Scene;
use crate::study::{Row, Study};

/// The solver of the study: the library's own, with factors on every level, so that no tolerance of
/// an iterative solver enters.
pub(crate) fn solver() -> ActiveSet {
    ActiveSet::default().linear(LinearMethod::Direct)
}

/// A study of a scheme on a scene.
pub(crate) fn study<const D: usize>(
    precision: Precision,
    scene: &Scene<D>,
    choice: &Choice,
) -> Study<'static, D> {
    let scene = Scene { problem: choice.problem(scene), ..scene.clone() };
    let study = Study::<D>::new(scene).boxed_scheme(choice.make());
    study.boxed_solver(in_precision(precision, solver()))
}

/// The rows of a scheme on levels of a scene.
pub(crate) fn rows<const D: usize>(
    scene: &Scene<D>,
    choice: &Choice,
    levels: &[usize],
) -> Result<Vec<Row>, Error> {
    Ok(study(Precision::Double, scene, choice).levels(levels.iter().copied()).run()?.rows)
}

/// A norm of the error by name. The limit of its order is the one of the criterion at the same place.
pub(crate) type Norm = (&'static str, fn(&Row) -> Option<f64>);

pub(crate) const L2: Norm = ("L2", |r| r.error.l2);
pub(crate) const H1: Norm = ("H1", |r| r.error.h1);

/// A row for the order in each norm, fitted over levels.
pub(crate) fn fit<const D: usize>(
    criterion: &'static Criterion,
    scene: &Scene<D>,
    choice: &Choice,
    levels: &[usize],
    norms: &[Norm],
    sink: Sink<'_>,
) -> Result<(), Error> {
    let rows = rows(scene, choice, levels)?;
    for (number, (norm, error)) in norms.iter().enumerate() {
        let claim = RowBuilder::new(criterion, choice);
        let claim = match criterion.limits.get(number) {
            // a re-entrant corner limits the orders whatever the contact
            Some(_) if scene.name != "lshape-2d" => claim.limit(number),
            _ => claim.judged_if(false),
        };
        let claim = claim.on(&scene.name).quantity(&format!("order in {norm}, fitted"));
        sink(claim.fitted(&rows, error));
    }
    Ok(())
}

/// The row of a scheme on one level of a scene, solved in a precision.
pub(crate) fn row_in<const D: usize>(
    precision: Precision,
    scene: &Scene<D>,
    choice: &Choice,
    level: usize,
) -> Result<Row, Error> {
    Ok(study(precision, scene, choice).levels([level]).run()?.rows.swap_remove(0))
}

/// The row of a scheme on one level of a scene.
pub(crate) fn row<const D: usize>(
    scene: &Scene<D>,
    choice: &Choice,
    level: usize,
) -> Result<Row, Error> {
    row_in(Precision::Double, scene, choice, level)
}

/// An error of a row over that of another scheme on the same level of the same scene.
pub(crate) fn over<const D: usize>(
    other: &str,
    scene: &Scene<D>,
    ours: &Row,
    error: impl Fn(&Row) -> Option<f64>,
) -> Result<Option<f64>, Error> {
    let theirs = row(scene, &Choice::of(other), ours.level)?;
    Ok(quotient(of(ours, &error), of(&theirs, &error)))
}

/// The solution of a scheme for a problem that has the [constraint set](Choice::problem) of the scheme, on the finest
/// mesh of a hierarchy, started from conforming elements.
pub(crate) fn solved<'a, const D: usize>(
    problem: &'a Problem<D>,
    meshes: &'a Hierarchy<D>,
    choice: &Choice,
) -> Result<Solved<'a, D>, Error> {
    solved_by(Arc::new(solver()), problem, meshes, choice, false)
}

/// [`solved`] with another solver, on request from a cold start.
pub(crate) fn solved_by<'a, const D: usize>(
    solver: Arc<dyn InequalitySolver<f64>>,
    problem: &'a Problem<D>,
    meshes: &'a Hierarchy<D>,
    choice: &Choice,
    is_cold: bool,
) -> Result<Solved<'a, D>, Error> {
    let nested = NestedIteration::new(problem, meshes).shared_solver(solver);
    nested.cold_start(is_cold).solve(&*choice.make())
}

/// The imbalance of forces: the load less reaction, contact forces and fluxes through facets with weakly imposed
/// Dirichlet data, over the sum of absolute loads. None without forces or without jump multipliers of the solver, which
/// are the fluxes.
pub(crate) fn imbalance<const D: usize>(solved: &Solved<'_, D>) -> Option<f64> {
    let (inequality, solution) = (solved.inequality(), solved.solution());
    let penalised = inequality.penalised.as_ref()?;
    let forces = solved.multiplier()?;
    if solution.jump_multipliers.len() != penalised.n_jumps() {
        return None;
    }
    let mut left = -forces.iter().sum::<f64>();
    for i in 0..inequality.size() {
        // the stiffness of a function has the sum zero
        left += penalised.stiffness(i, |j| solution.values[j]);
        left -= inequality.load[i];
    }
    for (jump, multiplier) in solution.jump_multipliers.iter().enumerate() {
        if penalised.jumps.blocks_of(jump).iter().any(Option::is_none) {
            let weights = penalised.terms_of(jump).iter().map(|term| term.weight);
            left += weights.sum::<f64>() * multiplier;
        }
    }
    let size: f64 = inequality.load.iter().map(|load| load.abs()).sum();
    Some(left.abs() / size)
}

/// The inequality of a scheme on a mesh, with the problem of a scene.
pub(crate) fn inequality<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<D>,
    choice: &Choice,
) -> Result<Inequality<f64>, Error> {
    choice.make::<D>().inequality(&choice.problem(scene), mesh, DataQuadrature::default())
}

/// Whether a scheme's matrix is symmetric positive definite on a mesh: 1 or 0; none if the
/// scheme is not symmetric or the factorisation failed.
pub(crate) fn definite<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<D>,
    choice: &Choice,
) -> Result<Option<f64>, Error> {
    let inequality = inequality(scene, mesh, choice)?;
    if !inequality.symmetric {
        return Ok(None);
    }
    let answer = is_positive_definite(&inequality.matrix, true, &inequality.free_unknowns());
    Ok(answer.ok().map(|is| f64::from(u8::from(is))))
}

/// The matrix of a scheme, restricted to its free unknowns.
pub(crate) fn free_matrix<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<D>,
    choice: &Choice,
) -> Result<SparseMatrix<f64>, Error> {
    let inequality = inequality(scene, mesh, choice)?;
    Ok(inequality.matrix.submatrix(&inequality.free_unknowns()))
}
