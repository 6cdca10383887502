//! Rows of spaces that share unknowns and have a form on facets: local matrices first, then every
//! row gathers its own entries.
//!
//! A patch is a cell, or an interior or Dirichlet facet with its cells. Each patch fills a small
//! dense matrix in parallel; then each row adds up what its patches hold, in the order of patches,
//! so the sum does not depend on how the work was split.

use std::convert::Infallible;
use std::ops::Range;

use crate::algebra::SparseMatrix;
use crate::assemble::count;
use crate::assemble::space::Space;
use crate::assemble::space::form_facets::FormFacet;
use crate::assemble::space::tables::FacetTable;
use crate::assemble::trace::traces;
use crate::element::MAX_BASIS;
use crate::facet::{FacetForm, Trace};
use crate::mesh::{BoundaryPart, Facets};
use crate::parallel::cells;

/// The patches of a discretisation and the unknowns of each.
struct Patches<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    form: &'s dyn FacetForm<D>,
    facets: Option<Facets>,
    /// Number of facets that carry the form.
    coupled: usize,
    /// Unknowns of a cell.
    n: usize,
}

impl<'s, 'a, const D: usize> Patches<'s, 'a, D> {
    fn new(space: &'s Space<'a, D>, form: &'s dyn FacetForm<D>) -> Self {
        let facets = space
            .neighbours
            .as_ref()
            .filter(|_| form.couples())
            .map(|neighbours| Facets::new(space.mesh, neighbours));
        let coupled = facets.as_ref().map_or(0, |f| match space.pins {
            false => f.part(BoundaryPart::Dirichlet).end,
            true => f.interior().end,
        });
        Self { space, form, facets, coupled, n: space.per_cell() }
    }
    fn n_cells(&self) -> usize {
        self.space.mesh.n_cells()
    }
    /// Number of patches.
    fn len(&self) -> usize {
        self.n_cells() + self.coupled
    }
    /// Number of unknowns of a patch; those of a facet's two cells count twice where shared.
    #[inline(always)]
    fn size(&self, patch: usize) -> usize {
        if patch < self.n_cells() { self.n } else { 2 * self.n }
    }
    /// Where a patch's local matrix starts.
    #[inline(always)]
    fn start(&self, patch: usize) -> usize {
        let cells = patch.min(self.n_cells());
        self.n * self.n * (cells + 4 * (patch - cells))
    }
    /// Unknown `k` of a patch.
    #[inline(always)]
    fn unknown(&self, patch: usize, k: usize) -> u32 {
        let cell = match &self.facets {
            Some(facets) if patch >= self.n_cells() => {
                let facet = patch - self.n_cells();
                if k < self.n { facets.here(facet).0 } else { facets.there(facet).0 }
            }
            _ => patch,
        };
        self.space.dofs.of(cell, k % self.n) as u32
    }
    /// For each unknown, the places (patch, position in it) at which it occurs, in order.
    fn incidence(&self) -> (Vec<u32>, Vec<(u32, u32)>) {
        let size = self.space.dofs.size();
        let mut starts = vec![0_u32; size + 1];
        for patch in 0..self.len() {
            for k in 0..self.size(patch) {
                starts[self.unknown(patch, k) as usize + 1] += 1;
            }
        }
        for i in 0..size {
            starts[i + 1] += starts[i];
        }
        let mut fill = starts.clone();
        let mut places = vec![(0_u32, 0_u32); starts[size] as usize];
        for patch in 0..self.len() {
            for k in 0..self.size(patch) {
                let at = &mut fill[self.unknown(patch, k) as usize];
                places[*at as usize] = (patch as u32, k as u32);
                *at += 1;
            }
        }
        (starts, places)
    }
}

