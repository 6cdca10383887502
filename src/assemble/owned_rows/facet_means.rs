//! Rows of discontinuous linear functions with facet means as unknowns, where a form acts on means of jumps only.
//!
//! The mean over a facet is one unknown of each of the two cells of the facet. The row of an unknown therefore has the
//! entries of the cell that owns the unknown and one entry of the other cell of the facet: the four rows of a
//! tetrahedron have 20 entries, where dense blocks have 80.

use super::rows_by_cell::{self, for_each_cell};
use crate::algebra::SparseMatrix;
use crate::assemble::facet_coefficients::FacetCoefficients;
use crate::assemble::space::Space;
use crate::assemble::space::metric::Metrics;
use crate::facet::{FacetForm, FacetKind};
use crate::mesh::{BoundaryCondition, Neighbour};

/// Whether the unknowns are facet means of linear functions and the form acts on means of jumps only, without higher
/// moments, fluxes and lifts.
pub(super) fn is_applicable<const D: usize>(space: &Space<'_, D>, form: &dyn FacetForm<D>) -> bool {
    // the basis function that has mean one on a facet, and mean zero on the others, is `1 - D lambda` with the
    // barycentric coordinate `lambda` of the vertex opposite to the facet
    !form.is_lifted()
        && !form.uses_flux()
        && space.gradient_factor() == Some(-(D as f64))
        && form.moments(space.basis_degree) == 0
}

/// The pattern, with values zero.
pub(super) fn pattern<const D: usize>(space: &Space<'_, D>) -> SparseMatrix<f64> {
    let neighbours = space.coupled_neighbours();
    let is_interior =
        move |cell, local| matches!(neighbours.across(cell, local), Neighbour::Cell { .. });
    let lengths =
        move |cell| (0..D + 1).map(move |local| D + 1 + usize::from(is_interior(cell, local)));
    rows_by_cell::pattern(space.mesh.n_cells(), D + 1, lengths, |cell, mut rows| {
        let own = std::array::from_fn(|j| (cell * (D + 1) + j) as u32);
        for local in 0..=D {
            let other = match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local } => {
                    Some((other * (D as u32 + 1) + u32::from(local), (other as usize) < cell))
                }
                Neighbour::Boundary(_) | Neighbour::Cut => None,
            };
            rows = write_row::<_, D>(rows, &own, other);
        }
    })
}

/// The values of a matrix with the pattern of [`pattern`].
pub(super) fn fill<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
    metrics: &Metrics,
    weights: &FacetCoefficients,
    matrix: &mut SparseMatrix<f64>,
) {
    let neighbours = space.coupled_neighbours();
    let moment_weight = form.moment_weight(0);
    for_each_cell(&matrix.row_starts, D + 1, &mut matrix.values, |cell, mut rows| {
        let metric = metrics.at::<D>(cell);
        let scale = space.alpha(cell) * ((D * D) as f64);
        let mut own = metric.products.map(|row| row.map(|product| scale * product));
        space.add_reaction(cell, metric.volume, &mut own);
        for (local, mut own) in own.into_iter().enumerate().take(D + 1) {
            let facet = (cell, local);
            let (here, kind) = match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    (facet.min((other as usize, other_local as usize)), FacetKind::Interior)
                }
                Neighbour::Boundary(BoundaryCondition::Dirichlet) if !space.pins => {
                    (facet, FacetKind::Dirichlet)
                }
                Neighbour::Boundary(_) | Neighbour::Cut => {
                    rows = write_row::<_, D>(rows, &own, None);
                    continue;
                }
            };
            let weight = weights.at::<D>(here, here == facet, kind);
            let penalty = weight.coefficients.jump_jump.at(weight.penalty * moment_weight);
            let jumps = metric.measures[local] * penalty;
            own[local] += jumps;
            let is_interior = matches!(kind, FacetKind::Interior);
            let other = is_interior.then_some((-jumps, here != facet));
            rows = write_row::<_, D>(rows, &own, other);
        }
    });
}

/// Writes the first of the rows: the entries in the columns of the cell itself, and the entry in a column of the other
/// cell, which precedes them if the flag is set. Returns the remaining rows.
#[inline(always)]
fn write_row<'r, V: Copy, const D: usize>(
    rows: &'r mut [V],
    own: &[V; 4],
    other: Option<(V, bool)>,
) -> &'r mut [V] {
    let (row, rest) = rows.split_at_mut(D + 1 + usize::from(other.is_some()));
    match (other, row) {
        (Some((entry, true)), [place, row @ ..]) | (Some((entry, false)), [row @ .., place]) => {
            *place = entry;
            row.copy_from_slice(&own[..=D]);
        }
        (_, row) => row.copy_from_slice(&own[..=D]),
    }
    rest
}
