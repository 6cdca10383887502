//! Compatibility of a mesh and a scene.

use std::collections::BTreeSet;

use crate::assemble::{DataQuadrature, Discretisation};
use crate::constraint::Nodes;
use crate::error::Error;
use crate::mesh::{BoundaryCondition, BoxDomain, Domain, Mesh, describe_point};
use crate::problem::{DataOnMesh, Given, Problem};
use crate::real::Point;
use crate::scenes::Scene;
use crate::scheme::{ConformingP1, Scheme};

/// Checks that a scene fits its domain. Returns the barycentre of a facet of a mesh on which the exact solution of the
/// scene breaks the contact condition, or none.
///
/// Dirichlet and Neumann data of a scene with an exact solution come from that solution wherever
/// the mesh has such boundaries, so it stays the solution on any domain where it is smooth enough. Only
/// the contact condition may fail there: it is tested on every contact facet.
///
/// # Errors
/// [`Error::GivenTwice`]; [`Error::UnfitMesh`] if mesh and scene do not agree on having a contact boundary, if the data
/// of the scene are no data on the mesh: not finite, without an admissible value at a vertex, or Dirichlet data that are
/// not those of the exact solution.
pub fn check_fit<const D: usize>(scene: &Scene<D>) -> Result<Option<String>, Error> {
    scene.problem.check_given_once()?;
    let Domain::Mesh(mesh) = &scene.domain else {
        return check_contact(scene).map(|()| None);
    };
    mesh.check_boundary_conditions()?;
    check_contact(scene)?;
    check_data(scene, mesh).map_err(|why| match why {
        Error::DataNotFinite(_)
        | Error::CoefficientNotPositive(_)
        | Error::EmptyConstraint { .. } => Error::unfit_mesh(&scene.name, why),
        other => other,
    })?;
    Ok(first_failure(scene, mesh))
}

/// Checks that data are finite, that each vertex has an admissible value, and that the exact solution has the Dirichlet
/// data.
fn check_data<const D: usize>(scene: &Scene<D>, mesh: &Mesh<D>) -> Result<(), Error> {
    let problem = scene.problem.clone().on(Nodes);
    let space = Discretisation::new(&ConformingP1, &problem, mesh, DataQuadrature::default())?;
    space.load().and_then(|_| space.bounds())?;
    let Some(exact) = &problem.exact else { return Ok(()) };
    let data = DataOnMesh::new(&problem, mesh)?;
    let at = |x: &Point<D>| exact.value.at(x).abs();
    let size = mesh.vertices().iter().map(at).fold(0.0, f64::max);
    for facet in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Dirichlet) {
        for v in mesh.facet_vertices(facet.cell as usize, usize::from(facet.local)) {
            let x = &mesh.vertices()[v as usize];
            let given = data.dirichlet.of(usize::from(facet.group)).map_or(0.0, |u| u.at(x));
            let solution = exact.value.at(x);
            if (given - solution).abs() > ROUNDED * given.abs().max(size) {
                let place = describe_point(x);
                let why = format!(
                    "its exact solution is {solution} near {place}, where its Dirichlet value is {given}"
                );
                return Err(Error::unfit_mesh(&scene.name, why));
            }
        }
    }
    Ok(())
}

/// Checks that an element can impose the inequality of a problem and that the facet form is made for the
/// element, on a cube and without evaluation of data.
///
/// # Errors
/// [`Error::NothingToBound`], [`Error::UnsupportedForm`], [`Error::Quadrature`].
pub(super) fn check_scheme<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: Problem<D>,
    quadrature: DataQuadrature,
) -> Result<(), Error> {
    // bounds without names, which the cube does not have
    let mut problem = problem;
    for bound in [&mut problem.lower, &mut problem.upper, &mut problem.gap] {
        if bound.everywhere.is_none() && bound.is_given() {
            bound.everywhere = Some(0.0.into());
        }
    }
    let problem = Problem { coefficient: Given::default(), ..problem.in_group(&[], &[]) };
    let cube = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    match scheme.discretise(&problem, &Mesh::kuhn_box(&cube, [1; D])?, quadrature) {
        Err(
            why @ (Error::NothingToBound(_) | Error::UnsupportedForm(_) | Error::Quadrature(_)),
        ) => Err(why),
        _ => Ok(()),
    }
}

