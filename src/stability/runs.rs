//! Runs of a scheme on a scene or a mesh, and properties of its matrix.

use std::sync::Arc;

use super::choice::Choice;
use crate::algebra::{Bound, SparseMatrix};
use crate::error::Error;
use crate::inequality::{ActiveSet, InequalitySolver, in_precision};
use crate::linear::{LinearMethod, is_positive_definite};
use crate::mesh::{BoxDomain, Mesh};
use crate::nested::{Hierarchy, NestedIteration, Solved};
use crate::problem::Problem;
use crate::real::{Point, Precision};
use crate::scenes::Scene;
use crate::scheme::Regularity;
use crate::study::{Row, Study};

/// The solver of the study: the library's own, with factors on every level, so that no tolerance of
/// an iterative solver enters.
pub(crate) fn solver() -> ActiveSet {
    ActiveSet::default().linear(LinearMethod::Direct)
}

/// The rows of a scheme on levels of a scene.
pub(crate) fn rows<const D: usize>(
    scene: Scene<D>,
    choice: &Choice,
    levels: &[usize],
) -> Result<Vec<Row>, Error> {
    rows_in(Precision::Double, scene, choice, levels)
}

/// The rows of a scheme on levels of a scene, solved in a precision.
pub(crate) fn rows_in<const D: usize>(
    precision: Precision,
    mut scene: Scene<D>,
    choice: &Choice,
    levels: &[usize],
) -> Result<Vec<Row>, Error> {
    scene.problem = choice.constrain(scene.problem);
    let study = Study::<D>::new(scene).boxed_scheme(choice.make());
    let study = study.boxed_solver(in_precision(precision, solver()));
    Ok(study.levels(levels.iter().copied()).run()?.rows)
}

/// The row of a scheme on one level.
pub(crate) fn row<const D: usize>(
    scene: Scene<D>,
    choice: &Choice,
    level: usize,
) -> Result<Row, Error> {
    Ok(rows::<D>(scene, choice, &[level])?.swap_remove(0))
}

/// The row of a scheme on a mesh.
pub(crate) fn row_on<const D: usize>(
    mut scene: Scene<D>,
    mesh: Mesh<D>,
    choice: &Choice,
) -> Result<Row, Error> {
    scene.problem = choice.constrain(scene.problem);
    let study = Study::<D>::new(scene.domain(mesh)).boxed_scheme(choice.make());
    Ok(study.solver(solver()).levels([0]).run()?.rows.swap_remove(0))
}

/// A scheme's solution of a problem with the scheme's constraint set ([`Choice::constrain`]) on the finest
/// mesh of a hierarchy; started from conforming elements if asked for.
pub(crate) fn solved<'a, const D: usize>(
    problem: &'a Problem<D>,
    meshes: &'a Hierarchy<D>,
    choice: &Choice,
    is_warm: bool,
) -> Result<Solved<'a, D>, Error> {
    solved_by(Arc::new(solver()), problem, meshes, choice, is_warm)
}

/// [`solved`] with another solver.
pub(crate) fn solved_by<'a, const D: usize>(
    solver: Arc<dyn InequalitySolver<f64>>,
    problem: &'a Problem<D>,
    meshes: &'a Hierarchy<D>,
    choice: &Choice,
    is_warm: bool,
) -> Result<Solved<'a, D>, Error> {
    let nested = NestedIteration::new(problem, meshes).shared_solver(solver);
    nested.cold_start(!is_warm).solve(&*choice.make())
}

/// What contact forces and the fluxes through facets with weakly imposed Dirichlet data leave of the load, less the
/// reaction, over the sum of absolute loads. None without forces or without jump multipliers of the solver, which are
/// the fluxes.
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

/// Whether a scheme's matrix is symmetric positive definite on a mesh: 1 or 0; none if the
/// scheme is not symmetric or the factorisation failed.
pub(crate) fn definite<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    choice: &Choice,
) -> Result<Option<f64>, Error> {
    let inequality = choice.inequality(problem, mesh)?;
    let free: Vec<u32> = (0..inequality.size() as u32)
        .filter(|&i| !matches!(inequality.bounds[i as usize], Bound::Fixed(_)))
        .collect();
    if !inequality.symmetric {
        return Ok(None);
    }
    let answer = is_positive_definite(&inequality.matrix, true, &free).ok();
    Ok(answer.map(|is| f64::from(u8::from(is))))
}

/// The matrix of a scheme, restricted to its free unknowns.
pub(crate) fn free_matrix<const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    choice: &Choice,
) -> Result<SparseMatrix<f64>, Error> {
    let inequality = choice.inequality(problem, mesh)?;
    Ok(inequality.matrix.submatrix(&inequality.free_unknowns()))
}

/// `-Laplace u = f` in the unit box with `u` the product of `sin(pi x_k)`.
pub(crate) fn sines<const D: usize>() -> Scene<D> {
    use std::f64::consts::PI;
    let value = |x: &Point<D>| x.iter().map(|x| (PI * x).sin()).product::<f64>();
    let gradient = |x: &Point<D>| {
        Point::from_fn(|k, _| {
            let factor = |(j, x): (usize, &f64)| {
                if j == k { PI * (PI * x).cos() } else { (PI * x).sin() }
            };
            x.iter().enumerate().map(factor).product::<f64>()
        })
    };
    Scene {
        name: format!("sines-{D}d"),
        summary: "Poisson in the unit box",
        domain: BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).into(),
        problem: Problem::new()
            .source(move |x| D as f64 * PI * PI * value(x))
            .exact(value, gradient),
        regularity: Regularity::smooth(),
    }
}
