//! Fluxes in the spaces of Raviart and Thomas of degree zero and one, stored as a few numbers for each cell.

use std::ops::Range;

use crate::memory::in_large_pages;
use crate::mesh::Mesh;
use crate::parallel::vectors::for_each_chunk_of_groups;
use crate::real::Point;

/// A flux `q` in the space of Raviart and Thomas of degree zero or one. Numbers `c` describe it in each cell `K`, with
/// the functions `phi_F = (x - a_F) / (D |K|)`, `a_F` the vertex opposite the facet `F`:
///
/// ```text
/// degree zero   q = sum_F c_F phi_F                     c_F    the integral of q.n over F, n outward
/// degree one    q = sum_F sum_j c_Fj lambda_j phi_F     c_Fj   the measure of F times q.n at vertex j of F
///                                                       c_FF   the factor of a flux inside the cell
/// ```
///
/// The number of a facet in a cell is that of the opposite vertex. A facet between two cells has a `c` in each of them.
/// Where `q.n` is single-valued, the two add up to zero.
///
/// # Panics
/// A method that takes the number of a cell panics if there is no such cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Flux<const D: usize> {
    degree: usize,
    /// By cell and facet the number, or one for each vertex of the cell.
    numbers: Vec<f64>,
}

impl<const D: usize> Flux<D> {
    /// The zero flux on `n_cells` cells.
    ///
    /// # Panics
    /// If the degree is not zero or one.
    #[must_use]
    pub fn zero(degree: usize, n_cells: usize) -> Self {
        assert!(degree < 2, "fluxes have degree zero or one, not {degree}");
        let per_cell = (D + 1) * if degree == 0 { 1 } else { D + 1 };
        Self { degree, numbers: in_large_pages(vec![0.0; n_cells * per_cell]) }
    }
    /// The flux of degree zero with these integrals, by cell and facet.
    pub(super) fn of_integrals(integrals: Vec<f64>) -> Self {
        Self { degree: 0, numbers: integrals }
    }

    /// The degree, zero or one.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }
    /// The integral of `q.n` over a facet of a cell.
    #[must_use]
    pub fn through(&self, cell: usize, facet: usize) -> f64 {
        if self.degree == 0 {
            return self.density(cell, facet, facet);
        }
        let of_vertices = (0..D + 1).filter(|&j| j != facet).map(|j| self.density(cell, facet, j));
        of_vertices.sum::<f64>() / D as f64
    }
    /// The measure of a facet times `q.n` at one of its vertices, both by their numbers in the cell.
    #[must_use]
    pub fn density(&self, cell: usize, facet: usize, vertex: usize) -> f64 {
        match self.degree {
            0 => self.numbers[cell * (D + 1) + facet],
            _ => self.of_cell(cell)[Self::place(facet, vertex)],
        }
    }
    /// The factor of the flux inside a cell at a vertex; zero for degree zero.
    #[must_use]
    pub fn inner(&self, cell: usize, vertex: usize) -> f64 {
        if self.degree == 0 { 0.0 } else { self.of_cell(cell)[Self::place(vertex, vertex)] }
    }

    /// The mean of the flux over a cell of the mesh that it belongs to.
    #[must_use]
    pub fn mean_in(&self, mesh: &Mesh<D>, cell: usize) -> Point<D> {
        let (corners, n) = (mesh.corners(cell), (D + 1) as f64);
        let middle = corners[..=D].iter().sum::<Point<D>>() / n;
        // the mean of lambda_j (x - a_F), over that of lambda_j
        let along = |facet: usize, j: usize| (middle * n + corners[j]) / (n + 1.0) - corners[facet];
        let of_facet = |facet: usize| match self.degree {
            0 => (middle - corners[facet]) * self.density(cell, facet, facet),
            _ => (0..=D).map(|j| along(facet, j) * (self.density(cell, facet, j) / n)).sum(),
        };
        (0..=D).map(of_facet).sum::<Point<D>>() / (D as f64 * mesh.geometry(cell).volume)
    }

