//! The conditions of an exact solution that need no built-in domain, on a mesh.

use super::evaluator::{Evaluator, Scales};
use super::samples::BoundaryPoint;
use super::violation::Violation;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Point;

/// Most cells, and most facets of the boundary, at whose barycentres conditions are tested.
const MOST: usize = 200;

/// Error allowed on the boundary, relative to the scales of value and flux: vertices of mesh files are rounded.
const ROUNDED: f64 = 1e-6;

/// Holds the exact solution of a problem against the data on a mesh, at the barycentres of cells and of facets of the
/// boundary: equation, obstacles, sign of the multiplier, boundary data and Signorini conditions.
///
/// # Errors
/// The first [`Violation`] found.
pub(crate) fn check_exact_on<const D: usize>(
    name: &str,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Result<(), Violation> {
    let Some(exact) = &problem.exact else { return Ok(()) };
    let cells: Vec<usize> = sampled(mesh.n_cells()).collect();
    let in_regions: Vec<Problem<D>> =
        mesh.regions().iter().map(|names| problem.in_group(names, &[])).collect();
    let middle = |&cell: &usize| mesh.barycentre(cell);
    let length = mesh.domain_diameter();
    let mut scales = Scales::NONE;
    for (region, problem) in in_regions.iter().enumerate() {
        let of_region = cells.iter().filter(|&&cell| mesh.region(cell) == region);
        let points: Vec<Point<D>> = of_region.map(middle).collect();
        scales = scales.max(Evaluator::new(name, (problem, exact), length, &points).scales);
    }
    for cell in &cells {
        let problem = &in_regions[mesh.region(*cell)];
        let evaluator = Evaluator { name, problem, exact, scales };
        let (geometry, x) = (mesh.geometry(*cell), middle(cell));
        evaluator.check_obstacles(&[x])?;
        // the barycentre has from each facet a share of the height over it
        let volume = geometry.volume;
        let largest = (0..D + 1).map(|k| geometry.facet_measure(k)).fold(0.0, f64::max);
        let depth = D as f64 * volume / largest / (D + 1) as f64;
        evaluator.check_multiplier_at(&x, depth)?;
    }
    for k in sampled(mesh.boundary().len()) {
        let facet = &mesh.boundary()[k];
        let cell = facet.cell as usize;
        let group = &mesh.boundary_groups()[usize::from(facet.group)].names;
        let problem = &problem.in_group(&mesh.regions()[mesh.region(cell)], group);
        let evaluator = Evaluator { name, problem, exact, scales };
        let (x, normal) = mesh.middle_of(facet);
        let point = BoundaryPoint { x, normal, condition: facet.condition };
        evaluator.check_boundary_at(&point, ROUNDED)?;
    }
    Ok(())
}

/// Numbers below `n`, evenly spread, at most [`MOST`] and some.
fn sampled(n: usize) -> impl Iterator<Item = usize> {
    (0..n).step_by(n.div_ceil(MOST).max(1))
}
