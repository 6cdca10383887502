//! The preconditioners of the library as operators: the cycle that their description says, symmetric and positive, the
//! same after any other fixed unknowns.

mod coarse_levels;
mod cycles;
mod facet_means;
mod history;
mod smoothers;

use crate::problems::Random;
use std::collections::BTreeMap;
use unilateral::algebra::{Bound, DofLocation, Inequality, SparseMatrix};
use unilateral::linear::{
    BuiltInPreconditioners, CoarseSpaces, PreconditionedSystem, Preconditioner,
    PreconditionerFamily,
};

/// The inequality of a symmetric matrix on free unknowns with the given locations.
fn with_locations(matrix: SparseMatrix<f64>, locations: Vec<DofLocation>) -> Inequality<f64> {
    let n = matrix.size();
    let mut inequality = Inequality::new(matrix, true, vec![0.0; n], vec![Bound::Free; n]);
    inequality.locations = locations;
    inequality
}

/// The preconditioner of the library for the symmetric matrix of an inequality.
fn preconditioner<'a>(
    inequality: &'a Inequality<f64>,
    spaces: &'a CoarseSpaces<f64>,
) -> Option<Box<dyn Preconditioner<f64> + 'a>> {
    let system = PreconditionedSystem::new(&inequality.matrix, inequality, spaces);
    BuiltInPreconditioners.preconditioner(system)
}

/// A residual that is zero on fixed unknowns.
fn residual(fixed: &[bool], seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let entries = fixed.iter().map(|&fixed| (fixed, random.signed()));
    entries.map(|(fixed, entry)| if fixed { 0.0 } else { entry }).collect()
}

/// The preconditioner times a residual, whatever was in the memory of the result.
fn apply(preconditioner: &mut dyn Preconditioner<f64>, r: &[f64]) -> Vec<f64> {
    let mut z = vec![9.0; r.len()];
    preconditioner.apply(r, &mut z);
    z
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Asserts that a preconditioner is symmetric in its products with two residuals, positive there, and zero on fixed
/// unknowns; returns the smaller of the two Rayleigh quotients.
#[track_caller]
fn check_symmetry(preconditioner: &mut dyn Preconditioner<f64>, fixed: &[bool]) -> f64 {
    let [b, c] = [1, 2].map(|seed| residual(fixed, seed));
    let [x, y] = [&b, &c].map(|r| apply(preconditioner, r));
    for z in [&x, &y] {
        assert!(z.iter().zip(fixed).all(|(z, fixed)| !fixed || *z == 0.0));
    }
    let sizes = [dot(&x, &b), dot(&y, &c)];
    assert!(sizes[0] > 0.0 && sizes[1] > 0.0, "{sizes:?}");
    let (bc, cb, size) = (dot(&x, &c), dot(&y, &b), (sizes[0] * sizes[1]).sqrt());
    assert!((bc - cb).abs() < 2e-6 * size, "{bc} {cb} {size}");
    (sizes[0] / dot(&b, &b)).min(sizes[1] / dot(&c, &c))
}

/// The rows of a prolongation: columns and weights.
type Rows = Vec<Vec<(usize, f64)>>;

/// `P^T A P`.
fn galerkin(matrix: &SparseMatrix<f64>, prolongation: &Rows, n_coarse: usize) -> SparseMatrix<f64> {
    let mut rows = vec![BTreeMap::new(); n_coarse];
    for (i, parents) in prolongation.iter().enumerate() {
        let (columns, values) = matrix.row(i);
        for (&j, a) in columns.iter().zip(values) {
            for &(k, weight) in parents {
                for &(l, other) in &prolongation[j as usize] {
                    *rows[k].entry(l as u32).or_insert(0.0) += weight * a * other;
                }
            }
        }
    }
    from_rows(rows)
}

/// The matrix with the given entries of its rows.
fn from_rows(rows: Vec<BTreeMap<u32, f64>>) -> SparseMatrix<f64> {
    let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
    for row in rows {
        matrix.columns.extend(row.keys());
        matrix.values.extend(row.values());
        matrix.row_starts.push(matrix.columns.len() as u32);
    }
    matrix
}

/// Each unknown is the mean of the values at the vertices of its location.
fn means(locations: &[DofLocation]) -> Rows {
    let row = |location: &DofLocation| {
        let vertices = location.vertices();
        vertices.iter().map(|&v| (v as usize, 1.0 / vertices.len() as f64)).collect()
    };
    locations.iter().map(row).collect()
}

/// The rows of [`Prolongation::midpoints`](unilateral::linear::Prolongation::midpoints).
fn midpoints(parents: &[[u32; 2]]) -> Rows {
    parents.iter().map(|pair| pair.map(|parent| (parent as usize, 0.5)).to_vec()).collect()
}

/// The parents of the vertices of `2 n - 1` points in a row, for `n` coarse ones.
fn parents_in_a_row(n_fine: usize) -> Vec<[u32; 2]> {
    (0..n_fine as u32).map(|i| [i / 2, i.div_ceil(2)]).collect()
}
