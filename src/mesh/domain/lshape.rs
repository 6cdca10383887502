//! The L-shaped domain.

use super::disc::check_shape;
use crate::arrays::array_of;
use crate::mesh::boundary::BoundaryCondition;
use crate::mesh::error::MeshError;
use crate::mesh::simplicial::Mesh;
use crate::mesh::validate::TaggedFacet;
use crate::real::Point;

impl<const D: usize> Mesh<D> {
    /// The square `(-half, half)^2` without its quadrant `x >= 0`, `y <= 0`, its shortest sides cut
    /// into `n`, each small square into two triangles along the diagonal from its lowest to its
    /// highest corner. The re-entrant corner is a vertex. All the boundary is Dirichlet.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for `n = 0`, a length that is not positive and finite and a dimension
    /// other than two; `MeshErrorKind::TooLarge`.
    pub fn l_shape(half: f64, n: usize) -> Result<Self, MeshError> {
        check_shape::<D>("L-shape", half, n)?;
        let per_line = 2 * n + 1;
        let vertex = |i: usize, j: usize| (i + j * per_line) as u32;
        let at = |i: usize| half * (i as f64 / n as f64 - 1.0);
        let vertices = (0..per_line * per_line)
            .map(|v| Point::from_fn(|k, _| at(if k == 0 { v % per_line } else { v / per_line })))
            .collect();
        let mut cells = Vec::with_capacity(18 * n * n);
        for (j, i) in (0..2 * n).flat_map(|j| (0..2 * n).map(move |i| (j, i))) {
            if i < n || j >= n {
                let (low, high) = (vertex(i, j), vertex(i + 1, j + 1));
                cells.extend([low, vertex(i + 1, j), high, low, vertex(i, j + 1), high]);
            }
        }
        let mut boundary = Vec::with_capacity(8 * n);
        let mut side = |a: u32, b: u32| {
            let vertices = array_of(|k| if k == 0 { a } else { b });
            boundary.push(TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet });
        };
        for k in 0..2 * n {
            // the grid lines of the sides that face right and down: the quadrant moves half of each inwards
            let (right, bottom) = if k < n { (n, 0) } else { (2 * n, n) };
            side(vertex(0, k), vertex(0, k + 1));
            side(vertex(right, k), vertex(right, k + 1));
            side(vertex(k, 2 * n), vertex(k + 1, 2 * n));
            side(vertex(k, bottom), vertex(k + 1, bottom));
        }
        Self::new(vertices, cells, &boundary)
    }
}
