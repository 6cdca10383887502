//! What a command solves: a scene of the catalogue, or a problem of a file.

use unilateral::problem_file::{Geometry, OwnProblem};
use unilateral::scenes::Scene;
use unilateral::study::Study;

use crate::mesh_file::warn_of;
use crate::shared::Request;
use unilateral::work_precision::WorkPrecision;

/// A problem in one dimension: a scene of the catalogue, or a problem of a file.
#[derive(Clone)]
pub enum Posed<const D: usize> {
    Scene(Scene<D>),
    Own(OwnProblem<D>),
}

impl<const D: usize> From<Scene<D>> for Posed<D> {
    fn from(scene: Scene<D>) -> Self {
        Self::Scene(scene)
    }
}

impl<const D: usize> From<OwnProblem<D>> for Posed<D> {
    fn from(own: OwnProblem<D>) -> Self {
        Self::Own(own)
    }
}

impl<const D: usize> Posed<D> {
    pub fn name(&self) -> &str {
        match self {
            Self::Scene(scene) => &scene.name,
            Self::Own(own) => &own.name,
        }
    }
    /// Whether the solution is known.
    pub fn has_exact(&self) -> bool {
        match self {
            Self::Scene(scene) => scene.problem.exact.is_some(),
            Self::Own(own) => own.problem.exact.is_some(),
        }
    }
    /// Whether the problem comes with a mesh file.
    pub fn has_mesh(&self) -> bool {
        matches!(self, Self::Own(OwnProblem { geometry: Geometry::File { .. }, .. }))
    }
    /// A study of the problem, without schemes. Warnings of the mesh file go to `warn`.
    pub fn study<'a>(self, warn: &dyn Fn(String)) -> Request<Study<'a, D>> {
        let own = match self {
            Self::Scene(scene) => return Ok(Study::new(scene)),
            Self::Own(own) => own,
        };
        let read = own.mesh().map_err(|e| e.to_string())?;
        match (own.geometry, read) {
            (Geometry::File { path, .. }, Some(read)) => {
                warn_of(&read.warnings, &path, warn);
                Study::of_problem(&own.name, own.problem, read.mesh)
                    .map_err(|e| format!("{}: {e}", path.display()))
            }
            (Geometry::Box(domain), _) => Ok(Study::new(Scene::new(own.name, domain, own.problem))),
            _ => Err("a problem has a mesh or a box".to_owned()),
        }
    }
    /// A study of work against precision of the problem, without schemes.
    /// Warnings of the mesh file go to `warn`.
    pub fn work_precision<'a>(self, warn: &dyn Fn(String)) -> Request<WorkPrecision<'a, D>> {
        let own = match self {
            Self::Scene(scene) => return Ok(WorkPrecision::new(move || scene.clone())),
            Self::Own(own) => own,
        };
        let read = own.mesh().map_err(|e| e.to_string())?;
        match (own.geometry, read) {
            (Geometry::File { path, .. }, Some(read)) => {
                warn_of(&read.warnings, &path, warn);
                WorkPrecision::of_problem(&own.name, own.problem, read.mesh)
                    .map_err(|e| format!("{}: {e}", path.display()))
            }
            (Geometry::Box(domain), _) => {
                let scene = Scene::new(own.name, domain, own.problem);
                Ok(WorkPrecision::new(move || scene.clone()))
            }
            _ => Err("a problem has a mesh or a box".to_owned()),
        }
    }
}
