//! The transpose of a large matrix, which threads share.

use rayon::ThreadPoolBuilder;
use unilateral::algebra::SparseMatrix;

/// The transpose by sorting all entries by their columns.
fn sorted(matrix: &SparseMatrix<f64>) -> SparseMatrix<f64> {
    let n = matrix.size();
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for i in 0..n {
        let (columns, values) = matrix.row(i);
        entries.extend(columns.iter().zip(values).map(|(&j, &a)| (j, i as u32, a)));
    }
    entries.sort_by_key(|&(column, row, _)| (column, row));
    let starts = 0..=n as u32;
    SparseMatrix {
        row_starts: starts.map(|k| entries.partition_point(|e| e.0 < k) as u32).collect(),
        columns: entries.iter().map(|entry| entry.1).collect(),
        values: entries.iter().map(|entry| entry.2).collect(),
    }
}

/// Some columns have no entry, the first one has many, some rows have two.
#[test]
fn transposes_are_those_of_a_sort_with_any_number_of_threads() {
    for n in [20_487, 100, 0] {
        let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
        for i in 0..n {
            let column = i * 7919 % n / 2 * 2;
            if i % 3 == 0 && column > 0 {
                matrix.columns.push(0);
                matrix.values.push(0.5 + i as f64);
            }
            matrix.columns.push(column as u32);
            matrix.values.push(i as f64);
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        let expected = sorted(&matrix);
        for threads in [1, 3] {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| matrix.transpose(matrix.size()));
            assert!(found == expected, "{n} rows, {threads} threads");
        }
    }
}
