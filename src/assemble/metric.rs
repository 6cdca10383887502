//! What forms need of the geometry of cells: numbers without direction.

use std::convert::Infallible;

use super::parallel;
use crate::memory::in_large_pages;
use crate::mesh::Mesh;
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
    /// Numbers kept of a cell: volume, facet measures, all products by rows. Those above the diagonal
    /// would do, but whole rows are read as they are, by this cell and by its neighbours.
    const KEPT: usize = 1 + (D + 1) + (D + 1) * (D + 1);

    /// The metric of one cell.
    #[inline(always)]
    pub fn of(mesh: &Mesh<T, D>, cell: usize) -> Self {
        let (volume, products) = shape(mesh, cell, T::lit(1.0));
        let mut measures = [T::lit(0.0); 4];
        for (measure, (i, row)) in measures.iter_mut().zip(products.iter().enumerate()).take(D + 1)
        {
            // |F| = D |K| |grad lambda|; one in one dimension
            *measure = T::lit(D as f64) * nalgebra::ComplexField::sqrt(volume * row[i]);
        }
        if D == 1 {
            measures[..2].fill(T::lit(1.0));
        }
        Self { volume, measures, products }
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
        for (row, out) in self.products.iter().zip(out[D + 2..].chunks_exact_mut(D + 1)) {
            out.copy_from_slice(&row[..=D]);
        }
    }
    #[inline(always)]
    fn read(kept: &[T]) -> Self {
        let zero = T::lit(0.0);
        let mut metric = Self { volume: kept[0], measures: [zero; 4], products: [[zero; 4]; 4] };
        metric.measures[..=D].copy_from_slice(&kept[1..D + 2]);
        for (row, kept) in metric.products.iter_mut().zip(kept[D + 2..].chunks_exact(D + 1)) {
            row[..=D].copy_from_slice(kept);
        }
        metric
    }
}

/// The volume of a cell and `int scale grad lambda_i . grad lambda_j` over it, made without a detour
/// through memory: with `n_k` the gradients times the determinant `d` of the edges the products are
/// `scale n_i . n_j / (D! |d|)`.
#[inline(always)]
pub(crate) fn shape<T: Real, const D: usize>(
    mesh: &Mesh<T, D>,
    cell: usize,
    scale: T,
) -> (T, [[T; 4]; 4]) {
    let zero = T::lit(0.0);
    let corners = mesh.cell(cell);
    let mut edges = [[zero; 3]; 3];
    let origin = &mesh.vertices()[corners[0] as usize];
    for k in 0..D {
        let corner = &mesh.vertices()[corners[k + 1] as usize];
        for axis in 0..D {
            edges[k][axis] = corner[axis] - origin[axis];
        }
    }
    let [a, b, c] = edges;
    let normals = match D {
        1 => [[T::lit(1.0), zero, zero], [zero; 3], [zero; 3]],
        2 => [[b[1], -b[0], zero], [-a[1], a[0], zero], [zero; 3]],
        _ => [cross(b, c), cross(c, a), cross(a, b)],
    };
    let determinant = dot::<T, D>(a, normals[0]);
    let size = if determinant < zero { -determinant } else { determinant };
    let scale = if size == zero { zero } else { scale / (size * T::lit(FACTORIAL[D])) };
    let mut products = [[zero; 4]; 4];
    for i in 1..=D {
        // rows sum to zero
        for j in 1..=D {
            products[i][j] = if i <= j {
                scale * dot::<T, D>(normals[i - 1], normals[j - 1])
            } else {
                products[j][i]
            };
        }
    }
    for i in 1..=D {
        let sum = (1..=D).fold(zero, |sum, j| sum - products[i][j]);
        products[i][0] = sum;
        products[0][i] = sum;
        products[0][0] -= sum;
    }
    (size / T::lit(FACTORIAL[D]), products)
}

const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];

#[inline(always)]
fn dot<T: Real, const D: usize>(a: [T; 3], b: [T; 3]) -> T {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

#[inline(always)]
fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The metrics of all cells, computed once: each is read by the cell and by its neighbours.
pub(crate) struct Metrics<T> {
    kept: Vec<T>,
}

impl<T: Real> Metrics<T> {
    /// The metrics of a mesh, in parallel.
    pub fn of<const D: usize>(mesh: &Mesh<T, D>) -> Self {
        let n = CellMetric::<T, D>::KEPT;
        let mut kept = in_large_pages(vec![T::lit(0.0); n * mesh.n_cells()]);
        let fill = |cells: std::ops::Range<usize>, piece: &mut [T]| {
            for (cell, out) in cells.zip(piece.chunks_exact_mut(n)) {
                CellMetric::of(mesh, cell).write(out);
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
    /// The products of the gradient opposite facet `local` of a cell with all of its gradients.
    #[inline(always)]
    pub fn products_of<const D: usize>(&self, cell: usize, local: usize) -> [T; 4] {
        let n = CellMetric::<T, D>::KEPT;
        let start = cell * n + D + 2 + local * (D + 1);
        let mut row = [T::lit(0.0); 4];
        row[..=D].copy_from_slice(&self.kept[start..=start + D]);
        row
    }
}
