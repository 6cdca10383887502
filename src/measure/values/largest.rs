//! The largest value of a function that is quadratic in cells.

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
/// by elimination in `H l - mu = g`, `sum l = 1`.
fn stationary(vertices: &[usize], h: &[[f64; 4]; 4], g: &[f64]) -> Option<[f64; 4]> {
    let n = vertices.len();
    let mut rows = [[0.0; 6]; 5];
    for (row, &k) in rows.iter_mut().zip(vertices) {
        vertices.iter().enumerate().for_each(|(c, &j)| row[c] = h[k][j]);
        (row[n], row[5]) = (-1.0, g[k]);
    }
    rows[n][..n].fill(1.0);
    rows[n][5] = 1.0;
    for column in 0..=n {
        let size = |row: usize| rows[row][column].abs();
        let pivot = (column..=n).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
        rows.swap(column, pivot);
        let of_pivot = rows[column];
        if of_pivot[column] == 0.0 {
            return None;
        }
        for (_, row) in rows.iter_mut().take(n + 1).enumerate().filter(|(k, _)| *k != column) {
            let factor = row[column] / of_pivot[column];
            row.iter_mut().zip(of_pivot).for_each(|(entry, of)| *entry -= factor * of);
        }
    }
    let mut point = [0.0; 4];
    for (k, &vertex) in vertices.iter().enumerate() {
        point[vertex] = rows[k][5] / rows[k][k];
    }
    vertices.iter().all(|&k| point[k] > 0.0 && point[k].is_finite()).then_some(point)
}
