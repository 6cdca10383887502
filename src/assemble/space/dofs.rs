//! Which unknowns a cell has.

use std::borrow::Cow;
use std::ops::Range;

use crate::parallel::vectors::for_each_chunk_of_groups;

use crate::element::Layout;
use crate::memory::in_large_pages;
use crate::mesh::{Edges, Facets, Mesh, Neighbours};

/// Unknowns by cell: consecutive for broken spaces, a table for others.
pub(crate) struct Dofs<'a> {
    /// Who owns the unknowns.
    layout: Layout,
    table: Option<Cow<'a, [u32]>>,
    per_cell: usize,
    /// The unknowns of vertices, edges, facets and cells, in this order.
    kinds: [Range<u32>; KINDS],
}

/// Kinds of owners of unknowns: vertices, edges, facets and cells.
pub(crate) const KINDS: usize = 4;

/// Vertices, edges, facets or cells that own unknowns.
struct Owners<'a> {
    /// Unknowns of each.
    unknowns: usize,
    /// Those of every cell, in its own order.
    numbers: Cow<'a, [u32]>,
    /// How many there are.
    count: usize,
}

impl<'a> Dofs<'a> {
    /// The numbering of a layout; facets that own unknowns are found by `neighbours`.
    pub fn new<const D: usize>(
        layout: Layout,
        mesh: &'a Mesh<D>,
        neighbours: Option<&Neighbours>,
    ) -> Self {
        let (per_cell, n_cells) = (layout.per_cell(D), mesh.n_cells());
        let mut dofs = Self { layout, table: None, per_cell, kinds: Default::default() };
        if layout.is_broken() {
            dofs.kinds = ranges([0, 0, 0, per_cell * n_cells]);
            return dofs;
        }
        let none = || Owners { unknowns: 0, numbers: Cow::Borrowed(&[]), count: 0 };
        let mut owners: [Owners<'_>; KINDS] = std::array::from_fn(|_| none());
        if layout.vertex > 0 {
            let (numbers, count) = (Cow::Borrowed(mesh.cells()), mesh.vertices().len());
            owners[0] = Owners { unknowns: layout.vertex, numbers, count };
        }
        if layout.edge > 0 {
            let (edges, numbers) = Edges::with_cell_edges(mesh);
            let numbers = Cow::Owned(numbers);
            owners[1] = Owners { unknowns: layout.edge, numbers, count: edges.len() };
        }
        if let (true, Some(neighbours)) = (layout.facet > 0, neighbours) {
            let facets = Facets::new(mesh, neighbours);
            let numbers = Cow::Owned(facets.numbers::<D>(n_cells));
            owners[2] = Owners { unknowns: layout.facet, numbers, count: facets.len() };
        }
        if layout.cell > 0 {
            let numbers = (0..n_cells as u32).collect();
            owners[3] = Owners { unknowns: layout.cell, numbers, count: n_cells };
        }
        dofs.kinds = ranges(owners.each_ref().map(|o| o.unknowns * o.count));
        let only = owners.iter().position(|o| o.unknowns * o.numbers.len() == per_cell * n_cells);
        dofs.table = Some(match only {
            // one unknown for each: the table is that of the owners, for vertices the mesh's own
            Some(only) if owners[only].unknowns == 1 => owners[only].numbers.clone(),
            _ => Cow::Owned(table(&owners, n_cells, per_cell)),
        });
        dofs
    }
    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.kinds[KINDS - 1].end as usize
    }
    /// Unknowns of a cell.
    pub(crate) fn per_cell(&self) -> usize {
        self.per_cell
    }
    /// The unknowns of each kind of owner.
    pub(crate) fn kinds(&self) -> &[Range<u32>; KINDS] {
        &self.kinds
    }
    /// Which kind owns unknown `i` of a cell of this dimension.
    pub(crate) fn kind(&self, dimension: usize, i: usize) -> usize {
        let vertices = Layout { edge: 0, facet: 0, cell: 0, ..self.layout }.per_cell(dimension);
        let edges = Layout { facet: 0, cell: 0, ..self.layout }.per_cell(dimension);
        let facets = Layout { cell: 0, ..self.layout }.per_cell(dimension);
        usize::from(i >= vertices) + usize::from(i >= edges) + usize::from(i >= facets)
    }
    /// The unknowns of all cells where they are not simply consecutive.
    pub(crate) fn table(&self) -> Option<&[u32]> {
        self.table.as_deref()
    }
    /// The unknowns of some cells, in a buffer if they have no table.
    #[inline(always)]
    pub(crate) fn of_cells<'d>(
        &'d self,
        cells: Range<usize>,
        buffer: &'d mut Vec<u32>,
    ) -> &'d [u32] {
        let range = cells.start * self.per_cell..cells.end * self.per_cell;
        match &self.table {
            Some(table) => &table[range],
            None => {
                buffer.clear();
                buffer.extend(range.map(|k| k as u32));
                buffer
            }
        }
    }
    /// Unknown `i` of a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize, i: usize) -> usize {
        let k = cell * self.per_cell + i;
        self.table.as_ref().map_or(k, |t| t[k] as usize)
    }
}

/// Consecutive ranges of these lengths.
fn ranges(lengths: [usize; KINDS]) -> [Range<u32>; KINDS] {
    let mut end = 0;
    lengths.map(|length| {
        end += length as u32;
        end - length as u32..end
    })
}

/// The unknowns of every cell: first those of the first owners, and so on.
fn table(owners: &[Owners<'_>; KINDS], n_cells: usize, per_cell: usize) -> Vec<u32> {
    let mut table = in_large_pages(vec![0; n_cells * per_cell]);
    let fill = |(cell, mut out): (usize, &mut [u32])| {
        let mut first = 0;
        for of in owners {
            let n = of.numbers.len() / n_cells;
            for &owner in &of.numbers[cell * n..(cell + 1) * n] {
                let start = first + owner as usize * of.unknowns;
                let (own, rest) = out.split_at_mut(of.unknowns);
                own.iter_mut().enumerate().for_each(|(k, unknown)| *unknown = (start + k) as u32);
                out = rest;
            }
            first += of.unknowns * of.count;
        }
    };
    for_each_chunk_of_groups(&mut table, per_cell, |range, table| {
        let first = range.start / per_cell;
        table.chunks_exact_mut(per_cell).enumerate().for_each(|(k, out)| fill((first + k, out)));
    });
    table
}
