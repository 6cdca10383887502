//! Patches in space whose cells fill a ball or a half ball: all fluxes follow from one number for each edge.
//!
//! The link of a vertex has a vertex for each edge, an edge for each facet and a triangle for each cell at it. Where it
//! is a sphere or a disc, fluxes without divergence through the facets at the vertex are differences of one number for
//! each edge. In a cell with the edges 0, 1, 2 at the vertex, ending at `x_0, x_1, x_2` in a sense of rotation that is
//! the same for all cells, the flux through the facet opposite `x_k` is `psi_(k+1) - psi_(k+2)`. On facets of one cell
//! with a given flux both numbers are equal.
//!
//! Let `c_k` be some fluxes that balance the cells and cancel the jumps. The field of `psi_a` in a cell of volume `V`
//! is the constant `-e_a / (3 V)`, `e_a = x_(a+2) - x_(a+1)`, that of the `c_k` has the value
//! `sum_k c_k (m - x_k) / (3 V)` at the barycentre `m`. Hence the numbers for which the norm is least solve
//!
//! ```text
//! sum_K sum_b e_a . e_b / (9 alpha V) psi_b = sum_K e_a . sum_k c_k (m - x_k) / (9 alpha V)
//! ```

use super::corners::Corner;
use super::linear::LinearCells;
use super::patch::solve;
use crate::arrays::{array_of, map_entries};
use crate::mesh::{BoundaryCondition, Neighbour, dot, with_zeros};

/// The most edges at a vertex whose patch is solved this way.
const MOST_EDGES: usize = 64;

/// No side is known.
const NONE: u16 = u16::MAX;

/// What is behind a facet at the vertex.
#[derive(Clone, Copy)]
enum Behind {
    /// Side `1` of cell `0` of the patch.
    Side(u16, u8),
    /// A boundary through which the flux is free.
    Dirichlet,
    /// A boundary through which the flux is given.
    Given,
}

/// A cell of a patch. Its side `k` is the facet opposite the end of its edge `k`.
struct CellOfLink {
    corner: Corner,
    /// The ends of the edges by their numbers in the cell.
    ends: [u8; 3],
    /// The numbers of the edges in the patch.
    edges: [u8; 3],
    /// What is behind each side. Behind the first one of all cells but the first is the cell by which the cell was
    /// found.
    behind: [Option<Behind>; 3],
    /// The fluxes out of the cell through the sides.
    fluxes: [f64; 3],
}

/// The arrays of one patch.
pub(super) struct Link {
    cells: Vec<CellOfLink>,
    /// The ends of the edges.
    ends: Vec<u32>,
    /// The ends in space, from the vertex.
    points: Vec<[f64; 3]>,
    /// The side between edges `a` and `b`, where `b` follows `a` in the sense of rotation of a cell: four times the
    /// number of that cell plus the number of the side in the cell. [`NONE`] where there is none.
    sides: Box<[[u16; MOST_EDGES]; MOST_EDGES]>,
    /// For each edge the first one with an equal number `psi`.
    equal: Vec<u8>,
    matrix: Vec<f64>,
    psi: Vec<f64>,
}

impl Default for Link {
    fn default() -> Self {
        Self {
            cells: Vec::new(),
            ends: Vec::new(),
            points: Vec::new(),
            sides: Box::new([[NONE; MOST_EDGES]; MOST_EDGES]),
            equal: Vec::new(),
            matrix: Vec::new(),
            psi: Vec::new(),
        }
    }
}

impl Link {
    /// The number of the edge with this end, a new one if need be; none beyond [`MOST_EDGES`].
    fn edge_to(&mut self, end: u32) -> Option<u8> {
        // without an early end the loop has no branches
        let mut found = self.ends.len();
        for (k, other) in self.ends.iter().enumerate() {
            found = if *other == end { k } else { found };
        }
        if found == self.ends.len() {
            if found == MOST_EDGES {
                return None;
            }
            self.ends.push(end);
            self.sides[found][..=found].fill(NONE);
            self.sides[..found].iter_mut().for_each(|row| row[found] = NONE);
        }
        Some(found as u8)
    }

    /// Adds a cell and its sides.
    fn push(&mut self, corner: Corner, ends: [u8; 3], edges: [u8; 3]) {
        for k in 0..3 {
            let [a, b] = pair(&edges, k);
            self.sides[a][b] = (4 * self.cells.len() + k) as u16;
        }
        self.cells.push(CellOfLink { corner, ends, edges, behind: [None; 3], fluxes: [0.0; 3] });
    }

