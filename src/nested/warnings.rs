//! The warnings of a solve.

use std::borrow::Cow;

use super::solved::Solved;
use crate::algebra::Inequality;
use crate::assemble::Discretisation;
use crate::inequality::Solution;
use crate::input::excerpt;
use crate::mesh::{BoundaryCondition, Mesh, describe_point};
use crate::problem::{DataOnMesh, Problem};
use crate::real::Precision;

/// The warning on a part of a mesh where nothing proves that the matrix is positive definite.
pub(super) const UNPROVEN: &str = "no theory says that the matrix is positive definite: a penalty is below its proven bound, or a reaction is negative";

/// Edges shorter than a limit, on meshes that were not refined locally: conditions of matrices on bisected meshes depend on
/// the number of cells, but for a logarithm not on the smallest one (R. E. Bank, L. R. Scott, SIAM J. Numer. Anal. 26
/// (1989), 1383-1394).
pub(super) fn short_edges<const D: usize>(
    mesh: &Mesh<D>,
    (limit, precision): (f64, Precision),
) -> Option<String> {
    let shortest = mesh.shortest_edge();
    (shortest < limit).then(|| {
        format!(
            "edges of length {shortest:.1e} are below {limit:.1e}, where rounding in {} may outweigh the discretisation error",
            precision.name()
        )
    })
}

/// Rounding in the assembled matrix of over-penalised quadratics, relative to a solution, from which corrections by its
/// factors do not converge: the matrix is singular to working precision at 2.3 (signorini-2d, `wopsip-p2@eta=1e10`, 8).
const NO_DIGITS: f64 = 1.0;

/// Why over-penalised quadratics in the plane and in space are not solved, if rounding in the assembled matrix, which is
/// factored for them, leaves no digit. It is machine epsilon times an upper estimate of the condition number: the largest
/// ratio of a penalty to the stiffness, `η h^-4`, times that of the stiffness, `n^(2/D)` on `n` cells of about equal
/// size.
pub(super) fn no_digits_of_quadratics(
    inequality: &Inequality<f64>,
    (degree, dimension): (usize, usize),
    precision: Precision,
) -> Option<String> {
    let penalised = inequality.penalised.as_ref().filter(|_| degree > 1 && dimension > 1)?;
    let n_cells = (inequality.size() / penalised.block_size()) as f64;
    let ratio = penalised.largest_ratio();
    let rounding = precision.epsilon() * ratio * n_cells.powf(2.0 / dimension as f64);
    // false for numbers that are not finite
    let has_digits = rounding < NO_DIGITS;
    (!has_digits).then(|| {
        format!(
            "over-penalised quadratics are not solved: a penalty of {ratio:.0e} times the stiffness on {n_cells} cells leaves no digit in {}; choose a smaller `factor` or `eta`, or a coarser mesh",
            precision.name()
        )
    })
}

/// Why a problem is not solved whose penalty leaves no digit of the stiffness in the precision of the solver.
pub(super) fn no_digits_of_stiffness<const D: usize>(
    discretisation: &Discretisation<'_, D>,
    precision: Precision,
) -> Option<String> {
    discretisation.penalty_beyond(precision).map(|ratio| {
        format!(
            "a penalty of {ratio:.0e} times the stiffness leaves no digit of it in {}: choose a smaller factor",
            precision.name()
        )
    })
}

/// The loss by rounding of the problem to the precision of the solver.
pub(super) fn rounding_of_data(
    inequality: &Inequality<f64>,
    precision: Precision,
) -> Option<String> {
    if precision == Precision::Double {
        return None;
    }
    let name = precision.name();
    if !inequality.is_in_range_of::<f32>() {
        return Some(format!("{name} does not hold the numbers of the problem: scale it"));
    }
    let n = inequality.n_bounds_made_equal::<f32>();
    (n > 0).then(|| {
        format!(
            "the lower and the upper bound of {n} unknowns differ by less than rounding in {name}, which fixes them and leaves their forces out"
        )
    })
}

/// The largest share of its load by which the contact forces on a body may differ from the load without a warning; in
/// single precision the root of machine epsilon.
const LARGEST_IMBALANCE: f64 = 1e-6;

/// The share of contact forces, in the sum of absolute values, up to which they may be rounding without a warning, and
/// that of the load from which they count: with a contrast of 1e12 solvers find forces that differ by half a per cent.
const LARGEST_ROUNDING: f64 = 0.01;

/// Contact forces whose rounding is large beside them. On parts of a mesh no part has the sum.
fn uncertain_forces<const D: usize>(solved: &Solved<'_, D>, forces: &[f64]) -> Option<String> {
    let rounding = solved.rounding().filter(|_| solved.part().is_none())?.force;
    let sum = |of: &[f64]| of.iter().map(|force| force.abs()).sum::<f64>();
    let (size, load) = (sum(forces), sum(&solved.inequality().load));
    let is_large = size > LARGEST_ROUNDING * load && rounding > LARGEST_ROUNDING * size;
    is_large.then(|| {
        format!("rounding changes contact forces by up to {rounding:.1e}, of {size:.1e} in absolute values")
    })
}

