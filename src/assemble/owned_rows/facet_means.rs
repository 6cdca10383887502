//! Rows of discontinuous linear functions with facet means as unknowns, where a form acts on means of jumps only.
//!
//! The mean over a facet is one unknown of each of its two cells, so that the row of an unknown has the entries of
//! its own cell and one entry of the cell across: in space 20 entries a cell, where dense blocks have 80.

use super::rows_by_cell::for_each_cell;
use crate::algebra::SparseMatrix;
use crate::assemble::count;
use crate::assemble::facet_coefficients::FacetCoefficients;
use crate::assemble::local::zero_local;
use crate::assemble::space::Space;
use crate::assemble::space::metric::Metrics;
use crate::facet::{FacetForm, FacetKind};
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryPart, Neighbour};
use crate::real::Real;

/// Whether the unknowns are facet means of linear functions and the form sees no other moment of jumps, and no
/// fluxes.
pub(super) fn apply<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    form: &dyn FacetForm<T, D>,
) -> bool {
    // the basis function of a facet is one minus D times the barycentric coordinate opposite to the facet
    !form.is_lifted()
        && !form.uses_flux()
        && space.gradient_factor() == Some(T::lit(-(D as f64)))
        && form.moments(space.basis_degree) == 0
}

/// The pattern, with values zero.
pub(super) fn pattern<T: Real, const D: usize>(space: &Space<'_, T, D>) -> SparseMatrix<T> {
    let neighbours = space.coupled_neighbours();
    let n_cells = space.mesh.n_cells();
    let mut row_starts = in_large_pages(Vec::with_capacity((D + 1) * n_cells + 1));
    row_starts.push(0_u32);
    let mut end = 0;
    for cell in 0..n_cells {
        for local in 0..=D {
            let is_interior = matches!(neighbours.across(cell, local), Neighbour::Cell { .. });
            end += D as u32 + 1 + u32::from(is_interior);
            row_starts.push(end);
        }
    }
    let mut columns = in_large_pages(vec![0_u32; end as usize]);
    for_each_cell(&row_starts, D + 1, &mut columns, |cell, mut rows| {
        let first = (cell * (D + 1)) as u32;
        for local in 0..=D {
            let across = match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local } => {
                    Some((other * (D as u32 + 1) + u32::from(local), (other as usize) < cell))
                }
                Neighbour::Boundary(_) | Neighbour::Cut => None,
            };
            let own = std::array::from_fn(|j| first + j as u32);
            rows = write_row::<_, D>(rows, &own, across);
        }
    });
    let values = in_large_pages(vec![T::lit(0.0); end as usize]);
    SparseMatrix { row_starts, columns, values }
}

/// The values, on that pattern.
pub(super) fn fill<T: Real, const D: usize>(
    space: &Space<'_, T, D>,
    form: &dyn FacetForm<T, D>,
    metrics: &Metrics<T>,
    weights: &FacetCoefficients<T>,
    matrix: &mut SparseMatrix<T>,
) {
    let neighbours = space.coupled_neighbours();
    let moment_weight = T::lit(form.moment_weight(0));
    for_each_cell(&matrix.row_starts, D + 1, &mut matrix.values, |cell, mut rows| {
        let metric = metrics.at::<D>(cell);
        let scale = space.alpha(cell) * T::lit((D * D) as f64);
        let mut own = metric.products.map(|row| row.map(|product| scale * product));
        if let Some(reaction) = &space.reaction {
            let mut products = zero_local();
            reaction.add(space.mesh, cell, metric.volume, &mut products);
            for (row, products) in own.iter_mut().zip(&products) {
                row.iter_mut().zip(products).for_each(|(entry, product)| *entry += *product);
            }
        }
        for (local, mut own) in own.into_iter().enumerate().take(D + 1) {
            let place = (cell, local);
            let (here, kind) = match neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    (place.min((other as usize, other_local as usize)), FacetKind::Interior)
                }
                Neighbour::Boundary(BoundaryPart::Dirichlet) if !space.pins => {
                    (place, FacetKind::Dirichlet)
                }
                Neighbour::Boundary(_) | Neighbour::Cut => {
                    rows = write_row::<_, D>(rows, &own, None);
                    continue;
                }
            };
            count::facets(1);
            let weight = weights.at::<D>(here, here == place, kind);
            let penalty = weight.coefficients.jump_jump.at(weight.penalty * moment_weight);
            let jumps = metric.measures[local] * penalty;
            own[local] += jumps;
            let is_interior = matches!(kind, FacetKind::Interior);
            let across = is_interior.then_some((-jumps, here != place));
            rows = write_row::<_, D>(rows, &own, across);
        }
    });
}

/// Writes the first row of a cell's rows: what belongs to the cell itself, and what belongs to the cell across
/// with whether it comes first. Returns the remaining rows.
#[inline(always)]
fn write_row<'r, V: Copy, const D: usize>(
    rows: &'r mut [V],
    own: &[V; 4],
    across: Option<(V, bool)>,
) -> &'r mut [V] {
    let (row, rest) = rows.split_at_mut(D + 1 + usize::from(across.is_some()));
    match (across, row) {
        (Some((entry, true)), [place, row @ ..]) | (Some((entry, false)), [row @ .., place]) => {
            *place = entry;
            row.copy_from_slice(&own[..=D]);
        }
        (_, row) => row.copy_from_slice(&own[..=D]),
    }
    rest
}
