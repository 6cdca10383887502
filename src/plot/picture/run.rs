//! The solution of one scheme on one level, with fields for pictures.

use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::inequality::ActiveSet;
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::nested::{Hierarchy, Solved, Task, solve};
use crate::real::Real;
use crate::scenes::Scene;
use crate::scheme::AnyScheme;

/// Solves a scene with a scheme on one level, with fields for pictures, the start from coarser
/// levels as in a study. The caller checks the outcome: there are no fields without a solution.
///
/// # Errors
/// [`Error::Parameter`] for a level of zero or one too large, and those of assembly.
pub fn solve_level<T: Real, const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn AnyScheme<T, D>,
    level: usize,
) -> Result<(Mesh<T, D>, Solved), Error> {
    compiled!(
        T, D: fn(&Scene<D>, &dyn AnyScheme<T, D>, usize) -> Result<(Mesh<T, D>, Solved), Error>
            = solve_scene
    )(scene, scheme, level)
}

fn solve_scene<T: Real, const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn AnyScheme<T, D>,
    level: usize,
) -> Result<(Mesh<T, D>, Solved), Error> {
    let solver = ActiveSet::default();
    let quadrature = DataQuadrature::default();
    let mut levels = Hierarchy::new(&scene.problem, &scene.domain, None);
    levels.build(level)?;
    let Some((mesh, _)) = levels.mesh(level) else { unreachable!("made above") };
    let start = if scheme.is_conforming_linear(mesh) {
        levels.prolonged_p1_solution(level, &solver, quadrature, 1)?
    } else {
        Some(levels.p1_solution(level, &solver, quadrature, 1)?)
    };
    let Some((mesh, _)) = levels.mesh(level) else { unreachable!("made above") };
    let task = Task::new(&scene.problem, mesh, &solver)
        .start(start.as_deref())
        .quadrature(quadrature)
        .with_fields(true);
    let solved = solve(scheme, &task)?;
    Ok((mesh.clone(), solved))
}
