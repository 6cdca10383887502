//! Points and cells of a VTK grid, linear or quadratic.

use crate::mesh::{CellGeometry, Edges, Mesh, edge_vertices};
use crate::real::Point;

/// Ends of the edges of a line, a triangle and a tetrahedron in the order of the format.
const VTK_EDGES: [&[[usize; 2]]; 4] =
    [&[], &[[0, 1]], &[[0, 1], [1, 2], [0, 2]], &[[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]];
/// Numbers of the format for points, lines, triangles and tetrahedra, linear and quadratic.
const VTK_TYPES: [[u8; 2]; 4] = [[1, 1], [3, 21], [5, 22], [10, 24]];

/// The cells of a mesh, then the facets of its boundary, on points that the cells share or that each has for
/// itself.
#[derive(Default)]
pub(super) struct Grid<const D: usize> {
    pub points: Vec<Point<D>>,
    /// For each point the place of its value among the values of all cells.
    pub sources: Vec<usize>,
    /// The points of each cell and facet, one after the other.
    pub connectivity: Vec<u32>,
    /// Where those of each end.
    pub ends: Vec<u64>,
    pub types: Vec<u8>,
}

/// Number of values of each cell for a function of degree one and two.
pub(super) const fn values_per_cell(dimension: usize, degree: usize) -> usize {
    dimension + 1 + (degree - 1) * edge_vertices(dimension).len()
}

impl<const D: usize> Grid<D> {
    /// The grid of a function with `n` values in each cell: at the vertices, then at the midpoints of
    /// the edges if the function is quadratic. Cells share their points if the function is continuous up
    /// to its relative rounding.
    pub fn new(mesh: &Mesh<D>, u: &[f64], n: usize) -> Self {
        let is_quadratic = n > D + 1;
        let (sources, numbers) = shared(mesh, u, n)
            .unwrap_or_else(|| ((0..u.len()).collect(), (0..u.len() as u32).collect()));
        let point = |&k: &usize| {
            let vertex = |i: usize| mesh.vertices()[mesh.cell(k / n)[i] as usize];
            match k % n {
                i if i <= D => vertex(i),
                i => {
                    let [a, b] = edge_vertices(D)[i - D - 1];
                    (vertex(a) + vertex(b)) * 0.5
                }
            }
        };
        let mut grid = Self {
            points: sources.iter().map(point).collect(),
            sources,
            connectivity: Vec::new(),
            ends: Vec::new(),
            types: Vec::new(),
        };
        for cell in 0..mesh.n_cells() {
            let mut corners: Vec<usize> = (0..D + 1).collect();
            // Cells of a mesh list their vertices by number, those of the format counterclockwise, or
            // seen from the fourth: otherwise volumes come out negative.
            if D > 1 && !is_positive(mesh, cell, &corners) {
                corners.swap(D - 1, D);
            }
            grid.push(&numbers[cell * n..(cell + 1) * n], &corners, is_quadratic);
        }
        for facet in mesh.boundary() {
            let (cell, local) = (facet.cell as usize, usize::from(facet.local));
            let mut corners: Vec<usize> = (0..D + 1).filter(|&k| k != local).collect();
            // in space the normal points outwards
            let with_opposite = [&corners[..], &[local]].concat();
            if D == 3 && is_positive(mesh, cell, &with_opposite) {
                corners.swap(1, 2);
            }
            // linear, since readers of the format do not integrate over quadratic lines
            grid.push(&numbers[cell * n..(cell + 1) * n], &corners, false);
        }
        grid
    }

    /// Adds a simplex with these vertices of a cell.
    fn push(&mut self, points: &[u32], corners: &[usize], is_quadratic: bool) {
        let dimension = corners.len() - 1;
        self.connectivity.extend(corners.iter().map(|&k| points[k]));
        if is_quadratic {
            for &[i, j] in VTK_EDGES[dimension] {
                let [a, b] = [corners[i].min(corners[j]), corners[i].max(corners[j])];
                // edges are ordered by their second vertex
                self.connectivity.push(points[D + 1 + b * (b - 1) / 2 + a]);
            }
        }
        self.ends.push(self.connectivity.len() as u64);
        self.types.push(VTK_TYPES[dimension][usize::from(is_quadratic)]);
    }
}

/// The place of a value of each shared point, and the points of every cell; none if the cells at a point
/// do not agree in its value.
fn shared<const D: usize>(mesh: &Mesh<D>, u: &[f64], n: usize) -> Option<(Vec<usize>, Vec<u32>)> {
    let largest = u.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let rounding = 16.0 * f64::EPSILON * largest;
    let first_edge = mesh.vertices().len();
    let edges = (n > D + 1).then(|| Edges::with_cell_edges(mesh));
    let (n_edges, of_cells) = edges.map_or((0, Vec::new()), |(edges, of)| (edges.len(), of));
    let mut known = vec![u32::MAX; first_edge + n_edges];
    let (mut sources, mut numbers) = (Vec::new(), Vec::with_capacity(u.len()));
    for (k, value) in u.iter().enumerate() {
        let (cell, i) = (k / n, k % n);
        let entity = match i <= D {
            true => mesh.cell(cell)[i] as usize,
            false => first_edge + of_cells[cell * (n - D - 1) + i - D - 1] as usize,
        };
        if known[entity] == u32::MAX {
            known[entity] = sources.len() as u32;
            sources.push(k);
        }
        let number = known[entity];
        if (value - u[sources[number as usize]]).abs() > rounding {
            return None;
        }
        numbers.push(number);
    }
    Some((sources, numbers))
}

/// Whether the vertices of a cell in this order span a positive volume or area.
fn is_positive<const D: usize>(mesh: &Mesh<D>, cell: usize, order: &[usize]) -> bool {
    CellGeometry::new(|i| mesh.vertices()[mesh.cell(cell)[order[i]] as usize]).is_positive()
}
