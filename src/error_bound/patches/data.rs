//! What the patches of a conforming linear function read, and where they write.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::error_bound::NoBound;
use crate::error_bound::contact::NodeForce;
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryPart, Neighbours};
use crate::parallel::cells;
use crate::real::Real;

/// A cell, with the number of a vertex in it.
#[derive(Clone, Copy)]
pub(in crate::error_bound) struct Corner(u32);

impl Corner {
    fn new(cell: usize, own: usize) -> Self {
        Self((cell * 4 + own) as u32)
    }

    pub fn cell(self) -> u32 {
        self.0 / 4
    }

    /// The cell, and the number of the vertex in it.
    pub fn pair(self) -> (u32, u8) {
        (self.cell(), self.own())
    }

    /// The number of the vertex in the cell.
    pub fn own(self) -> u8 {
        (self.0 % 4) as u8
    }
}

/// The corners of all vertices, and where those of each vertex start.
pub(super) type Corners = (Vec<Corner>, Vec<u32>);

/// Number of cells whose parts are kept at a time. The parts of a tetrahedron are twelve numbers, the flux is four.
pub(super) const CELLS_AT_A_TIME: usize = 1 << 17;

/// What the patches read.
pub(super) struct Patches<'s, 'a, T: Real, const D: usize> {
    pub space: &'s Space<'a, T, D>,
    pub neighbours: &'s Neighbours,
    /// By cell its volume, the integrals of `alpha grad u . n` over its facets, and for each of its vertices the load
    /// that the flux of the vertex balances, without multipliers of obstacles.
    cells: Vec<f64>,
    /// The multiplier of each vertex that belongs to obstacles.
    pub multipliers: Vec<f64>,
    /// In which cells these act.
    obstacles: &'s ActiveObstacles,
    /// Of each vertex one of its cells, and how many there are.
    pub one_cell: Vec<(u32, u32)>,
    /// The cells whose parts are kept.
    kept: Range<usize>,
    /// By kept cell and vertex the fluxes through the facets there, as bits: each is written once, by the task of
    /// the vertex.
    parts: Vec<AtomicU64>,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// What the patches read, without their parts.
    pub(super) fn patches<'s>(
        &'s self,
        u: &[T],
        (residual, obstacles): (&[f64], &'s ActiveObstacles),
        forces: &[NodeForce],
        neighbours: &'s Neighbours,
    ) -> Result<Patches<'s, 's, T, D>, NoBound> {
        let load = self.load_by_cell()?;
        let n_cells = self.mesh.n_cells();
        let stride = numbers_of_cell(D);
        let mut data = in_large_pages(vec![0.0; n_cells * stride]);
        let fill = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, data) in cells.zip(out.chunks_exact_mut(stride)) {
                let metric = self.metric(cell);
                let values = self.local_values(cell, u);
                let alpha = self.alpha(cell).to_f64();
                let residual = self.cell_residual(cell, &metric, u, &load);
                data[0] = metric.volume.to_f64();
                for i in 0..=D {
                    let product =
                        |j: usize| metric.products[i][j].to_f64() * (values[j] - values[0]);
                    let stiffness = alpha * (1..=D).map(product).sum::<f64>();
                    // |F| n = -D |K| grad lambda
                    data[1 + i] = -(D as f64) * stiffness;
                    data[D + 2 + i] = residual[i] - stiffness;
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * stride, &mut data, &fill);
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            self.mesh.facet_vertices(cell, local).for_each(|v| multipliers[v as usize] = 0.0);
        }
        for force in forces {
            data[force.cell * stride + D + 2 + force.node] -= force.value;
        }
        let mut one_cell = vec![(0, 0); self.mesh.vertices().len()];
        for (k, &v) in self.mesh.cells().iter().enumerate() {
            let (cell, count) = &mut one_cell[v as usize];
            *cell = (k / (D + 1)) as u32;
            *count += 1;
        }
        Ok(Patches {
            space: self,
            neighbours,
            cells: data,
            multipliers,
            obstacles,
            one_cell,
            kept: 0..0,
            parts: Vec::new(),
        })
    }

    /// The cells around each vertex with its number there, and where those of each vertex start.
    pub(in crate::error_bound) fn corners(&self) -> Corners {
        let n_vertices = self.mesh.vertices().len();
        let mut starts = vec![0_u32; n_vertices + 1];
        self.mesh.cells().iter().for_each(|&v| starts[v as usize + 1] += 1);
        (0..n_vertices).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut corners = in_large_pages(vec![Corner(0); self.mesh.cells().len()]);
        for (k, &v) in self.mesh.cells().iter().enumerate() {
            let at = &mut next[v as usize];
            corners[*at as usize] = Corner::new(k / (D + 1), k % (D + 1));
            *at += 1;
        }
        (corners, starts)
    }

    /// Ranges of `length` cells that have their parts kept at a time, each with the vertices of its cells. All cells are
    /// one range if the ranges would have more than twice as many vertices as the mesh: the numbers of neighbours are far
    /// apart then.
    pub(super) fn ranges_with_vertices(&self, length: usize) -> Vec<(Range<usize>, Vec<u32>)> {
        let (n_cells, n_vertices) = (self.mesh.n_cells(), self.mesh.vertices().len());
        let mut last_range = vec![u32::MAX; n_vertices];
        let mut ranges = Vec::new();
        let mut n_visits = 0;
        for (number, first) in (0..n_cells).step_by(length).enumerate() {
            let cells = first..(first + length).min(n_cells);
            let mut vertices = Vec::new();
            for &v in &self.mesh.cells()[cells.start * (D + 1)..cells.end * (D + 1)] {
                if last_range[v as usize] != number as u32 {
                    last_range[v as usize] = number as u32;
                    vertices.push(v);
                }
            }
            n_visits += vertices.len();
            if n_visits > 2 * n_vertices {
                return vec![(0..n_cells, (0..n_vertices as u32).collect())];
            }
            ranges.push((cells, vertices));
        }
        ranges
    }
}

