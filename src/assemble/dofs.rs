//! Which unknowns a cell has.

use std::borrow::Cow;

use crate::element::Layout;
use crate::mesh::{Edges, Facets, Mesh, Neighbours};
use crate::real::Real;

/// Unknowns by cell: consecutive for broken spaces, a table for others.
pub(crate) struct Dofs<'a> {
    table: Option<Cow<'a, [u32]>>,
    per_cell: usize,
    size: usize,
}

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
    /// The numbering of a layout; facets that own unknowns are told by `neighbours`.
    pub fn new<T: Real, const D: usize>(
        layout: Layout,
        mesh: &'a Mesh<T, D>,
        neighbours: Option<&Neighbours>,
    ) -> Self {
        let per_cell = layout.per_cell(D);
        if layout.is_broken() {
            return Self { table: None, per_cell, size: per_cell * mesh.n_cells() };
        }
        let mut owners = Vec::new();
        if layout.vertex > 0 {
            let (numbers, count) = (Cow::Borrowed(mesh.cells()), mesh.vertices().len());
            owners.push(Owners { unknowns: layout.vertex, numbers, count });
        }
        if layout.edge > 0 {
            let edges = Edges::of(mesh);
            let numbers = Cow::Owned(edges.numbers(mesh));
            owners.push(Owners { unknowns: layout.edge, numbers, count: edges.len() });
        }
        if let (true, Some(neighbours)) = (layout.facet > 0, neighbours) {
            let facets = Facets::of(mesh, neighbours);
            let numbers = Cow::Owned(facets.numbers::<D>(mesh.n_cells()));
            owners.push(Owners { unknowns: layout.facet, numbers, count: facets.len() });
        }
        if layout.cell > 0 {
            let (numbers, count) = ((0..mesh.n_cells() as u32).collect(), mesh.n_cells());
            owners.push(Owners { unknowns: layout.cell, numbers, count });
        }
        let size = owners.iter().map(|o| o.unknowns * o.count).sum();
        let table = match owners.pop() {
            // one unknown for each: the table is that of the owners, for vertices the mesh's own
            Some(only) if owners.is_empty() && only.unknowns == 1 => only.numbers,
            last => {
                owners.extend(last);
                Cow::Owned(table(&owners, mesh.n_cells(), per_cell))
            }
        };
        Self { table: Some(table), per_cell, size }
    }
    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.size
    }
    /// Unknown `i` of a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize, i: usize) -> usize {
        let k = cell * self.per_cell + i;
        self.table.as_ref().map_or(k, |t| t[k] as usize)
    }
}

/// The unknowns of every cell: first those of the first owners, and so on.
fn table(owners: &[Owners<'_>], n_cells: usize, per_cell: usize) -> Vec<u32> {
    let mut table = Vec::with_capacity(n_cells * per_cell);
    for cell in 0..n_cells {
        let mut first = 0;
        for of in owners {
            let n = of.numbers.len() / n_cells;
            for &owner in &of.numbers[cell * n..(cell + 1) * n] {
                let start = first + owner as usize * of.unknowns;
                table.extend((start..start + of.unknowns).map(|unknown| unknown as u32));
            }
            first += of.unknowns * of.count;
        }
    }
    table
}
