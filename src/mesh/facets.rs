//! Facets: which two cells meet where.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::sweep::{Met, Sweep};
use super::{BoundaryPart, Mesh, MeshError};
use crate::memory::in_large_pages;
use crate::real::Real;

/// What lies across a facet of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbour {
    /// Another cell, in which the facet has this number.
    Cell {
        /// The cell across.
        cell: u32,
        /// Number of the facet in it.
        local: u8,
    },
    /// The boundary.
    Boundary(BoundaryPart),
}

/// What lies across every facet of every cell: one word for each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Neighbours {
    codes: Vec<u32>,
    per_cell: usize,
}

/// Codes from here on are boundary parts; below, four times the cell plus the facet's number.
const BOUNDARY: u32 = u32::MAX - 3;
const UNKNOWN: u32 = u32::MAX;
/// Largest number of cells the codes can name.
pub(super) const CELL_LIMIT: usize = (BOUNDARY as usize) / 4;

fn part_code(part: BoundaryPart) -> u32 {
    BOUNDARY + part as u32
}

fn side_code(cell: usize, local: usize) -> u32 {
    (cell * 4 + local) as u32
}

impl Neighbours {
    /// The neighbours in a mesh, in time linear in its cells.
    pub fn of<T: Real, const D: usize>(mesh: &Mesh<T, D>) -> Self {
        // a mesh that exists has passed this matching before
        let mut found = Self::match_facets::<D>(mesh.cells(), mesh.vertices().len())
            .unwrap_or_else(|_| Self { codes: Vec::new(), per_cell: D + 1 });
        for f in mesh.boundary() {
            found.set(f.cell as usize, f.local as usize, f.part);
        }
        found
    }

    /// Matches the facets of cells with ascending vertices; unmatched ones stay unknown.
    pub(super) fn match_facets<const D: usize>(
        cells: &[u32],
        n_vertices: usize,
    ) -> Result<Self, MeshError> {
        // the lowest vertex of a facet is the first or the second of its cell
        let sweep = Sweep::<D>::new(cells, n_vertices, 2);
        let mut codes = in_large_pages(Vec::with_capacity(cells.len()));
        codes.resize_with(cells.len(), || AtomicU32::new(UNKNOWN));
        let matched = |vertices: &Range<u32>| match_from(&sweep, vertices.clone(), &codes);
        if !sweep.ranges().par_iter().all(matched)
            && let Some(error) = mismatch::<D>(cells)
        {
            return Err(error);
        }
        // each code was written by the one thread that has the lowest vertex of its facet
        let codes = codes.into_iter().map(AtomicU32::into_inner).collect();
        Ok(Self { codes, per_cell: D + 1 })
    }

    /// What lies across facet `local` of a cell.
    #[inline(always)]
    pub fn across(&self, cell: usize, local: usize) -> Neighbour {
        let code = self.codes[cell * self.per_cell + local];
        match code.wrapping_sub(BOUNDARY) {
            0 => Neighbour::Boundary(BoundaryPart::Dirichlet),
            1 => Neighbour::Boundary(BoundaryPart::Neumann),
            2 => Neighbour::Boundary(BoundaryPart::Contact),
            _ => Neighbour::Cell { cell: code >> 2, local: (code & 3) as u8 },
        }
    }
    /// Whether nothing is known to lie across.
    pub(super) fn is_open(&self, cell: usize, local: usize) -> bool {
        self.codes[cell * self.per_cell + local] == UNKNOWN
    }
    pub(super) fn set(&mut self, cell: usize, local: usize, part: BoundaryPart) {
        self.codes[cell * self.per_cell + local] = part_code(part);
    }
}

/// A facet met so far from one cell.
struct Half {
    /// Its highest vertex in three dimensions.
    highest: u32,
    /// The facet met before it with the same second vertex.
    before: Option<u32>,
    side: u32,
    matched: bool,
}

