//! A numerical test of the derivation of a scene's solution, for authors of scenes.
//!
//! ```
//! use unilateral::scenes::{check_scene, radial};
//!
//! check_scene(&radial::<2>(1.0), 200).unwrap();
//! ```

mod solution;
mod violation;

pub use violation::Violation;

use super::scene::Scene;
use crate::arrays::{array_of, map_entries};
use crate::mesh::{BoundaryFacet, Domain, Mesh};
use crate::problem::Problem;
use crate::real::Point;
use solution::{Scales, Solution};

/// Levels of built-in domains in whose cells points are taken, by dimension.
const LEVELS: [usize; 3] = [64, 19, 7];

/// Holds the exact solution of a scene, if it states one, against the data, at `samples` random points of its domain and
/// as many of the boundary. The points are the same in every run.
///
/// * The gradient is that of the value, by fourth-order central differences.
/// * The solution satisfies the obstacles; the multiplier `-div(alpha grad u) + c u - f` vanishes off contact and on
///   contact has the sign of the active obstacle.
/// * The solution satisfies the boundary data, and the conditions of Signorini and of friction.
/// * Stated multiplier and contact set are those of the solution.
///
/// Points where differences of two steps disagree lie beside an interface or a singularity, and their derivatives are not
/// tested; no more than a quarter may. Tolerances are relative to the largest values met, `1e-8` for obstacles and
/// `1e-6` for the rest. Errors between the points are not detected, nor are data tested where no solution is stated.
///
/// # Errors
///
/// The first [`Violation`] found.
pub fn check_scene<const D: usize>(scene: &Scene<D>, samples: usize) -> Result<(), Violation> {
    let level = if scene.domain.is_mesh() { 0 } else { LEVELS[D - 1] };
    let mesh = scene.domain.mesh(level).and_then(|mesh| match scene.domain {
        Domain::Disc { radius } => {
            mesh.with_shape("dirichlet", move |x| x.norm_squared() - radius * radius)
        }
        _ => Ok(mesh),
    });
    let no_mesh = |error: &dyn ToString| {
        Violation::new(&scene.name, &error.to_string(), &Point::<D>::zeros(), f64::NAN, 0.0)
    };
    check_at(&scene.name, &scene.problem, &mesh.map_err(|e| no_mesh(&e))?, samples)
}

/// [`check_scene`] for a problem on a mesh, at a few points.
///
/// # Errors
/// The first [`Violation`] found.
pub(crate) fn check_exact_on<const D: usize>(
    name: &str,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Result<(), Violation> {
    check_at(name, problem, mesh, 200)
}

fn check_at<const D: usize>(
    name: &str,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    samples: usize,
) -> Result<(), Violation> {
    let Some(exact) = &problem.exact else { return Ok(()) };
    let in_regions: Vec<Problem<D>> =
        mesh.regions().iter().map(|names| problem.in_group(names, &[])).collect();
    let inside: Vec<InCell<D>> = (0..samples).map(|k| InCell::random(mesh, k, samples)).collect();
    let in_region = |at: &InCell<D>, scales| {
        let problem = &in_regions[mesh.region(at.cell)];
        Solution { name, problem, exact, scales }
    };
    let mut scales = Scales { length: mesh.domain_diameter(), ..Scales::default() };
    inside.iter().for_each(|at| scales = in_region(at, scales).scales_with(&at.x));
    let mut skipped = 0;
    for at in &inside {
        let is_known = in_region(at, scales).check_inside(&at.x, at.depth)?;
        skipped += usize::from(!is_known);
        let (by, allowed) = (skipped as f64, (samples / 4) as f64);
        let condition = "second derivatives that differences can resolve";
        in_region(at, scales).require(condition, &at.x, by, allowed)?;
    }
    let boundary = mesh.boundary();
    for k in 0..if boundary.is_empty() { 0 } else { samples } {
        let facet = &boundary[k * boundary.len() / samples];
        let region = &mesh.regions()[mesh.region(facet.cell as usize)];
        let problem =
            &problem.in_group(region, &mesh.boundary_groups()[usize::from(facet.group)].names);
        let (x, normal) = on_facet(mesh, facet, k);
        Solution { name, problem, exact, scales }.check_boundary(&x, &normal, facet.condition)?;
    }
    let solution = Solution { name, problem, exact, scales };
    solution.check_free_boundary(&mut inside.iter().map(|at| &at.x))
}

/// A point in a cell.
struct InCell<const D: usize> {
    cell: usize,
    x: Point<D>,
    /// Its distance from the boundary of the cell.
    depth: f64,
}

impl<const D: usize> InCell<D> {
    /// That of number `k` of so many points, which are evenly spread over the cells.
    fn random(mesh: &Mesh<D>, k: usize, samples: usize) -> Self {
        let cell = k * mesh.n_cells() / samples;
        let (geometry, weights) = (mesh.geometry(cell), weights(k, D + 1));
        let distance = |facet: usize| weights[facet] / geometry.facet_measure(facet);
        let least = (0..=D).map(distance).fold(f64::INFINITY, f64::min);
        let depth = least * D as f64 * geometry.volume;
        Self { cell, x: mesh.point(cell, &weights), depth }
    }
}

/// A point of a facet of the boundary with the outward normal there: the middle on the shape of its group, or a random
/// one of the facet where no group has a shape.
fn on_facet<const D: usize>(
    mesh: &Mesh<D>,
    facet: &BoundaryFacet,
    k: usize,
) -> (Point<D>, Point<D>) {
    let (middle, normal) = mesh.middle_of(facet);
    if mesh.has_shapes() {
        return (middle, normal);
    }
    let vertices = mesh.facet_vertices(facet.cell as usize, usize::from(facet.local));
    let weighted = vertices.zip(weights(k, D)).map(|(v, w)| mesh.vertices()[v as usize] * w);
    (weighted.sum(), normal)
}

/// The barycentric coordinates of number `k` of random points in a simplex with `n` vertices, none of them small: from
/// multiples of irrational numbers without their integer parts.
fn weights(k: usize, n: usize) -> [f64; 4] {
    const STEPS: [f64; 4] = [0.414_213_562, 0.732_050_808, 0.236_067_977, 0.645_751_311];
    let part = |j: usize| 0.1 + (k as f64 * STEPS[j]).fract();
    let parts: [f64; 4] = array_of(|j| if j < n { part(j) } else { 0.0 });
    let sum: f64 = parts.iter().sum();
    map_entries(parts, |part| part / sum)
}
