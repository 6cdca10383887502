//! Penalised matrices of a few cells.

use unilateral::algebra::{JumpTerm, Jumps, MeanJumps, PenalisedMatrix, SparseMatrix};

/// Some cells of `n` unknowns in a row, facet 0 of each being facet 1 of the next one, with a weight for each
/// common facet. With one weight more there are Dirichlet data on facet 2 of the first cell.
pub fn cells_in_a_row(
    (n_cells, n): (usize, usize),
    are_means: bool,
    weights: Vec<f64>,
) -> PenalisedMatrix<f64> {
    const NONE: u32 = JumpTerm::<f64>::NO_UNKNOWN;
    let on_facet = |cell: usize, facet: usize| {
        let unknowns = (0..n).filter(move |&i| (i == facet) == are_means);
        unknowns.map(move |i| (cell * n + i) as u32)
    };
    let weight = 1.0 / on_facet(0, 0).count() as f64;
    let term = |(here, there)| JumpTerm { here, there, weight };
    let (mut terms, mut starts, mut sides) = (Vec::new(), vec![0], Vec::new());
    for cell in 0..weights.len() {
        if cell + 1 < n_cells {
            terms.extend(on_facet(cell, 0).zip(on_facet(cell + 1, 1)).map(term));
            sides.push([cell * n, (cell + 1) * n + 1].map(|side| side as u32));
        } else {
            terms.extend(on_facet(0, 2).map(|here| term((here, NONE))));
            sides.push([2, NONE]);
        }
        starts.push(terms.len() as u32);
    }
    let entry = |k: usize| {
        let (i, j) = (k / n, k % n);
        1.0 / (1 + i % n + j) as f64 + if i % n == j { 1.0 + i as f64 } else { 0.0 }
    };
    PenalisedMatrix {
        blocks: (0..n_cells * n * n).map(entry).collect(),
        jumps: Jumps::new((n_cells, n), starts, terms).unwrap(),
        jump_data: vec![0.0; weights.len()],
        weights,
        mean_jumps: Some(MeanJumps { are_means, sides }),
    }
}

/// The product with a vector: without a load and Dirichlet data the residual is the negative product.
pub fn product(penalised: &PenalisedMatrix<f64>, u: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; u.len()];
    penalised.residual(&vec![0.0; u.len()], |i| -u[i], &mut product);
    product
}

/// The assembled matrix, with all entries, by its products with unit vectors.
pub fn assembled(penalised: &PenalisedMatrix<f64>) -> SparseMatrix<f64> {
    let n = penalised.size();
    let columns = (0..n as u32).cycle().take(n * n).collect();
    let row_starts = (0..=n).map(|i| (i * n) as u32).collect();
    let mut matrix = SparseMatrix { row_starts, columns, values: vec![0.0; n * n] };
    for j in 0..n {
        let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
        let column = product(penalised, &unit);
        (0..n).for_each(|i| matrix.values[i * n + j] = column[i]);
    }
    matrix
}
