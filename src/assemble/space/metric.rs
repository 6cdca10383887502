//! The geometry of cells that forms need: numbers without direction.

use std::convert::Infallible;

use super::tables::Derivatives;
use crate::element::MAX_BASIS;
use crate::memory::in_large_pages;
use crate::mesh::{FACTORIAL, HalfFacet, Mesh, cofactors, cross, dot, with_zeros};
use crate::parallel::cells;

/// Products of gradients of a cell's barycentric coordinates, and its measures: all that enters the
/// matrix, since only scalar products of normals and gradients do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellMetric<const D: usize> {
    pub volume: f64,
    /// Measures of its facets.
    pub measures: [f64; 4],
    /// `int grad lambda_i . grad lambda_j` over the cell.
    pub products: [[f64; 4]; 4],
}

impl<const D: usize> CellMetric<D> {
    /// Numbers kept of a cell: volume, facet measures, products above the diagonal.
    const KEPT: usize = 1 + (D + 1) + D * (D + 1) / 2;

    #[inline(always)]
    pub fn of(mesh: &Mesh<D>, cell: usize) -> Self {
        let (volume, products) = shape(mesh, cell, 1.0);
        let mut measures = [0.0; 4];
        for i in 1..=D {
            // |F| = D |K| |grad lambda|
            measures[i] = (D as f64) * (volume * products[i][i]).sqrt();
        }
        // the first product is a sum of the others, in which thin cells lose all digits
        measures[0] = first_facet(mesh, cell);
        if D == 1 {
            measures[1] = 1.0;
        }
        Self { volume, measures, products }
    }
    /// Sets an entry above the diagonal, with what follows for the others: rows sum to zero.
    #[inline(always)]
    fn set(&mut self, i: usize, j: usize, product: f64) {
        self.products[i][j] = product;
        self.products[j][i] = product;
        self.products[i][i] -= product;
        self.products[j][j] -= product;
    }
    /// The derivatives of the first `n` basis functions along the outward normal of facet `local`, of one moment and
    /// times the measure of the facet and a factor; the other entries are zero and never read.
    #[inline(always)]
    pub fn normal_derivatives(
        &self,
        local: usize,
        derivatives: &Derivatives,
        n: usize,
        factor: f64,
    ) -> [f64; MAX_BASIS] {
        let products = &self.products[local];
        let scale = (-(D as f64)) * factor;
        let mut out = [0.0; MAX_BASIS];
        for (out, derivatives) in out.iter_mut().zip(derivatives).take(n) {
            let sum = |sum, k: usize| sum + derivatives[k] * products[k];
            *out = scale * (1..=D).fold(derivatives[0] * products[0], sum);
        }
        out
    }
    #[inline(always)]
    fn write(&self, out: &mut [f64]) {
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
    fn read(kept: &[f64]) -> Self {
        let mut metric = Self { volume: kept[0], measures: [0.0; 4], products: [[0.0; 4]; 4] };
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

/// The volume of a cell and `int scale grad lambda_i . grad lambda_j` over it, made without a detour
/// through memory: with `n_k` the gradients times the determinant `d` of the edges the products are
/// `scale n_i . n_j / (D! |d|)`.
#[inline(always)]
pub(crate) fn shape<const D: usize>(
    mesh: &Mesh<D>,
    cell: usize,
    scale: f64,
) -> (f64, [[f64; 4]; 4]) {
    shape_of::<D>(edges_of(mesh, cell), scale)
}

/// The edges of a cell from its first corner to the others.
#[inline(always)]
pub(super) fn edges_of<const D: usize>(mesh: &Mesh<D>, cell: usize) -> [[f64; 3]; 3] {
    let corners = mesh.cell(cell);
    // loops over numbers: differences of points in place of these take half as long again
    let mut edges = [[0.0; 3]; 3];
    let origin = &mesh.vertices()[corners[0] as usize];
    for k in 0..D {
        let corner = &mesh.vertices()[corners[k + 1] as usize];
        for axis in 0..D {
            edges[k][axis] = corner[axis] - origin[axis];
        }
    }
    edges
}

/// As [`shape`], of a cell with these edges.
#[inline(always)]
pub(super) fn shape_of<const D: usize>(edges: [[f64; 3]; 3], scale: f64) -> (f64, [[f64; 4]; 4]) {
    let (normals, determinant) = cofactors::<D>(edges);
    let size = if determinant < 0.0 { -determinant } else { determinant };
    let scale = if size == 0.0 { 0.0 } else { scale / (size * FACTORIAL[D]) };
    let mut products = [[0.0; 4]; 4];
    for i in 1..=D {
        // rows sum to zero
        for j in 1..=D {
            products[i][j] = if i <= j {
                scale * dot::<D>(normals[i - 1], normals[j - 1])
            } else {
                products[j][i]
            };
        }
    }
    for i in 1..=D {
        let sum = (1..=D).fold(0.0, |sum, j| sum - products[i][j]);
        products[i][0] = sum;
        products[0][i] = sum;
        products[0][0] -= sum;
    }
    (size / FACTORIAL[D], products)
}

/// For each number zeros at its own place and ones at the others.
const OTHERS: [[f64; 4]; 4] =
    [[0.0, 1.0, 1.0, 1.0], [1.0, 0.0, 1.0, 1.0], [1.0, 1.0, 0.0, 1.0], [1.0, 1.0, 1.0, 0.0]];

/// The place of a pair of gradients among those above the diagonal, by rows, in each dimension; zero
/// on the diagonal.
const PAIR: [[[usize; 4]; 4]; 4] = {
    let mut pairs = [[[0; 4]; 4]; 4];
    let mut dimension = 1;
    while dimension <= 3 {
        let (mut i, mut k) = (0, 0);
        while i < dimension {
            let mut j = i + 1;
            while j <= dimension {
                pairs[dimension][i][j] = k;
                pairs[dimension][j][i] = k;
                k += 1;
                j += 1;
            }
            i += 1;
        }
        dimension += 1;
    }
    pairs
};

/// The measure of the facet opposite the first vertex of a cell.
#[inline(always)]
fn first_facet<const D: usize>(mesh: &Mesh<D>, cell: usize) -> f64 {
    let corners = mesh.cell(cell);
    let corner = |k: usize| mesh.vertices()[corners[k.min(D)] as usize];
    let edge = |k: usize| with_zeros(corner(k) - corner(1));
    let length = |a: [f64; 3]| dot::<3>(a, a).sqrt();
    match D {
        1 => 1.0,
        2 => length(edge(2)),
        _ => 0.5 * length(cross(edge(2), edge(3))),
    }
}

/// The metrics of all cells, computed once: each is read by the cell and by its neighbours.
pub(crate) struct Metrics {
    kept: Vec<f64>,
}

impl Metrics {
    /// The metrics of so many cells, in parallel.
    pub fn of<const D: usize>(
        n_cells: usize,
        of_cell: impl Fn(usize) -> CellMetric<D> + Sync,
    ) -> Self {
        let n = CellMetric::<D>::KEPT;
        let mut kept = in_large_pages(vec![0.0; n * n_cells]);
        let fill = |cells: std::ops::Range<usize>, chunk: &mut [f64]| {
            for (cell, out) in cells.zip(chunk.chunks_exact_mut(n)) {
                of_cell(cell).write(out);
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * n, &mut kept, &fill);
        Self { kept }
    }
    #[inline(always)]
    pub fn at<const D: usize>(&self, cell: usize) -> CellMetric<D> {
        let n = CellMetric::<D>::KEPT;
        CellMetric::read(&self.kept[cell * n..(cell + 1) * n])
    }
    #[inline(always)]
    pub fn measure<const D: usize>(&self, (cell, local): HalfFacet) -> f64 {
        self.kept[cell * CellMetric::<D>::KEPT + 1 + local]
    }
    /// The volume of a cell and the measures of its facets.
    #[inline(always)]
    pub fn measures<const D: usize>(&self, cell: usize) -> (f64, &[f64]) {
        let kept = &self.kept[cell * CellMetric::<D>::KEPT..][..D + 2];
        (kept[0], &kept[1..])
    }
    /// The products of the gradient opposite facet `local` of a cell with all of its gradients.
    #[inline(always)]
    pub fn products_of<const D: usize>(&self, cell: usize, local: usize) -> [f64; 4] {
        let n = CellMetric::<D>::KEPT;
        let kept = &self.kept[cell * n + D + 2..(cell + 1) * n];
        // by products with zeros and ones: facets come in no order that branches could foresee
        let (locations, others) = (&PAIR[D][local & 3], &OTHERS[local & 3]);
        let mut row = [0.0; 4];
        let mut sum = 0.0;
        for k in 0..=D {
            row[k] = others[k] * kept[locations[k]];
            sum -= row[k];
        }
        for k in 0..=D {
            row[k] += (1.0 - others[k]) * sum;
        }
        row
    }
}
