//! Functions of a matrix that the laws need.

use crate::algebra::{Inequality, SparseMatrix};

/// The location of an unknown, in words.
pub(super) fn describe(inequality: &Inequality<f64>, unknown: usize) -> String {
    let location = &inequality.locations[unknown];
    let cell = location.cell().map_or_else(String::new, |cell| format!("cell {cell}, "));
    match location.vertices() {
        [] => format!("{cell}inside"),
        [vertex] => format!("{cell}vertex {vertex}"),
        vertices => format!("{cell}amid vertices {vertices:?}"),
    }
}

/// The symmetric part on the free unknowns, scaled to a diagonal of plus or minus ones.
pub(super) fn scaled_symmetric_part(inequality: &Inequality<f64>) -> SparseMatrix<f64> {
    let mut part = inequality.matrix.submatrix(&inequality.free_unknowns());
    let scale = |a: f64| if a.abs() > 0.0 { a.abs().sqrt().recip() } else { 1.0 };
    let scales: Vec<f64> = part.diagonal().into_iter().map(scale).collect();
    for (row, scale) in scales.iter().enumerate() {
        for k in part.row_starts[row] as usize..part.row_starts[row + 1] as usize {
            part.values[k] = part.values[k] * scale * scales[part.columns[k] as usize];
        }
    }
    part.symmetric_part()
}

/// The largest entry of each row by magnitude.
pub(super) fn row_sizes(matrix: &SparseMatrix<f64>) -> Vec<f64> {
    let largest = |i| matrix.row(i).1.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    (0..matrix.size()).map(largest).collect()
}