    /// The flux that both cells of a side have together.
    fn join(&mut self, (cell, k): (usize, usize), (other, l): (usize, usize)) {
        self.cells[cell].behind[k] = Some(Behind::Side(other as u16, l as u8));
        self.cells[other].behind[l] = Some(Behind::Side(cell as u16, k as u8));
    }

    /// Whether the link is a sphere, or a disc with boundary facets, by Euler's formula.
    fn is_simple(&self) -> bool {
        let is_boundary = |of: &Option<Behind>| !matches!(of, Some(Behind::Side(..)));
        let sides = self.cells.iter().flat_map(|cell| &cell.behind);
        let n_boundary = sides.filter(|of| is_boundary(of)).count();
        let n_facets = (3 * self.cells.len() + n_boundary) / 2;
        self.ends.len() + self.cells.len() == n_facets + if n_boundary == 0 { 2 } else { 1 }
    }

    /// Edges on both sides of facets with a given flux have equal numbers.
    fn find_equal(&mut self) {
        self.equal.clear();
        self.equal.extend(0..self.ends.len() as u8);
        for cell in &self.cells {
            for k in (0..3).filter(|&k| matches!(cell.behind[k], Some(Behind::Given))) {
                let [a, b] = map_entries(pair(&cell.edges, k), |edge| self.equal[edge]);
                let (first, other) = (a.min(b), a.max(b));
                self.equal.iter_mut().filter(|e| **e == other).for_each(|e| *e = first);
            }
        }
    }
}

/// The two edges beside side `k` of a cell, in the sense of rotation.
fn pair(edges: &[u8; 3], k: usize) -> [usize; 2] {
    [edges[(k + 1) % 3].into(), edges[(k + 2) % 3].into()]
}

impl<const D: usize> LinearCells<'_, '_, D> {
    /// Calls `set` with the numbers of a vertex in space if its link is a sphere or a disc, else false.
    pub(super) fn set_link(
        &self,
        vertex: usize,
        link: &mut Link,
        set: impl Fn(Corner, usize, f64),
    ) -> bool {
        if self.find_link(vertex, link).is_none() || !link.is_simple() {
            return false;
        }
        self.balance(vertex, link);
        link.find_equal();
        self.least_squares(vertex, link);
        for cell in &link.cells {
            let own = cell.corner.own();
            for (k, &end) in cell.ends.iter().enumerate() {
                let psi = |edge: usize| link.psi[usize::from(link.equal[edge])];
                let [a, b] = map_entries(pair(&cell.edges, k), psi);
                let place = usize::from(end) - usize::from(usize::from(end) > own);
                set(cell.corner, place, cell.fluxes[k] + (a - b));
            }
        }
        true
    }

    /// The cells around a vertex, each but the first beside one before it; none if these are not all.
    fn find_link(&self, vertex: usize, link: &mut Link) -> Option<()> {
        let mesh = self.space.mesh;
        let (cell, count) = self.one_cell[vertex];
        link.cells.clear();
        link.ends.clear();
        let own = self.number_in(cell as usize, vertex as u32);
        let corner = Corner::new(cell as usize, own.into());
        let (mut ends, mut edges) = ([0; 3], [0; 3]);
        for ((end, edge), other) in ends.iter_mut().zip(&mut edges).zip(corner.facets::<D>()) {
            *end = other as u8;
            *edge = link.edge_to(mesh.cell(cell as usize)[other])?;
        }
        link.push(corner, ends, edges);
        let mut next = 0;
        while next < link.cells.len() {
            for k in 0..3 {
                let CellOfLink { corner, ends, edges, behind, .. } = &link.cells[next];
                let [a, b] = pair(edges, k);
                match self.neighbours.across(corner.cell(), ends[k].into()) {
                    _ if behind[k].is_some() => {}
                    Neighbour::Cell { cell, local } => {
                        let mut found = link.sides[b][a];
                        if found == NONE {
                            if link.cells.len() == count as usize {
                                return None;
                            }
                            let cell = cell as usize;
                            let ends =
                                map_entries([a, b], |edge| self.number_in(cell, link.ends[edge]));
                            let edge = link.edge_to(mesh.cell(cell)[usize::from(local)])?;
                            // the numbers of the four vertices sum to six
                            let own = 6 - local - ends[0] - ends[1];
                            found = 4 * link.cells.len() as u16;
                            link.push(
                                Corner::new(cell, own.into()),
                                [local, ends[1], ends[0]],
                                [edge, b as u8, a as u8],
                            );
                        }
                        link.join((next, k), (usize::from(found) / 4, usize::from(found) % 4));
                    }
                    Neighbour::Boundary(BoundaryCondition::Dirichlet) => {
                        link.cells[next].behind[k] = Some(Behind::Dirichlet);
                    }
                    Neighbour::Boundary(_) | Neighbour::Cut => {
                        link.cells[next].behind[k] = Some(Behind::Given);
                    }
                }
            }
            next += 1;
        }
        (link.cells.len() == count as usize).then_some(())
    }

