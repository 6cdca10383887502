//! Levels of conforming linear functions: sizes, and those that aggregation makes.

use super::*;
use crate::problems::laplacian;
use std::sync::Arc;
use unilateral::linear::{CoarseLevel, P1Level, Prolongation};

#[test]
fn levels_of_different_sizes_do_not_fit() {
    let matrix = || laplacian(9, 1, 2.0);
    let prolongation =
        |n: usize| Arc::new(Prolongation::midpoints(&parents_in_a_row(n), n / 2 + 1));
    let coarse = Arc::new(P1Level::new(laplacian(5, 1, 2.0), vec![false; 5], None).unwrap());
    let level = |coarser| P1Level::new(matrix(), vec![false; 9], coarser);
    let coarser = CoarseLevel::new(coarse.clone(), prolongation(9));
    assert_eq!(level(coarser).map(|level| level.size()), Some(9));
    // six coarse unknowns for five vertices, ten fine unknowns for nine vertices, eight flags for nine rows
    assert!(CoarseLevel::new(coarse.clone(), prolongation(11)).is_none());
    let of_too_many = vec![[0, 1]; 10];
    let prolongation = Arc::new(Prolongation::midpoints(&of_too_many, 5));
    assert!(level(CoarseLevel::new(coarse, prolongation)).is_none());
    assert!(P1Level::new(matrix(), vec![false; 8], None).is_none());
    let mut malformed = matrix();
    malformed.columns[0] = 9;
    assert!(P1Level::new(malformed, vec![false; 9], None).is_none());
}

/// A level of so many vertices that it has a coarser one by aggregation.
fn aggregated(matrix: &SparseMatrix<f64>, fixed: &[bool]) -> P1Level<f64> {
    P1Level::new(matrix.clone(), fixed.to_vec(), None).unwrap()
}

/// The entries of the coarse matrix are the forms of the coarse functions, the columns of the prolongation.
#[test]
fn the_matrix_of_an_aggregated_level_has_the_forms_of_its_functions() {
    for (matrix, every) in [(laplacian(700, 1, 2.0), 9), (laplacian(27, 26, 4.5), 4)] {
        let n = matrix.size();
        let fixed: Vec<bool> = (0..n).map(|i| i % every == 1).collect();
        for fixed in [vec![false; n], fixed] {
            let level = aggregated(&matrix, &fixed);
            let coarser = level.coarser().unwrap();
            let (coarse, prolongation) = (coarser.level().matrix(), coarser.prolongation());
            let n_coarse = coarse.size();
            assert!(coarse.is_well_formed() && n_coarse > 1 && 2 * n_coarse <= n);
            let function = |k: usize| {
                let mut unit = vec![0.0; n_coarse];
                unit[k] = 1.0;
                prolongation.prolongate(&unit)
            };
            let functions: Vec<Vec<f64>> = (0..n_coarse).map(function).collect();
            for (l, w) in functions.iter().enumerate() {
                assert!(w.iter().zip(&fixed).all(|(w, fixed)| !fixed || *w == 0.0));
                let image: Vec<f64> = (0..n).map(|i| matrix.row_dot(i, w)).collect();
                for (k, v) in functions.iter().enumerate() {
                    let (found, expected) = (coarse.get(k, l), dot(v, &image));
                    assert!((found - expected).abs() < 1e-13, "{k} {l}: {found} {expected}");
                }
            }
        }
    }
}

/// So many rows on both levels that several tasks compute them.
#[test]
fn aggregated_levels_have_the_same_bits_for_any_number_of_threads() {
    let matrix = laplacian(12_000, 1, 2.0);
    let fixed: Vec<bool> = (0..matrix.size()).map(|i| i % 100 == 7).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let level = aggregated(&matrix, &fixed);
            let coarser = level.coarser().unwrap();
            let coarse = coarser.level().matrix().clone();
            assert!(coarse.is_well_formed() && coarse.size() > 3000, "{}", coarse.size());
            let v: Vec<f64> = (0..coarse.size()).map(|k| (k as f64).sin()).collect();
            let of_functions = coarser.prolongation().prolongate(&v);
            (coarse, of_functions)
        })
    };
    assert!(with(1) == with(3));
}
