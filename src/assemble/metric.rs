//! What forms need of the geometry of cells: numbers without direction.

use std::convert::Infallible;

use super::parallel;
use crate::mesh::{CellGeometry, Mesh};
use crate::real::Real;

/// Products of gradients of a cell's barycentric coordinates, and its measures: all that enters the
/// matrix, since only scalar products of normals and gradients do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellMetric<T, const D: usize> {
    /// Its volume.
    pub volume: T,
    /// Measures of its facets.
    pub measures: [T; 4],
    /// `int grad lambda_i . grad lambda_j` over the cell.
    pub products: [[T; 4]; 4],
}

impl<T: Real, const D: usize> CellMetric<T, D> {
    /// Numbers kept of a cell: volume, facet measures, products above the diagonal.
    const KEPT: usize = 1 + (D + 1) + D * (D + 1) / 2;

    /// The metric of one cell.
    #[inline(always)]
    pub fn new(geometry: &CellGeometry<T, D>) -> Self {
        let mut metric = Self::zero(geometry.volume);
        for i in 0..=D {
            metric.measures[i] = geometry.facet_measure(i);
            for j in i + 1..=D {
                let product = geometry.volume * geometry.gradient(i).dot(geometry.gradient(j));
                metric.set(i, j, product);
            }
        }
        metric
    }
    #[inline(always)]
    fn zero(volume: T) -> Self {
        Self { volume, measures: [T::lit(0.0); 4], products: [[T::lit(0.0); 4]; 4] }
    }
    /// Sets an entry above the diagonal, with what follows for the others: rows sum to zero.
    #[inline(always)]
    fn set(&mut self, i: usize, j: usize, product: T) {
        self.products[i][j] = product;
        self.products[j][i] = product;
        self.products[i][i] -= product;
        self.products[j][j] -= product;
    }
    /// The measure of the whole boundary.
    #[inline(always)]
    pub fn surface(&self) -> T {
        (0..=D).fold(T::lit(0.0), |s, i| s + self.measures[i])
    }
    #[inline(always)]
    fn write(&self, out: &mut [T]) {
        out[0] = self.volume;
        out[1..D + 2].copy_from_slice(&self.measures[..=D]);
        let mut k = D + 2;
        for i in 0..D {
            for j in i + 1..=D {
                out[k] = self.products[i][j];
                k += 1;
            }
        }
    }
    #[inline(always)]
    fn read(kept: &[T]) -> Self {
        let mut metric = Self::zero(kept[0]);
        metric.measures[..=D].copy_from_slice(&kept[1..D + 2]);
        let mut k = D + 2;
        for i in 0..D {
            for j in i + 1..=D {
                metric.set(i, j, kept[k]);
                k += 1;
            }
        }
        metric
    }
}

/// The metrics of all cells, computed once: each is read by the cell and by its neighbours.
pub(crate) struct Metrics<T> {
    kept: Vec<T>,
}

impl<T: Real> Metrics<T> {
    /// The metrics of a mesh, in parallel.
    pub fn of<const D: usize>(mesh: &Mesh<T, D>) -> Self {
        let n = CellMetric::<T, D>::KEPT;
        let mut kept = vec![T::lit(0.0); n * mesh.n_cells()];
        let fill = |cells: std::ops::Range<usize>, piece: &mut [T]| {
            for (cell, out) in cells.zip(piece.chunks_exact_mut(n)) {
                CellMetric::new(&mesh.geometry(cell)).write(out);
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = parallel::for_each(mesh.n_cells(), &|c| c * n, &mut kept, &fill);
        Self { kept }
    }
    /// The metric of a cell.
    #[inline(always)]
    pub fn at<const D: usize>(&self, cell: usize) -> CellMetric<T, D> {
        let n = CellMetric::<T, D>::KEPT;
        CellMetric::read(&self.kept[cell * n..(cell + 1) * n])
    }
}
