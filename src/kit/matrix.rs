//! What the laws need of a matrix, in `f64`.

use crate::algebra::{Inequality, SparseMatrix, Support};

/// Matrix, load and supports.
pub(super) struct Assembled {
    pub matrix: SparseMatrix<f64>,
    pub symmetric: bool,
    pub load: Vec<f64>,
    pub supports: Vec<Support>,
    /// The unknowns that are not fixed.
    pub free: Vec<u32>,
}

impl Assembled {
    pub fn of(inequality: &Inequality<f64>) -> Self {
        let matrix = &inequality.matrix;
        let is_free = |i: &usize| inequality.bounds[*i].fixed_value().is_none();
        Self {
            matrix: SparseMatrix {
                row_starts: matrix.row_starts.clone(),
                columns: matrix.columns.clone(),
                values: matrix.values.clone(),
            },
            symmetric: inequality.symmetric,
            load: inequality.assembled_load().into_owned(),
            supports: inequality.supports.clone(),
            free: (0..inequality.size()).filter(is_free).map(|i| i as u32).collect(),
        }
    }

    /// The support of an unknown, in words.
    pub fn describe(&self, unknown: usize) -> String {
        let support = &self.supports[unknown];
        let cell = support.cell().map_or_else(String::new, |cell| format!("cell {cell}, "));
        match support.vertices() {
            [] => format!("{cell}inside"),
            [vertex] => format!("{cell}vertex {vertex}"),
            vertices => format!("{cell}amid vertices {vertices:?}"),
        }
    }

    /// The symmetric part on the free unknowns, scaled to a diagonal of plus or minus ones.
    pub fn scaled_symmetric_part(&self) -> SparseMatrix<f64> {
        let mut number = vec![u32::MAX; self.matrix.size()];
        for (k, &i) in self.free.iter().enumerate() {
            number[i as usize] = k as u32;
        }
        let scale = |i: u32| {
            let a = self.matrix.get(i as usize, i as usize).abs();
            if a > 0.0 { a.sqrt().recip() } else { 1.0 }
        };
        let scales: Vec<f64> = self.free.iter().map(|&i| scale(i)).collect();
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.free.len()];
        for (k, &i) in self.free.iter().enumerate() {
            let (columns, values) = self.matrix.row(i as usize);
            for (&j, &a) in columns.iter().zip(values) {
                let l = number[j as usize];
                if l != u32::MAX {
                    let half = 0.5 * a * scales[k] * scales[l as usize];
                    rows[k].push((l, half));
                    rows[l as usize].push((k as u32, half));
                }
            }
        }
        let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for mut row in rows {
            row.sort_by_key(|&(column, _)| column);
            for equal in row.chunk_by(|a, b| a.0 == b.0) {
                out.columns.push(equal[0].0);
                out.values.push(equal.iter().map(|&(_, a)| a).sum());
            }
            out.row_starts.push(out.columns.len() as u32);
        }
        out
    }
}

/// The largest entry of each row by magnitude.
pub(super) fn row_sizes(matrix: &SparseMatrix<f64>) -> Vec<f64> {
    let largest = |i| matrix.row(i).1.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    (0..matrix.size()).map(largest).collect()
}