/// The pattern, with values zero.
pub(crate) fn pattern<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
) -> SparseMatrix<f64> {
    let patches = Patches::new(space, form);
    let (starts, places) = patches.incidence();
    let size = space.dofs.size();
    let rows_of = |rows: Range<usize>| {
        let mut columns: Vec<u32> = Vec::new();
        let mut lengths = Vec::with_capacity(rows.len());
        let mut row = Vec::new();
        for i in rows {
            row.clear();
            for &(patch, _) in &places[starts[i] as usize..starts[i + 1] as usize] {
                let patch = patch as usize;
                row.extend((0..patches.size(patch)).map(|k| patches.unknown(patch, k)));
            }
            row.sort_unstable();
            row.dedup();
            columns.extend_from_slice(&row);
            lengths.push(row.len() as u32);
        }
        (columns, lengths)
    };
    let chunks = cells::map(size, &rows_of);
    let mut row_starts = Vec::with_capacity(size + 1);
    row_starts.push(0);
    let mut columns = Vec::with_capacity(chunks.iter().map(|p| p.0.len()).sum());
    let mut end = 0;
    for (chunk, lengths) in chunks {
        columns.extend_from_slice(&chunk);
        row_starts.extend(lengths.into_iter().map(|length| {
            end += length;
            end
        }));
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
    let patches = Patches::new(space, form);
    let locals = local_matrices(&patches);
    let (starts, places) = patches.incidence();
    let SparseMatrix { row_starts, columns, values } = matrix;
    let gather = |rows: Range<usize>, chunk: &mut [f64]| {
        chunk.fill(0.0);
        let offset = row_starts[rows.start] as usize;
        for i in rows {
            let range = row_starts[i] as usize..row_starts[i + 1] as usize;
            let row_columns = &columns[range.clone()];
            let row = &mut chunk[range.start - offset..range.end - offset];
            for &(patch, k) in &places[starts[i] as usize..starts[i + 1] as usize] {
                let patch = patch as usize;
                let n = patches.size(patch);
                let start = patches.start(patch) + k as usize * n;
                for (j, &entry) in locals[start..start + n].iter().enumerate() {
                    let column = patches.unknown(patch, j);
                    let at = row_columns.iter().position(|&c| c == column);
                    row[at.expect("the pattern has the entries of its patches")] += entry;
                }
            }
        }
        Ok::<(), Infallible>(())
    };
    let end = |row: usize| row_starts[row] as usize;
    let Ok(()) = cells::for_each(row_starts.len() - 1, &end, values, &gather);
}

fn local_matrices<const D: usize>(patches: &Patches<'_, '_, D>) -> Vec<f64> {
    let (n, space) = (patches.n, patches.space);
    let stiffness = space.stiffness_table();
    let mut locals = vec![0.0; patches.start(patches.len())];
    let (cells, facets) = locals.split_at_mut(patches.start(patches.n_cells()));
    let of_cells = |range: Range<usize>, entries: &mut [f64]| {
        for (cell, out) in range.zip(entries.chunks_exact_mut(n * n)) {
            let metric = space.metric(cell);
            let mut local = space.stiffness(&stiffness, cell, &metric);
            if let Some(reaction) = &space.reaction {
                reaction.add(space.mesh, cell, metric.volume, &mut local);
            }
            for (row, values) in out.chunks_exact_mut(n).zip(&local) {
                row.copy_from_slice(&values[..n]);
            }
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = cells::for_each(patches.n_cells(), &|c| c * n * n, cells, &of_cells);
    if let Some(all) = &patches.facets {
        let table = space.facet_table(patches.form.moments(space.basis_degree));
        let of_facets = |range: Range<usize>, entries: &mut [f64]| {
            for (facet, out) in range.zip(entries.chunks_exact_mut(4 * n * n)) {
                facet_matrix(patches, all, &table, facet, out);
            }
            Ok::<(), Infallible>(())
        };
        let end = |f: usize| f * 4 * n * n;
        let Ok(()) = cells::for_each(patches.coupled, &end, facets, &of_facets);
    }
    locals
}

/// The form on one facet, for the unknowns of here and then there; on the boundary those of there
/// stay zero.
fn facet_matrix<const D: usize>(
    patches: &Patches<'_, '_, D>,
    facets: &Facets,
    table: &FacetTable,
    facet: usize,
    out: &mut [f64],
) {
    count::facets(1);
    let (n, space, form) = (patches.n, patches.space, patches.form);
    let interior = facets.interior().contains(&facet);
    let ((here, i), (there, j)) = (facets.here(facet), facets.there(facet));
    let (m_here, m_there) = (space.metric(here), space.metric(there));
    let (own, other) = ((here, i), interior.then_some((there, j)));
    let view = space.facet_view(FormFacet { here: own, there: other }, None);
    let penalty = form.penalty(&view);
    let average_weight = form.average_weight(&view);
    let moments = table.on(i).iter().zip(table.on(j)).zip(&table.degrees).enumerate();
    for (k, ((b_here, b_there), &degree)) in moments {
        let mut all = [Trace { jump: 0.0, flux: 0.0 }; 2 * MAX_BASIS];
        let weighted = space.flux_derivatives(own, other, average_weight, k);
        let basis = (b_here, weighted.as_ref());
        all[..n].copy_from_slice(&traces(form, &view, (&m_here, i), true, basis, n)[..n]);
        if interior {
            let weight = 1.0 - average_weight;
            let weighted = space.flux_derivatives((there, j), Some(own), weight, k);
            let basis = (b_there, weighted.as_ref());
            all[n..2 * n]
                .copy_from_slice(&traces(form, &view, (&m_there, j), false, basis, n)[..n]);
        }
        let penalty = penalty * form.moment_weight(degree);
        let size = if interior { 2 * n } else { n };
        for v in 0..size {
            for u in 0..size {
                out[v * 2 * n + u] += view.measure * form.integrand(&view, all[v], all[u], penalty);
            }
        }
    }
}