impl<T: Real, const D: usize> Patches<'_, '_, T, D> {
    pub fn volume(&self, cell: usize) -> f64 {
        self.cells[cell * numbers_of_cell(D)]
    }

    pub fn normals(&self, cell: usize) -> &[f64] {
        &self.cells[cell * numbers_of_cell(D) + 1..][..D + 1]
    }

    /// What the flux of a vertex of a cell balances there, with a multiplier per volume.
    pub fn load(&self, cell: usize, own: u8, pressure: f64) -> f64 {
        let load = self.cells[cell * numbers_of_cell(D) + D + 2 + usize::from(own)];
        load - pressure * self.carried(cell, own)
    }

    /// The volume over which a cell carries a part of the multiplier of one of its vertices: its own, or none where
    /// another obstacle than that of the cell gives the active bound.
    pub fn carried(&self, cell: usize, own: u8) -> f64 {
        if self.obstacles.act_in(cell, own.into()) { self.volume(cell) } else { 0.0 }
    }

    /// Keeps the parts of these cells from now on. Every part of a kept cell is written before it is read.
    pub fn keep(&mut self, cells: Range<usize>) {
        self.parts.resize_with(cells.len() * (D + 1) * D, AtomicU64::default);
        self.kept = cells;
    }

    /// Writes the flux of a vertex of a cell through its facet `k` there, if the parts of the cell are kept.
    pub fn set(&self, (cell, own): (usize, u8), k: usize, flux: f64) {
        if self.kept.contains(&cell) {
            self.part((cell, own), k).store(flux.to_bits(), Ordering::Relaxed);
        }
    }

    /// The flux of a vertex of a kept cell through its facet `k` there.
    pub fn get(&self, corner: (usize, u8), k: usize) -> f64 {
        f64::from_bits(self.part(corner, k).load(Ordering::Relaxed))
    }

    fn part(&self, (cell, own): (usize, u8), k: usize) -> &AtomicU64 {
        &self.parts[((cell - self.kept.start) * (D + 1) + usize::from(own)) * D + k]
    }
}

/// How many numbers are known of a cell before its patches are.
const fn numbers_of_cell(dimension: usize) -> usize {
    2 * dimension + 3
}

/// The facets of a cell at one of its vertices.
pub(in crate::error_bound) fn around<const D: usize>(vertex: u8) -> impl Iterator<Item = usize> {
    (0..D + 1).filter(move |&local| local != usize::from(vertex))
}