/// Contact forces of which rounding leaves no digit, or that do not balance the load of a body that contact alone
/// holds.
pub(crate) fn warnings_of_forces<const D: usize>(
    solved: &Solved<'_, D>,
    forces: Option<&[f64]>,
) -> Vec<String> {
    if !solved.has_iterate() || !solved.discretisation().problem().is_constrained() {
        return Vec::new();
    }
    let precision = solved.solution().precision;
    let Some(forces) = forces else {
        return vec![format!(
            "rounding in {} and the residual of the solver leave no digit of the contact forces: resultant and errors of the multiplier are left out",
            precision.name()
        )];
    };
    let inequality = solved.inequality();
    let mut loads = Cow::Borrowed(&inequality.load[..]);
    if !inequality.kinks.is_empty() {
        inequality.add_slopes(loads.to_mut());
    }
    let imbalance = |body: &Vec<(u32, f64)>| {
        let (mut sum, mut size) = (0.0, 0.0);
        for &(i, value) in body {
            let load = value * loads[i as usize];
            sum += value * forces[i as usize] + load;
            size += load.abs();
        }
        (sum, size)
    };
    let bodies = inequality.kernel.iter().map(imbalance);
    let largest = LARGEST_IMBALANCE.max(precision.epsilon().sqrt());
    let unbalanced = bodies.filter(|(sum, size)| sum.abs() > largest * size);
    let text = |(sum, size): (f64, f64)| {
        format!(
            "contact forces on a body that contact alone holds differ by {sum:.1e} from its load, of {size:.1e} in absolute values"
        )
    };
    unbalanced.map(text).chain(uncertain_forces(solved, forces)).collect()
}

/// Values that differ by less than this share of their range, or of the largest one, are equal but for rounding.
const AGREEMENT: f64 = 1e-9;

/// Values that are equal differ by less than this many units of rounding.
const ROUNDINGS: f64 = 8.0;

/// For each two groups whose Dirichlet values differ at a vertex where they meet a sentence with the first such vertex:
/// no function of finite energy takes both values.
pub(super) fn dirichlet_jumps<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>) -> Vec<String> {
    if D == 1 || problem.dirichlet.named.is_empty() {
        return Vec::new();
    }
    let Ok(data) = DataOnMesh::new(problem, mesh) else { return Vec::new() };
    let of_facets = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Dirichlet);
    let mut values: Vec<(u32, usize, f64)> = Vec::new();
    for facet in of_facets {
        let group = usize::from(facet.group);
        for v in mesh.facet_vertices(facet.cell as usize, usize::from(facet.local)) {
            let x = mesh.vertices()[v as usize];
            values.push((v, group, data.dirichlet.of(group).map_or(0.0, |u| u.at(&x))));
        }
    }
    let all = || values.iter().map(|&(.., value)| value);
    let (least, most) =
        (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let rounding = ROUNDINGS * f64::EPSILON * most.abs().max(least.abs());
    let limit = AGREEMENT * (most - least) + rounding;
    values.sort_by_key(|&(v, group, _)| (v, group));
    values.dedup_by_key(|&mut (v, group, _)| (v, group));
    let mut pairs = Vec::new();
    let mut sentences = Vec::new();
    for at_vertex in values.chunk_by(|a, b| a.0 == b.0) {
        let &(v, first, value) = &at_vertex[0];
        let others = at_vertex.iter().filter(|other| (other.2 - value).abs() > limit);
        for &(_, other, of_other) in others {
            if pairs.contains(&(first, other)) {
                continue;
            }
            pairs.push((first, other));
            let name = |group: usize| {
                mesh.boundary_groups()[group].names.first().map(excerpt).unwrap_or_default()
            };
            let x = describe_point(&(mesh.vertices()[v as usize]));
            sentences.push(format!(
                "the Dirichlet values of `{}` and `{}` differ where they meet, {value} and {of_other} at {x}: no function of finite energy takes both, energies grow with the mesh, and bounds are not proven",
                name(first),
                name(other),
            ));
        }
    }
    sentences
}

/// Dirichlet values that lie beyond an obstacle in Bernstein coefficients, as admissible ones may: a quadratic that
/// touches an obstacle between nodes has a coefficient beyond it. By less than a share of the solution it is rounding.
pub(super) fn data_beyond_coefficients<const D: usize>(
    discretisation: &Discretisation<'_, D>,
    solution: &Solution<f64>,
) -> Option<String> {
    // data that are not finite are errors of the assembly
    let (beyond, x) = discretisation.space.data_beyond_coefficients().ok()??;
    let size = solution.values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let rounding = ROUNDINGS * discretisation.space.body_constants.rounding();
    if beyond <= AGREEMENT * size + rounding {
        return None;
    }
    let so = match discretisation.space.pins {
        true => {
            "coefficients that data fix have no bound, and the solution may lie beyond the obstacle near them"
        }
        false => "the solution, whose coefficients are bounded, does not take these values",
    };
    let at = describe_point(&x);
    Some(format!(
        "Dirichlet values lie beyond an obstacle by {beyond:.1e} in the Bernstein coefficient at {at}: {so}"
    ))
}

/// Bernstein coefficients on edges that are not those of the obstacle or gap, which jumps there.
pub(super) fn coefficients_on_jumps<const D: usize>(
    discretisation: &Discretisation<'_, D>,
) -> Option<String> {
    // data that are not finite are errors of the assembly
    let n = discretisation.space.coefficients_on_jumps().ok().filter(|&n| n > 0)?;
    Some(format!(
        "an obstacle or a gap jumps at {n} Bernstein coefficients of edges: these are taken from one side of the jump, and within edges that it cuts the solution may lie beyond the datum"
    ))
}