    /// Adds to the integral of `q.n` over a facet of one cell, the same density everywhere on the facet.
    pub fn add_through(&mut self, cell: usize, facet: usize, change: f64) {
        match self.degree {
            0 => self.numbers[cell * (D + 1) + facet] += change,
            _ => (0..D + 1)
                .filter(|&j| j != facet)
                .for_each(|j| self.add_density(cell, facet, j, change)),
        }
    }
    /// Adds to the densities of a facet of one cell, by vertices of the cell; those of degree zero are equal.
    pub(super) fn add_densities(&mut self, cell: usize, facet: usize, changes: &[f64; 4]) {
        for j in (0..D + 1).filter(|&j| j != facet) {
            match self.degree {
                0 => return self.add_through(cell, facet, changes[j]),
                _ => self.add_density(cell, facet, j, changes[j]),
            }
        }
    }
    /// Adds to the density of a facet of one cell at a vertex.
    ///
    /// # Panics
    /// For degree zero.
    pub fn add_density(&mut self, cell: usize, facet: usize, vertex: usize, change: f64) {
        assert_eq!(self.degree, 1, "a flux of degree zero has one density on a facet");
        self.of_cell_mut(cell)[Self::place(facet, vertex)] += change;
    }
    /// Adds to the factor of the flux inside a cell at a vertex.
    ///
    /// # Panics
    /// For degree zero.
    pub fn add_inner(&mut self, cell: usize, vertex: usize, change: f64) {
        self.add_density(cell, vertex, vertex, change);
    }
    /// Sets the normal component on a facet of one cell to zero.
    pub(super) fn set_zero_on(&mut self, cell: usize, facet: usize) {
        let per_facet = self.per_cell() / (D + 1);
        for vertex in (0..per_facet).filter(|&j| per_facet == 1 || j != facet) {
            self.numbers[(cell * (D + 1) + facet) * per_facet + vertex] = 0.0;
        }
    }

    /// The place of `c_Fj`, degree one, among the numbers of a cell; `c_jj` is the factor inside the cell.
    pub(super) const fn place(facet: usize, vertex: usize) -> usize {
        facet * (D + 1) + vertex
    }
    /// The count of numbers of a cell.
    pub(super) fn per_cell(&self) -> usize {
        (D + 1) * if self.degree == 0 { 1 } else { D + 1 }
    }
    /// The numbers of a cell.
    pub(super) fn of_cell(&self, cell: usize) -> &[f64] {
        let n = self.per_cell();
        &self.numbers[cell * n..][..n]
    }
    /// Replaces the numbers of the cells of an ascending list; `of(k)` has those of the cell at position `k`, at least as
    /// many as a cell has.
    pub(super) fn replace_in<'n>(&mut self, cells: &[u32], of: impl Fn(usize) -> &'n [f64] + Sync) {
        let n = self.per_cell();
        for_each_chunk_of_groups(&mut self.numbers, n, |range, numbers| {
            let first = (range.start / n) as u32;
            let from = cells.partition_point(|&cell| cell < first);
            for (k, &cell) in (from..).zip(&cells[from..]) {
                let Some(numbers) = numbers.chunks_exact_mut(n).nth((cell - first) as usize) else {
                    break;
                };
                numbers.copy_from_slice(&of(k)[..n]);
            }
        });
    }
    pub(super) fn of_cell_mut(&mut self, cell: usize) -> &mut [f64] {
        self.of_cells_mut(cell..cell + 1)
    }
    /// The numbers of these cells.
    pub(super) fn of_cells_mut(&mut self, cells: Range<usize>) -> &mut [f64] {
        let n = self.per_cell();
        &mut self.numbers[cells.start * n..cells.end * n]
    }
}

/// How far a linear function with these values at vertices can be taken from its mean, at most all the way,
/// with the sign of the mean everywhere.
pub(super) fn share_of_one_sign(mean: f64, values: &[f64]) -> f64 {
    let deepest = values.iter().map(|v| mean.signum() * (mean - v)).fold(0.0, f64::max);
    if deepest > mean.abs() { mean.abs() / deepest } else { 1.0 }
}