/// Checks that the labels of schemes and the names of solvers tell the rows of a study apart: orders are of rows of one
/// label and solver, and files have their names.
///
/// # Errors
/// [`Error::EqualNames`].
pub(super) fn check_names<'n>(
    labels: impl Iterator<Item = &'n str>,
    solvers: impl Iterator<Item = &'n str>,
) -> Result<(), Error> {
    if let Some(label) = first_twice(labels) {
        return Err(Error::equal_schemes(label));
    }
    first_twice(solvers)
        .map_or(Ok(()), |name| Err(Error::equal_names("solvers", name, "`InequalitySolver::name`")))
}

/// The first item that equals one before it.
fn first_twice<'n>(mut items: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let mut before = BTreeSet::new();
    items.find(|item| !before.insert(*item))
}

/// Checks that the domain has a contact boundary if and only if there is a Signorini condition.
fn check_contact<const D: usize>(scene: &Scene<D>) -> Result<(), Error> {
    let why = match (
        scene.problem.has_gap(),
        scene.domain.has_condition(BoundaryCondition::Contact),
    ) {
        (true, false) => {
            "the problem has a Signorini condition, but the mesh has no contact boundary: no group named \"contact\" or with a gap"
        }
        (false, true) => {
            "the mesh has a contact boundary (the group \"contact\"), but the problem has no Signorini condition"
        }
        _ => return Ok(()),
    };
    Err(Error::unfit_mesh(&scene.name, why))
}

/// Error allowed in conditions on the exact solution on the boundary, beside the largest of such numbers: vertices of mesh
/// files are rounded.
const ROUNDED: f64 = 1e-6;

/// The first contact facet on which the exact solution breaks the contact condition.
fn first_failure<const D: usize>(scene: &Scene<D>, mesh: &Mesh<D>) -> Option<String> {
    let data = DataOnMesh::new(&scene.problem, mesh).ok()?;
    let exact = scene.problem.exact.as_ref()?;
    let mut found = Vec::new();
    for facet in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
        let (cell, (x, normal)) = (facet.cell as usize, mesh.middle_of(facet));
        let Some(gap) = data.gap.of(usize::from(facet.group)) else { continue };
        let middle = mesh.barycentre(cell);
        let alpha = data.coefficient.of(mesh.region(cell)).map_or(1.0, |a| a.at(&middle));
        let gradient = (exact.gradient)(&x);
        let flux = data.tensor.of(mesh.region(cell)).map_or(gradient, |t| t.at(&middle) * gradient);
        let opening = exact.value.at(&x) - gap.at(&x);
        // an error of a length counts as much as one of the opening
        let sizes =
            [opening.abs() + gradient.norm() * mesh.cell_diameter(cell), alpha * flux.norm()];
        found.push((x, [opening, alpha * flux.dot(&normal)], sizes));
    }
    let largest = |k: usize| found.iter().map(|(.., sizes)| sizes[k]).fold(0.0, f64::max);
    let allowed = [ROUNDED * largest(0), ROUNDED * largest(1)];
    // opening and pressure are not negative, and one of them vanishes; false for numbers that are not finite
    let holds = |[opening, pressure]: [f64; 2]| {
        opening >= -allowed[0]
            && pressure >= -allowed[1]
            && (opening <= allowed[0] || pressure <= allowed[1])
    };
    let first = found.iter().find(|(_, numbers, _)| !holds(*numbers))?;
    Some(describe_point(&first.0))
}
