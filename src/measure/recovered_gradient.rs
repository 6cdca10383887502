//! A continuous gradient of a discrete function whose own gradient is constant in cells.

use nalgebra::SMatrix;

use crate::mesh::Mesh;
use crate::parallel::grouping::group_by_key;
use crate::parallel::vectors::collect;
use crate::problem::DiscreteFunction;
use crate::real::Point;

/// The matrix of a patch has this share of its trace added to the diagonal: barycentres on a line have no slope across it.
const REGULAR: f64 = 1e-8;

impl<const D: usize> DiscreteFunction<D> {
    /// A continuous, piecewise linear gradient by its values at the vertices of the mesh. At each vertex it is that of the
    /// linear function nearest, by least squares, to the gradients at the barycentres of the cells around: those that have a
    /// vertex in common with a cell at the vertex, so that patches at the boundary are not smaller than their functions.
    /// Where the solution is smooth its error has a higher order than that of the gradient of linears; at kinks, as along
    /// free boundaries and interfaces of coefficients, it is smeared over two cells.
    ///
    /// Source: O. C. Zienkiewicz, J. Z. Zhu, Int. J. Numer. Methods Engrg. 33 (1992), 1331-1364, whose patches are the cells
    /// at the vertex.
    pub fn recovered_gradient(&self) -> Vec<Point<D>> {
        let (mesh, gradients) = (self.mesh(), self.cell_gradients());
        let n_vertices = mesh.vertices().len();
        let (starts, cells) = group_by_key(mesh.n_cells(), n_vertices, |cell, put| {
            mesh.cell(cell).iter().for_each(|&v| put(v, cell as u32));
        });
        let at = |v: u32| &cells[starts[v as usize] as usize..starts[v as usize + 1] as usize];
        collect(n_vertices, |v| {
            let vertices = at(v as u32).iter().flat_map(|&cell| mesh.cell(cell as usize));
            let mut patch: Vec<u32> = vertices.flat_map(|&v| at(v)).copied().collect();
            patch.sort_unstable();
            patch.dedup();
            fitted_at(mesh, &gradients, &patch, &mesh.vertices()[v])
        })
    }
}

/// The value at a point of the linear function nearest to the gradients at the barycentres of some cells.
fn fitted_at<const D: usize>(
    mesh: &Mesh<D>,
    gradients: &[Point<D>],
    patch: &[u32],
    x: &Point<D>,
) -> Point<D> {
    let cells = || patch.iter().map(|&cell| cell as usize);
    let n = patch.len() as f64;
    let centre = cells().map(|cell| mesh.barycentre(cell)).sum::<Point<D>>() / n;
    let mean = cells().map(|cell| gradients[cell]).sum::<Point<D>>() / n;
    let (mut squares, mut products) =
        (SMatrix::<f64, D, D>::zeros(), SMatrix::<f64, D, D>::zeros());
    for cell in cells() {
        let offset = mesh.barycentre(cell) - centre;
        squares += offset * offset.transpose();
        products += (gradients[cell] - mean) * offset.transpose();
    }
    let trace = squares.trace();
    (0..D).for_each(|k| squares[(k, k)] += REGULAR * trace);
    // a mesh of one cell has no slopes
    squares.try_inverse().map_or(mean, |inverse| mean + products * (inverse * (x - centre)))
}
