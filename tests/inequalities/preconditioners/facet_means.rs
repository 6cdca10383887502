//! The splitting of over-penalised linear functions into facet means and jumps, near a cell with free and fixed values.

use super::*;
use crate::penalised_cells::{assembled, cells_in_a_row, product};
use crate::problems::laplacian;
use std::sync::Arc;
use unilateral::linear::P1Level;

/// The facet mean function of a facet: one at all vertices of a cell but the one opposite to the facet.
fn facet_mean_function(n: usize, facet: usize) -> Vec<f64> {
    (0..n).map(|i| if i == facet { 2.0 - n as f64 } else { 1.0 }).collect()
}

/// All vertices are fixed, so that no conforming function corrects anything. Of three cells in a row the one in the middle
/// has free and fixed values, and the residual has no component in facet mean functions but in those of the two sides
/// opposite to it. Then values and means together solve the block of the matrix without entries between means, and
/// Gauss-Seidel iterations on Crouzeix-Raviart functions, which leave the facets of the cell in the middle alone, change
/// nothing.
#[test]
fn mixed_cells_are_solved_with_the_means_over_their_sides() {
    for n in [3, 4] {
        let penalised = cells_in_a_row((3, n), false, vec![700.0, 30.0]);
        let size = 3 * n;
        let location = |i: usize| DofLocation::new(Some((i / n) as u32), &[i as u32]);
        let mut inequality =
            with_locations(assembled(&penalised), (0..size).map(location).collect());
        inequality.penalised = Some(penalised.clone());
        let level = P1Level::new(laplacian(size, 1, 3.0), vec![true; size], None).unwrap();
        let spaces = CoarseSpaces::SameMesh(Arc::new(level));
        let mut splitting = preconditioner(&inequality, &spaces).unwrap();
        assert_eq!(splitting.name(), "facet-split");
        // the sides opposite to the cell in the middle: facet 0 of the first cell, facet 1 of the last
        let means = [0, 1].map(|k| {
            let mut function = vec![0.0; size];
            let first = [0, 2 * n][k];
            function[first..first + n].copy_from_slice(&facet_mean_function(n, k));
            function
        });
        for free in 1..(1_u32 << n) - 1 {
            let is_free = |i: usize| i / n != 1 || free >> (i % n) & 1 == 1;
            let fixed: Vec<bool> = (0..size).map(|i| !is_free(i)).collect();
            splitting.set_fixed(&fixed).unwrap();
            let mut r = vec![0.0; size];
            for i in (n..2 * n).filter(|&i| !fixed[i]) {
                r[i] = (1.0 + i as f64).sin();
            }
            // a multiple of the mean over the facet
            for (k, strength) in [(0, 0.7), (1, -1.3)] {
                let first = [0, 2 * n][k];
                for i in (0..n).filter(|&i| i != k) {
                    r[first + i] = strength;
                }
            }
            let z = apply(&mut *splitting, &r);

            // the cells on both sides have multiples of their facet mean functions
            let of_means = [z[2], z[2 * n + 2]];
            for (k, value) in of_means.into_iter().enumerate() {
                for i in (0..size).filter(|&i| means[k][i] != 0.0) {
                    assert!((z[i] - value * means[k][i]).abs() < 1e-12, "{n} {free:b} {i}: {z:?}");
                }
            }
            let values: Vec<f64> = (0..size).map(|i| if i / n == 1 { z[i] } else { 0.0 }).collect();
            // rows of free values: all of the function
            let of_all = product(&penalised, &z);
            for i in (n..2 * n).filter(|&i| !fixed[i]) {
                assert!(
                    (of_all[i] - r[i]).abs() < 1e-10,
                    "{n} {free:b} {i}: {} {}",
                    of_all[i],
                    r[i]
                );
            }
            // rows of means: no entry between the two of them
            for (k, mean) in means.iter().enumerate() {
                let own: Vec<f64> = (0..size).map(|i| values[i] + of_means[k] * mean[i]).collect();
                let (found, expected) = (dot(mean, &product(&penalised, &own)), dot(mean, &r));
                assert!((found - expected).abs() < 1e-10, "{n} {free:b} {k}: {found} {expected}");
            }
        }
    }
}
