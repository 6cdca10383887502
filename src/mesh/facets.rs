//! Facets, and the two cells of each.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::arrays::array_of;
use crate::parallel::map_indices;

use super::boundary::BoundaryCondition;
use super::error::{MeshError, MeshErrorKind};
use super::incidence::{FirstVertices, VertexToCells, vertex_ranges};
use super::simplicial::Mesh;
use crate::memory::in_large_pages;

/// A half-facet, a facet seen from one of its cells: the cell, and the number of the facet in it.
pub type HalfFacet = (usize, usize);

/// The other side of a facet of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbour {
    /// A cell, and the number of the facet in it.
    Cell {
        /// The cell.
        cell: u32,
        /// Number of the facet in it.
        local: u8,
    },
    /// The boundary.
    Boundary(BoundaryCondition),
    /// Cells that the mesh does not have, because it is a [part](super::Part) of another one: no data are
    /// given here, nothing is bound, and no form has a term.
    Cut,
}

/// The other side of every facet of every cell.
///
/// # Panics
/// [`Neighbours::across`] panics if there is no such cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Neighbours {
    /// `D + 1` for each cell.
    codes: Vec<u32>,
    per_cell: usize,
}

/// Codes from here on are boundary conditions; codes below are half-facets.
const BOUNDARY: u32 = u32::MAX - 3;
/// Neither a second cell nor a boundary condition: not known yet, or cut.
const UNKNOWN: u32 = u32::MAX;
/// Largest number of cells the codes can name.
pub(crate) const CELL_LIMIT: usize = (BOUNDARY as usize) / 4;

/// The vertices of a facet of a cell with these vertices, in the order of the cell.
pub(super) fn facet_of<const D: usize>(cell: &[u32], local: usize) -> [u32; D] {
    array_of(|k| cell[k + usize::from(k >= local)])
}

/// The code of a half-facet: four times the cell plus the number of the facet in it.
fn half_facet_code(cell: usize, local: usize) -> u32 {
    (cell * 4 + local) as u32
}

impl Neighbours {
    /// The neighbours in a mesh, in time linear in its cells.
    pub fn new<const D: usize>(mesh: &Mesh<D>) -> Self {
        let mut found = Self::match_facets::<D>(mesh.cells(), mesh.vertices().len())
            .expect("the facets of a mesh were matched when it was made");
        for f in mesh.boundary() {
            found.set(f.cell as usize, f.local as usize, f.condition);
        }
        found
    }

    /// The neighbours of cells with ascending vertices; facets of one cell only get the code `UNKNOWN`.
    pub(super) fn match_facets<const D: usize>(
        cells: &[u32],
        n_vertices: usize,
    ) -> Result<Self, MeshError> {
        // the lowest vertex of a facet is the first or the second of its cell
        let incidence = VertexToCells::<D>::new(cells, FirstVertices(2));
        let mut codes = in_large_pages(Vec::with_capacity(cells.len()));
        codes.resize_with(cells.len(), || AtomicU32::new(UNKNOWN));
        let matched = |range: &Range<u32>| match_facets_of(&incidence, range, &codes);
        let ranges = vertex_ranges(n_vertices);
        for outcome in map_indices(ranges.len(), &|k| matched(&ranges[k])) {
            outcome?;
        }
        // the codes of a facet are written by one task only, that of the lowest vertex of the facet
        let codes = codes.into_iter().map(AtomicU32::into_inner).collect();
        Ok(Self { codes, per_cell: D + 1 })
    }

    /// The other side of facet `local` of a cell.
    #[inline(always)]
    pub fn across(&self, cell: usize, local: usize) -> Neighbour {
        let code = self.codes[cell * self.per_cell + local];
        match code.wrapping_sub(BOUNDARY) {
            0 => Neighbour::Boundary(BoundaryCondition::Dirichlet),
            1 => Neighbour::Boundary(BoundaryCondition::Neumann),
            2 => Neighbour::Boundary(BoundaryCondition::Contact),
            3 => Neighbour::Cut,
            _ => Neighbour::Cell { cell: code >> 2, local: (code & 3) as u8 },
        }
    }
    /// Number of cells.
    pub(super) fn n_cells(&self) -> usize {
        self.codes.len() / self.per_cell
    }
    /// The cells that share a facet with a cell.
    pub(super) fn cells_across(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        let codes = &self.codes[cell * self.per_cell..(cell + 1) * self.per_cell];
        codes.iter().filter(|code| **code < BOUNDARY).map(|code| (code >> 2) as usize)
    }
    /// Whether a facet has neither a second cell nor a boundary condition yet.
    pub(super) fn is_unmatched(&self, cell: usize, local: usize) -> bool {
        self.codes[cell * self.per_cell + local] == UNKNOWN
    }
    pub(super) fn set(&mut self, cell: usize, local: usize, condition: BoundaryCondition) {
        self.codes[cell * self.per_cell + local] = BOUNDARY + condition as u32;
    }
}