    /// Sets fluxes that balance each cell, and on facets the jump: half of it where the two cells of a facet are not
    /// found by each other. Without a free facet what the equation of the vertex leaves, rounding, is divided like the
    /// multiplier.
    fn balance(&self, vertex: usize, link: &mut Link) {
        let d = D as f64;
        let normal =
            |of: &CellOfLink, k: usize| self.through(of.corner.cell(), of.ends[k].into()) / d;
        let cells = &mut link.cells;
        let carried: f64 = cells.iter().map(|of| self.carried(of.corner)).sum();
        let mut pressure = self.multipliers[vertex] / carried;
        let mut left: f64 = cells.iter().map(|of| self.load(of.corner, pressure)).sum();
        let mut free = None;
        for c in 0..cells.len() {
            for k in 0..3 {
                let own = -normal(&cells[c], k);
                left -= own;
                cells[c].fluxes[k] = match cells[c].behind[k] {
                    Some(Behind::Side(other, l)) => {
                        0.5 * (own - normal(&cells[usize::from(other)], l.into()))
                    }
                    Some(Behind::Dirichlet) => {
                        free = Some((c, k));
                        own
                    }
                    _ => own,
                };
            }
        }
        if free.is_none() {
            pressure += left / carried;
        }
        for c in (0..cells.len()).rev() {
            let [_, one, other] = cells[c].fluxes;
            let through = self.load(cells[c].corner, pressure) - one - other;
            match cells[c].behind[0] {
                // half of the jump stands there already
                Some(Behind::Side(before, l)) if c > 0 => {
                    let change = through - cells[c].fluxes[0];
                    cells[usize::from(before)].fluxes[usize::from(l)] -= change;
                    cells[c].fluxes[0] = through;
                }
                _ => left = through - cells[c].fluxes[0],
            }
        }
        // what is left of the first cell leaves through the free facet
        let mut at = free;
        while let Some((c, k)) = at {
            cells[c].fluxes[k] += left;
            at = match cells[c].behind[0] {
                Some(Behind::Side(before, l)) if c > 0 => {
                    cells[c].fluxes[0] -= left;
                    Some((before.into(), l.into()))
                }
                _ => None,
            };
        }
    }

    /// Finds the numbers of edges for which the norm is least.
    fn least_squares(&self, vertex: usize, link: &mut Link) {
        let Link { cells, ends, points, equal, matrix, psi, .. } = link;
        let vertices = self.space.mesh.vertices();
        let from = &vertices[vertex];
        points.clear();
        points.extend(ends.iter().map(|&end| with_zeros(vertices[end as usize] - from)));
        let n = ends.len();
        matrix.clear();
        matrix.resize(n * n, 0.0);
        psi.clear();
        psi.resize(n, 0.0);
        for CellOfLink { corner, edges, fluxes, .. } in cells.iter() {
            let cell = corner.cell();
            let x = map_entries(*edges, |edge| points[usize::from(edge)]);
            let weight = 1.0 / (9.0 * self.space.alpha(cell) * self.volume(cell));
            let along: [[f64; 3]; 3] =
                array_of(|k| array_of(|axis| x[(k + 2) % 3][axis] - x[(k + 1) % 3][axis]));
            let sum = fluxes[0] + fluxes[1] + fluxes[2];
            let field: [f64; 3] = array_of(|axis| {
                let [a, b, c] = map_entries(x, |x| x[axis]);
                let through = fluxes[0] * a + fluxes[1] * b + fluxes[2] * c;
                weight * (sum * 0.25 * (a + b + c) - through)
            });
            let numbers = map_entries(*edges, |edge| usize::from(equal[usize::from(edge)]));
            for k in 0..3 {
                let (a, b) = (numbers[k], numbers[(k + 1) % 3]);
                psi[a] += dot::<3>(along[k], field);
                matrix[a * n + a] += weight * dot::<3>(along[k], along[k]);
                let product = weight * dot::<3>(along[k], along[(k + 1) % 3]);
                matrix[a.min(b) * n + a.max(b)] += if a == b { 2.0 * product } else { product };
            }
        }
        solve(matrix, psi);
    }
}
