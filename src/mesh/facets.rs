//! Facets: which two cells meet where.

use super::{BoundaryPart, Mesh, MeshError};
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
        let per_cell = D + 1;
        let mut codes = vec![UNKNOWN; cells.len()];
        // half-facets in buckets by their lowest vertex: a counting sort, then tiny sorts
        let lowest = |cell: &[u32], local: usize| cell[usize::from(local == 0)] as usize;
        let mut starts = vec![0_u32; n_vertices + 1];
        for cell in cells.chunks_exact(per_cell) {
            for local in 0..per_cell {
                starts[lowest(cell, local) + 1] += 1;
            }
        }
        for v in 0..n_vertices {
            starts[v + 1] += starts[v];
        }
        let mut fill = starts.clone();
        let mut sides = vec![(0_u64, 0_u32); cells.len()];
        for (c, cell) in cells.chunks_exact(per_cell).enumerate() {
            for local in 0..per_cell {
                let at = &mut fill[lowest(cell, local)];
                sides[*at as usize] = (upper_key::<D>(cell, local), side_code(c, local));
                *at += 1;
            }
        }
        for v in 0..n_vertices {
            let bucket = &mut sides[starts[v] as usize..starts[v + 1] as usize];
            bucket.sort_unstable();
            let mut k = 0;
            while k < bucket.len() {
                let same = bucket[k..].iter().take_while(|s| s.0 == bucket[k].0).count();
                if same > 1 {
                    pair_up::<D>(cells, &bucket[k..k + same], &mut codes)?;
                }
                k += same;
            }
        }
        Ok(Self { codes, per_cell })
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

/// The vertices of a facet above its lowest one, packed to compare at once.
#[inline(always)]
fn upper_key<const D: usize>(cell: &[u32], local: usize) -> u64 {
    let mut key = 0;
    let mut seen = 0;
    for (i, &v) in cell.iter().enumerate() {
        if i != local {
            if seen > 0 {
                key = key << 32 | u64::from(v);
            }
            seen += 1;
        }
    }
    debug_assert_eq!(seen, D);
    key
}

fn pair_up<const D: usize>(
    cells: &[u32],
    same: &[(u64, u32)],
    codes: &mut [u32],
) -> Result<(), MeshError> {
    let side = |k: usize| ((same[k].1 >> 2) as usize, (same[k].1 & 3) as usize);
    let cell = |c: usize| &cells[c * (D + 1)..(c + 1) * (D + 1)];
    for k in 1..same.len() {
        for j in 0..k {
            let ((first, i), (second, _)) = (side(j), side(k));
            if cell(first) == cell(second) {
                let vertices = cell(first).to_vec();
                return Err(MeshError::RepeatedCell { first, second, vertices });
            }
            if k == 2 {
                let vertices = (0..=D).filter(|&v| v != i).map(|v| cell(first)[v]).collect();
                let cells = [side(0).0, side(1).0, side(2).0];
                return Err(MeshError::FacetOfThreeCells { vertices, cells });
            }
        }
    }
    let ((here, i), (there, j)) = (side(0), side(1));
    codes[here * (D + 1) + i] = side_code(there, j);
    codes[there * (D + 1) + j] = side_code(here, i);
    Ok(())
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
        let mut sides = Vec::with_capacity((mesh.cells().len() + mesh.boundary().len()) / 2);
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
    pub fn interior(&self) -> std::ops::Range<usize> {
        self.starts[0]..self.starts[1]
    }
    /// Numbers of the facets of a part of the boundary.
    pub fn part(&self, part: BoundaryPart) -> std::ops::Range<usize> {
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
        let mut numbers = vec![0; n_cells * (D + 1)];
        for facet in 0..self.len() {
            for (cell, local) in [self.here(facet), self.there(facet)] {
                numbers[cell * (D + 1) + local] = facet as u32;
            }
        }
        numbers
    }
}