/// Matches the facets whose lowest vertex is in a range.
///
/// # Errors
/// That of the first facet, in lexicographic order, which belongs to three cells or to two with the same vertices.
fn match_facets_of<const D: usize>(
    incidence: &VertexToCells<'_, D>,
    vertices: &Range<u32>,
    codes: &[AtomicU32],
) -> Result<(), MeshError> {
    let index = |code: u32| (code >> 2) as usize * (D + 1) + (code & 3) as usize;
    // of each vertex the half-facets with it as the lowest one, by their other vertices
    let mut halves: Vec<([u32; 2], u32)> = Vec::new();
    for (lowest, cells) in incidence.stars(vertices).of_vertices(vertices.clone()) {
        halves.clear();
        for (c, first) in cells {
            let cell = incidence.cell(c);
            // the first vertex of a cell is the lowest of all facets but the one opposite it
            for local in if first == 0 { 1..D + 1 } else { 0..1 } {
                let vertex = |k: usize| if k < D { cell[k + usize::from(k >= local)] } else { 0 };
                halves.push(([vertex(1), vertex(2)], half_facet_code(c, local)));
            }
        }
        halves.sort_unstable();
        for same in halves.chunk_by(|a, b| a.0 == b.0) {
            let &[(others, here), (_, there), ..] = same else { continue };
            let cell = |code: u32| incidence.cell((code >> 2) as usize);
            if same.len() > 2 || cell(here) == cell(there) {
                let facet = [lowest, others[0], others[1]];
                let cells = same.iter().map(|(_, code)| (*code >> 2) as usize);
                return Err(mismatch(&facet[..D], &cells.collect::<Vec<_>>(), |c| {
                    incidence.cell(c)
                }));
            }
            codes[index(here)].store(there, Ordering::Relaxed);
            codes[index(there)].store(here, Ordering::Relaxed);
        }
    }
    Ok(())
}

/// The error of a facet that belongs to three cells or to two with the same vertices.
#[cold]
fn mismatch<'c>(
    facet: &[u32],
    cells: &[usize],
    vertices: impl Fn(usize) -> &'c [u32],
) -> MeshError {
    for (k, &second) in cells.iter().enumerate().take(3) {
        let twin = cells[..k].iter().find(|&&first| vertices(first) == vertices(second));
        if let Some(&first) = twin {
            let vertices = vertices(first);
            let message = format!("cells {first} and {second} have the same vertices {vertices:?}");
            let error = MeshError::new(MeshErrorKind::RepeatedCell, message);
            return error.of_cells([first, second]).of_vertices(vertices);
        }
    }
    let cells = &cells[..3];
    let message = format!(
        "facet {facet:?} belongs to cells {cells:?}: a facet lies between two cells at most"
    );
    let error = MeshError::new(MeshErrorKind::FacetOfThreeCells, message);
    error.of_cells(cells).of_vertices(facet)
}

/// All facets, each once, in five ranges: interior, Dirichlet, Neumann, contact, and where the mesh is cut.
///
/// Within a range facets are ordered by their first cell, *here*. Of the two cells of an interior
/// facet the first one has the lower number, and the normal points from it to the second, *there*.
///
/// # Panics
/// A method that takes the number of a facet panics if there is no such facet.
#[derive(Clone, Debug)]
pub struct Facets {
    /// The two half-facets of each facet; twice the same on the boundary.
    half_facets: Vec<[u32; 2]>,
    starts: [usize; 6],
}

impl Facets {
    /// The facets of a mesh.
    pub fn new<const D: usize>(mesh: &Mesh<D>, neighbours: &Neighbours) -> Self {
        let n = (mesh.cells().len() + mesh.boundary().len()) / 2;
        let mut half_facets = in_large_pages(Vec::with_capacity(n));
        for here in 0..mesh.n_cells() {
            for local in 0..=D {
                if let Neighbour::Cell { cell, local: other } = neighbours.across(here, local)
                    && here < cell as usize
                {
                    half_facets.push([
                        half_facet_code(here, local),
                        half_facet_code(cell as usize, other as usize),
                    ]);
                }
            }
        }
        let mut starts = [0, half_facets.len(), 0, 0, 0, 0];
        for (k, condition) in BoundaryCondition::ALL.into_iter().enumerate() {
            let facets = mesh.boundary().iter().filter(|f| f.condition == condition);
            half_facets.extend(facets.map(|f| {
                let code = half_facet_code(f.cell as usize, f.local as usize);
                [code, code]
            }));
            starts[k + 2] = half_facets.len();
        }
        if mesh.is_part() {
            for cell in 0..mesh.n_cells() {
                let is_cut = |local: &usize| neighbours.across(cell, *local) == Neighbour::Cut;
                half_facets
                    .extend((0..D + 1).filter(is_cut).map(|l| [half_facet_code(cell, l); 2]));
            }
        }
        starts[5] = half_facets.len();
        Self { half_facets, starts }
    }
    /// Number of facets.
    pub fn len(&self) -> usize {
        self.half_facets.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.half_facets.is_empty()
    }
    /// Numbers of the interior facets.
    pub fn interior(&self) -> Range<usize> {
        self.starts[0]..self.starts[1]
    }
    /// Numbers of the facets of the boundary on which a condition holds.
    pub fn boundary(&self, condition: BoundaryCondition) -> Range<usize> {
        self.starts[condition as usize + 1]..self.starts[condition as usize + 2]
    }
    /// Numbers of the facets beyond which the cells of another part of the mesh lie.
    pub fn cut(&self) -> Range<usize> {
        self.starts[4]..self.starts[5]
    }
    /// A facet seen from its first cell.
    #[inline(always)]
    pub fn here(&self, facet: usize) -> HalfFacet {
        let code = self.half_facets[facet][0];
        ((code >> 2) as usize, (code & 3) as usize)
    }
    /// An interior facet seen from its second cell; from the first one again on the boundary and where the
    /// mesh is cut.
    #[inline(always)]
    pub fn there(&self, facet: usize) -> HalfFacet {
        let code = self.half_facets[facet][1];
        ((code >> 2) as usize, (code & 3) as usize)
    }
    /// The number of every facet of every cell, `D + 1` for each cell.
    pub fn numbers<const D: usize>(&self, n_cells: usize) -> Vec<u32> {
        let mut numbers = in_large_pages(vec![0; n_cells * (D + 1)]);
        for facet in 0..self.len() {
            for (cell, local) in [self.here(facet), self.there(facet)] {
                numbers[cell * (D + 1) + local] = facet as u32;
            }
        }
        numbers
    }
}