/// Matches the facets whose lowest vertex is in a range; false where that does not make a mesh.
fn match_from<const D: usize>(
    sweep: &Sweep<'_, D>,
    vertices: Range<u32>,
    codes: &[AtomicU32],
) -> bool {
    let mut met = Met::new(sweep.n_vertices());
    let mut halves: Vec<Half> = Vec::new();
    for (lowest, cells) in sweep.around(vertices).each() {
        met.next_vertex();
        halves.clear();
        for (c, first) in cells {
            // the first vertex of a cell is the lowest of all facets but the one opposite it
            for local in if first == 0 { 1..D + 1 } else { 0..1 } {
                let cell = sweep.cell(c);
                let vertex = |k: usize| cell[k + usize::from(k >= local)];
                // a point has no second vertex: all of them are met together
                let second = if D > 1 { vertex(1) } else { lowest };
                let highest = if D > 2 { vertex(2) } else { second };
                let side = side_code(c, local);
                let before = met.with(second);
                let mut found = before;
                while let Some(k) = found
                    && halves[k as usize].highest != highest
                {
                    found = halves[k as usize].before;
                }
                let Some(other) = found.map(|k| &mut halves[k as usize]) else {
                    met.push(second);
                    halves.push(Half { highest, before, side, matched: false });
                    continue;
                };
                let opposite = sweep.cell((other.side >> 2) as usize)[(other.side & 3) as usize];
                if std::mem::replace(&mut other.matched, true) || opposite == cell[local] {
                    return false;
                }
                let place = |side: u32| (side >> 2) as usize * (D + 1) + (side & 3) as usize;
                codes[place(side)].store(other.side, Ordering::Relaxed);
                codes[place(other.side)].store(side, Ordering::Relaxed);
            }
        }
    }
    true
}

/// The first facet, in lexicographic order, at which cells do not make a mesh.
fn mismatch<const D: usize>(cells: &[u32]) -> Option<MeshError> {
    let cell = |c: usize| &cells[c * (D + 1)..(c + 1) * (D + 1)];
    let vertices = |(c, local): (usize, usize)| -> [u32; D] {
        std::array::from_fn(|k| cell(c)[k + usize::from(k >= local)])
    };
    let mut sides: Vec<_> = (0..cells.len()).map(|k| (k / (D + 1), k % (D + 1))).collect();
    sides.sort_unstable_by_key(|&side| (vertices(side), side));
    for same in sides.chunk_by(|&a, &b| vertices(a) == vertices(b)) {
        for k in 1..same.len() {
            let second = same[k].0;
            if let Some(&(first, _)) = same[..k].iter().find(|side| cell(side.0) == cell(second)) {
                let vertices = cell(first).to_vec();
                return Some(MeshError::RepeatedCell { first, second, vertices });
            }
            if k == 2 {
                let vertices = vertices(same[0]).to_vec();
                let cells = [same[0].0, same[1].0, second];
                return Some(MeshError::FacetOfThreeCells { vertices, cells });
            }
        }
    }
    None
}

/// All facets, each once, in four ranges: interior, Dirichlet, Neumann, contact.
///
/// Within a range facets are ordered by their first cell (*here*). An interior facet's normal
/// points from here to there, and here has the lower number.
#[derive(Clone, Debug)]
pub struct Facets {
    sides: Vec<[u32; 2]>,
    starts: [usize; 5],
}

impl Facets {
    /// The facets of a mesh.
    pub fn of<T: Real, const D: usize>(mesh: &Mesh<T, D>, neighbours: &Neighbours) -> Self {
        let n = (mesh.cells().len() + mesh.boundary().len()) / 2;
        let mut sides = in_large_pages(Vec::with_capacity(n));
        for here in 0..mesh.n_cells() {
            for local in 0..=D {
                if let Neighbour::Cell { cell, local: other } = neighbours.across(here, local)
                    && here < cell as usize
                {
                    sides.push([side_code(here, local), side_code(cell as usize, other as usize)]);
                }
            }
        }
        let mut starts = [0, sides.len(), 0, 0, 0];
        let parts = [BoundaryPart::Dirichlet, BoundaryPart::Neumann, BoundaryPart::Contact];
        for (k, part) in parts.into_iter().enumerate() {
            let of_part = mesh.boundary().iter().filter(|f| f.part == part);
            sides.extend(of_part.map(|f| {
                let side = side_code(f.cell as usize, f.local as usize);
                [side, side]
            }));
            starts[k + 2] = sides.len();
        }
        Self { sides, starts }
    }
    /// Number of facets.
    pub fn len(&self) -> usize {
        self.sides.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty()
    }
    /// Numbers of the interior facets.
    pub fn interior(&self) -> Range<usize> {
        self.starts[0]..self.starts[1]
    }
    /// Numbers of the facets of a part of the boundary.
    pub fn part(&self, part: BoundaryPart) -> Range<usize> {
        self.starts[part as usize + 1]..self.starts[part as usize + 2]
    }
    /// Cell on the first side and the facet's number in it.
    #[inline(always)]
    pub fn here(&self, facet: usize) -> (usize, usize) {
        let side = self.sides[facet][0];
        ((side >> 2) as usize, (side & 3) as usize)
    }
    /// Cell on the other side of an interior facet and the facet's number in it; the first side
    /// again on the boundary.
    #[inline(always)]
    pub fn there(&self, facet: usize) -> (usize, usize) {
        let side = self.sides[facet][1];
        ((side >> 2) as usize, (side & 3) as usize)
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
