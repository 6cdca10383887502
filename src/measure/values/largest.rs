//! The largest value of a function that is quadratic in cells.

use nalgebra::{DMatrix, DVector};

use super::{FoundValue, InCells};
use crate::assemble::space::Space;
use crate::measure::penetration::middle;
use crate::mesh::edge_vertices;

/// Corners and midpoints of edges of a tetrahedron.
const MOST_NODES: usize = 10;

impl<const D: usize> Space<'_, D> {
    /// The largest value of a function in a region with its place, or with the sign -1 the smallest one.
    pub(super) fn largest(&self, function: &InCells<'_>, name: &str, sign: f64) -> FoundValue<D> {
        let edges = if function.is_linear { &[] } else { edge_vertices(D) };
        let nodes: Vec<[f64; 4]> =
            (0..=D).map(|k| [k; 2]).chain(edges.iter().copied()).map(middle).collect();
        let mut best = (f64::NEG_INFINITY, None);
        let mut values = [0.0; MOST_NODES];
        for cell in self.cells_of(name) {
            for (value, node) in values.iter_mut().zip(&nodes) {
                *value = sign * (function.value)(cell, node);
            }
            let values = &values[..nodes.len()];
            if largest_coefficient(D, values) > best.0 {
                let (value, point) = largest_in_simplex(D, values);
                if value > best.0 {
                    best = (value, Some((cell, point)));
                }
            }
        }
        let (value, place) = best.1.map_or((None, None), |(cell, point)| {
            (Some((function.value)(cell, &point)), Some(self.mesh.point(cell, &point[..=D])))
        });
        FoundValue { value, place }
    }
}

/// The largest Bernstein coefficient of a linear or quadratic function with these values at corners and midpoints: no
/// value is larger.
fn largest_coefficient(dimension: usize, values: &[f64]) -> f64 {
    let (corners, midpoints) = values.split_at(dimension + 1);
    let of_edges = midpoints.iter().zip(edge_vertices(dimension));
    let of_edges = of_edges.map(|(m, &[a, b])| 2.0 * m - 0.5 * (corners[a] + corners[b]));
    corners.iter().copied().chain(of_edges).fold(f64::NEG_INFINITY, f64::max)
}

/// The largest value of a linear or quadratic function in a simplex and its barycentric point, from the values at corners
/// and midpoints: that of a corner, or where the function is stationary on an edge, a face or inside.
fn largest_in_simplex(dimension: usize, values: &[f64]) -> (f64, [f64; 4]) {
    let (corners, midpoints) = values.split_at(dimension + 1);
    // the function is q(l) = l.H l / 2 - corners.l
    let mut h = [[0.0; 4]; 4];
    for (k, corner) in corners.iter().enumerate() {
        h[k][k] = 4.0 * corner;
    }
    for (m, &[a, b]) in midpoints.iter().zip(edge_vertices(dimension)) {
        (h[a][b], h[b][a]) = (4.0 * m, 4.0 * m);
    }
    let mut best = (f64::NEG_INFINITY, [0.0; 4]);
    for (k, &corner) in corners.iter().enumerate() {
        if corner > best.0 {
            best = (corner, middle([k; 2]));
        }
    }
    let faces = if midpoints.is_empty() { 0 } else { 1_usize << (dimension + 1) };
    for face in (0..faces).filter(|face| face.count_ones() > 1) {
        let vertices: Vec<usize> = (0..=dimension).filter(|k| face >> k & 1 == 1).collect();
        let Some(point) = stationary(&vertices, &h, corners) else { continue };
        let product = |k: usize| (0..4).map(|j| h[k][j] * point[j]).sum::<f64>();
        let value: f64 =
            corners.iter().enumerate().map(|(k, c)| point[k] * (0.5 * product(k) - c)).sum();
        if value > best.0 {
            best = (value, point);
        }
    }
    best
}

/// Where `l.H l / 2 - g.l` is stationary among the points with these barycentric coordinates only, if all are positive:
/// the solution of `H l - mu = g`, `sum l = 1`.
fn stationary(vertices: &[usize], h: &[[f64; 4]; 4], g: &[f64]) -> Option<[f64; 4]> {
    let n = vertices.len();
    let matrix = DMatrix::from_fn(n + 1, n + 1, |row, column| match (row < n, column < n) {
        (true, true) => h[vertices[row]][vertices[column]],
        (true, false) => -1.0,
        (false, is_coordinate) => f64::from(u8::from(is_coordinate)),
    });
    let right = DVector::from_fn(n + 1, |row, _| if row < n { g[vertices[row]] } else { 1.0 });
    let solution = matrix.lu().solve(&right)?;
    let mut point = [0.0; 4];
    vertices.iter().zip(&solution).for_each(|(&vertex, x)| point[vertex] = *x);
    vertices.iter().all(|&k| point[k] > 0.0 && point[k].is_finite()).then_some(point)
}
