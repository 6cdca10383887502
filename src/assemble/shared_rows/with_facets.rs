//! Rows of spaces that share unknowns and have a form on facets, which is rare: one loop over cells and
//! facets on one thread. Each adds a small dense matrix to its rows, whose columns are searched.

use super::fill::add_by_search;
use crate::algebra::SparseMatrix;
use crate::assemble::space::Space;
use crate::assemble::space::form_facets::FormFacet;
use crate::assemble::space::tables::FacetTable;
use crate::assemble::stiffness::Local;
use crate::assemble::trace::traces;
use crate::element::MAX_BASIS;
use crate::facet::{FacetForm, Trace};
use crate::mesh::HalfFacet;

/// A matrix for the unknowns of the two cells of a facet, of which the upper left corner is used.
type FacetMatrix = [[f64; 2 * MAX_BASIS]; 2 * MAX_BASIS];

/// The unknowns of a cell, or of the two cells of a facet, where those that the cells share come twice.
fn list_unknowns<const D: usize>(
    space: &Space<'_, D>,
    cell: usize,
    other: Option<usize>,
    unknowns: &mut Vec<u32>,
) {
    let of_cell = |cell| (0..space.per_cell()).map(move |i| space.dofs.of(cell, i) as u32);
    unknowns.clear();
    unknowns.extend([cell].into_iter().chain(other).flat_map(of_cell));
}

/// The pattern, with values zero.
pub(crate) fn pattern<const D: usize>(space: &Space<'_, D>) -> SparseMatrix<f64> {
    let of_cells = (0..space.mesh.n_cells()).map(|cell| (cell, None));
    let of_facets =
        space.form_facets().map(|facet| (facet.here.0, facet.there.map(|(cell, _)| cell)));
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); space.dofs.size()];
    let mut unknowns = Vec::new();
    for (cell, other) in of_cells.chain(of_facets) {
        list_unknowns(space, cell, other, &mut unknowns);
        for &row in &unknowns {
            rows[row as usize].extend_from_slice(&unknowns);
        }
    }
    let (mut row_starts, mut columns) = (vec![0], Vec::new());
    for mut row in rows {
        row.sort_unstable();
        row.dedup();
        columns.append(&mut row);
        row_starts.push(columns.len() as u32);
    }
    let values = vec![0.0; columns.len()];
    SparseMatrix { row_starts, columns, values }
}

/// The values, on a known pattern.
pub(crate) fn fill<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
    matrix: &mut SparseMatrix<f64>,
) {
    matrix.values.fill(0.0);
    let stiffness = space.stiffness_table();
    let mut unknowns = Vec::new();
    for cell in 0..space.mesh.n_cells() {
        let (volume, products) = space.shape(cell, 1.0);
        let mut local: Local = space.stiffness(&stiffness, cell, &products);
        space.add_reaction(cell, volume, &mut local);
        list_unknowns(space, cell, None, &mut unknowns);
        add(matrix, &unknowns, &local);
    }
    let table = space.facet_table(form.moments(space.basis_degree));
    for facet in space.form_facets() {
        let local = facet_matrix(space, form, &table, facet);
        list_unknowns(space, facet.here.0, facet.there.map(|(cell, _)| cell), &mut unknowns);
        add(matrix, &unknowns, &local);
    }
}

/// Adds the matrix of these unknowns.
fn add<const N: usize>(matrix: &mut SparseMatrix<f64>, unknowns: &[u32], local: &[[f64; N]]) {
    let SparseMatrix { row_starts, columns, values } = matrix;
    for (&row, entries) in unknowns.iter().zip(local) {
        let range = row_starts[row as usize] as usize..row_starts[row as usize + 1] as usize;
        add_by_search(&mut values[range.clone()], &columns[range], unknowns, &|j| entries[j]);
    }
}

/// The form on one facet, for the unknowns of here and then there.
fn facet_matrix<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
    table: &FacetTable,
    facet: FormFacet,
) -> FacetMatrix {
    let n = space.per_cell();
    let FormFacet { here, there } = facet;
    let view = space.facet_view(facet, None);
    let (penalty, average_weight) = (form.penalty(&view), form.average_weight(&view));
    let traces_of = |own: HalfFacet, weight, k: usize| {
        let weighted = space.flux_derivatives(own, facet.other(own), weight, k);
        let basis = (&table.on(own.1)[k], weighted.as_ref());
        traces(
            form,
            &view,
            (&space.metric(own.0), own.1),
            (own == here, space.normal_component(own)),
            basis,
            n,
        )
    };
    let mut out = [[0.0; 2 * MAX_BASIS]; 2 * MAX_BASIS];
    for (k, &degree) in table.degrees.iter().enumerate() {
        let mut all = [Trace { jump: 0.0, flux: 0.0 }; 2 * MAX_BASIS];
        all[..n].copy_from_slice(&traces_of(here, average_weight, k)[..n]);
        if let Some(there) = there {
            all[n..2 * n].copy_from_slice(&traces_of(there, 1.0 - average_weight, k)[..n]);
        }
        let penalty = penalty * form.moment_weight(degree);
        let size = if there.is_some() { 2 * n } else { n };
        for (row, v) in out.iter_mut().zip(&all[..size]) {
            for (entry, u) in row.iter_mut().zip(&all[..size]) {
                *entry += view.measure * form.integrand(&view, *v, *u, penalty);
            }
        }
    }
    out
}
