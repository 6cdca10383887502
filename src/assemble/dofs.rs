//! Which unknowns a cell has.

use std::borrow::Cow;

use crate::mesh::Mesh;
use crate::real::Real;

/// Unknowns by cell: consecutive for broken spaces, a table for others.
pub(crate) struct Dofs<'a> {
    table: Option<Cow<'a, [u32]>>,
    per_cell: usize,
    size: usize,
}

impl<'a> Dofs<'a> {
    /// Every cell owns its unknowns.
    pub fn broken(per_cell: usize, n_cells: usize) -> Self {
        Self { table: None, per_cell, size: per_cell * n_cells }
    }
    /// One unknown for each vertex: the table is the mesh's own.
    pub fn vertices<T: Real, const D: usize>(mesh: &'a Mesh<T, D>) -> Self {
        let table = Some(Cow::Borrowed(mesh.cells()));
        Self { table, per_cell: D + 1, size: mesh.vertices().len() }
    }
    /// Any other table.
    pub fn shared(table: Vec<u32>, per_cell: usize, size: usize) -> Self {
        Self { table: Some(Cow::Owned(table)), per_cell, size }
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
