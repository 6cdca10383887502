//! Scenes, meshes and solves of tests of discretisations.

use crate::support::schemes::Entry;
use crate::support::tables::Figures;
use std::path::Path;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{Mesh, gmsh};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::scheme::Regularity;

/// Solves on one mesh from a cold start.
pub fn solve<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Figures {
    solve_in(Precision::Double, scheme, problem, mesh)
}

/// As [`solve`], in a precision.
pub fn solve_in<const D: usize>(
    precision: Precision,
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Figures {
    let solver = in_precision(precision, ActiveSet::default());
    let nested = NestedIteration::new(problem, mesh).shared_solver(solver.into());
    let mut nested = nested.cold_start(true);
    Figures::of(&nested.solve(scheme).unwrap())
}

impl<const D: usize> Entry<D> {
    /// The problem with the constraint set.
    pub fn constrain(&self, problem: &Problem<D>) -> Problem<D> {
        problem.clone().on(self.set.clone())
    }
}

/// A scene of a test's own.
pub fn own_scene<const D: usize>(
    name: &str,
    domain: BoxDomain<D>,
    problem: Problem<D>,
) -> Scene<D> {
    Scene::new(name, domain, problem).summary("of a test").regularity(Regularity::smooth())
}

/// A mesh of the folder of test data.
pub fn small_mesh<const D: usize>(name: &str) -> Mesh<D> {
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name))
}

/// A mesh of the folder that the variable `UNILATERAL_MESHES` names: for tests that are ignored because
/// they need it.
pub fn mesh_of_folder<const D: usize>(name: &str) -> Mesh<D> {
    let folder = std::env::var_os("UNILATERAL_MESHES");
    read(&Path::new(&folder.expect("UNILATERAL_MESHES names the folder of meshes")).join(name))
}

fn read<const D: usize>(path: &Path) -> Mesh<D> {
    gmsh::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).mesh
}
