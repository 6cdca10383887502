//! Cycles on small hierarchies, against a cycle of dense matrices.

use super::*;
use crate::problems::{random_definite, sparse};
use std::sync::Arc;
use unilateral::linear::{CoarseLevel, FactorError, P1Level, Prolongation};
use unilateral::nalgebra::{DMatrix, DVector};

/// A level with its prolongation from the next one, in which the vertices `dirichlet` are fixed.
struct Coarser {
    rows: Rows,
    dirichlet: Vec<bool>,
}

fn dense(matrix: &SparseMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.size(), matrix.size(), |i, j| matrix.get(i, j))
}

/// The solution on some unknowns, zero on all others.
fn solution_on(a: &DMatrix<f64>, unknowns: &[usize], b: &DVector<f64>) -> DVector<f64> {
    if unknowns.is_empty() {
        return DVector::zeros(b.len());
    }
    let block = a.select_rows(unknowns).select_columns(unknowns);
    let solved = block.cholesky().expect("positive definite").solve(&b.select_rows(unknowns));
    let mut x = DVector::zeros(b.len());
    unknowns.iter().zip(solved.iter()).for_each(|(&i, &value)| x[i] = value);
    x
}

/// Gauss-Seidel from zero, one correction with the truncated functions of the coarser levels, and Gauss-Seidel
/// backwards, with blocks of `size` unknowns; the solution on the coarsest level.
fn cycle(
    a: &DMatrix<f64>,
    (coarser, size): (&[Coarser], usize),
    fixed: &[bool],
    b: &DVector<f64>,
) -> DVector<f64> {
    let n = fixed.len();
    let free = |range: std::ops::Range<usize>| range.filter(|&i| !fixed[i]).collect::<Vec<_>>();
    let Some((next, coarser)) = coarser.split_first() else {
        return solution_on(a, &free(0..n), b);
    };
    let mut x = DVector::zeros(n);
    let mut blocks: Vec<_> = (0..n / size).map(|k| free(k * size..(k + 1) * size)).collect();
    for block in &blocks {
        x += solution_on(a, block, &(b - a * &x));
    }
    let n_coarse = next.dirichlet.len();
    let mut p = DMatrix::zeros(n, n_coarse);
    let mut coarse_fixed = vec![true; n_coarse];
    for i in free(0..n) {
        for &(j, weight) in &next.rows[i] {
            p[(i, j)] += weight;
            coarse_fixed[j] = next.dirichlet[j];
        }
    }
    let mut r = b - a * &x;
    (0..n).filter(|&i| fixed[i]).for_each(|i| r[i] = 0.0);
    let coarse = p.transpose() * a * &p;
    x += &p * cycle(&coarse, (coarser, 1), &coarse_fixed, &(p.transpose() * r));
    blocks.reverse();
    for block in &blocks {
        x += solution_on(a, block, &(b - a * &x));
    }
    x
}

/// A preconditioner is the cycle for one set of fixed unknowns after the other.
#[track_caller]
fn check_cycle(
    inequality: &Inequality<f64>,
    spaces: &CoarseSpaces<f64>,
    (coarser, size): (&[Coarser], usize),
    sets: &[Vec<usize>],
) {
    let a = dense(&inequality.matrix);
    let mut preconditioner = preconditioner(inequality, spaces).unwrap();
    for (seed, set) in (1..).zip(sets) {
        let fixed: Vec<bool> = (0..inequality.size()).map(|i| set.contains(&i)).collect();
        preconditioner.set_fixed(&fixed).unwrap();
        let r = residual(&fixed, seed);
        let found = apply(&mut *preconditioner, &r);
        let expected = cycle(&a, (coarser, size), &fixed, &DVector::from_vec(r));
        let largest = expected.amax();
        for (i, (found, expected)) in found.iter().zip(expected.iter()).enumerate() {
            let off = (found - expected).abs();
            assert!(off <= 2e-5 * largest, "{set:?} {i}: {found} {expected} {largest}");
        }
    }
}

/// Conforming linear functions on `n` equal intervals of (0, 1), for `-u'' + u`.
fn string(n: usize) -> SparseMatrix<f64> {
    let h = 1.0 / n as f64;
    let (diagonal, off_diagonal) = (1.0 / h + h / 3.0, -1.0 / h + h / 6.0);
    let mut rows = vec![BTreeMap::new(); n + 1];
    for i in 0..n {
        *rows[i].entry(i as u32).or_insert(0.0) += diagonal;
        *rows[i + 1].entry(i as u32 + 1).or_insert(0.0) += diagonal;
        rows[i].insert(i as u32 + 1, off_diagonal);
        rows[i + 1].insert(i as u32, off_diagonal);
    }
    from_rows(rows)
}

/// The levels of the string on `n` intervals from `n / 2` on, down to four intervals.
pub fn coarser_strings(n: usize, is_held: bool) -> Option<CoarseLevel<f64>> {
    (n > 4).then(|| {
        let fixed = (0..=n / 2).map(|i| is_held && i == 0).collect();
        let level = P1Level::new(string(n / 2), fixed, coarser_strings(n / 2, is_held)).unwrap();
        let prolongation = Prolongation::midpoints(&parents_in_a_row(n + 1), n / 2 + 1);
        CoarseLevel::new(Arc::new(level), Arc::new(prolongation)).unwrap()
    })
}

pub fn string_with_levels(n: usize, is_held: bool) -> (Inequality<f64>, CoarseSpaces<f64>) {
    let coarser = coarser_strings(n, is_held).unwrap();
    (with_locations(string(n), Vec::new()), CoarseSpaces::CoarseLevel(coarser))
}

#[test]
fn multigrid_is_the_cycle_of_dense_matrices() {
    for is_held in [false, true] {
        let (inequality, spaces) = string_with_levels(32, is_held);
        let coarser = [32, 16, 8].map(|n| Coarser {
            rows: midpoints(&parents_in_a_row(n + 1)),
            dirichlet: (0..=n / 2).map(|i| is_held && i == 0).collect(),
        });
        // midpoints, vertices of the coarsest mesh, all children of a vertex, neighbours
        let sets: [&[usize]; 6] =
            [&[], &[7], &[8, 20], &[15, 16, 17], &[1, 2, 3, 4, 5, 6, 9], &[21, 23, 24, 25, 27, 32]];
        let sets: Vec<Vec<usize>> = sets
            .iter()
            .map(|set| if is_held { [&[0][..], &set[..]].concat() } else { set.to_vec() })
            .collect();
        check_cycle(&inequality, &spaces, (&coarser, 1), &sets);
    }
}

/// Locations for elements on an interval with `n_vertices` vertices, and the number of unknowns that are smoothed at a
/// time.
fn elements(n_vertices: u32) -> Vec<(&'static str, Vec<DofLocation>, usize)> {
    let cells = 0..n_vertices - 1;
    let shared = |vertices: &[u32]| DofLocation::new(None, vertices);
    let of_cells = |size: usize, vertices: &dyn Fn(u32, usize) -> Vec<u32>| {
        let of_cell =
            |cell: u32| (0..size).map(move |k| DofLocation::new(Some(cell), &vertices(cell, k)));
        cells.clone().flat_map(of_cell).collect::<Vec<_>>()
    };
    let mut quadratics: Vec<DofLocation> = (0..n_vertices).map(|v| shared(&[v])).collect();
    quadratics.extend(cells.clone().map(|v| shared(&[v, v + 1])));
    // one vertex each, and means over two, as long as there are further unknowns
    let end = |cell: u32, k: usize| match k {
        0 | 1 => vec![cell + k as u32],
        _ if k.is_multiple_of(2) => vec![cell, cell + 1],
        _ => vec![cell, cell, cell + 1],
    };
    vec![
        (
            "two values at a vertex",
            [0..n_vertices, 0..n_vertices].into_iter().flatten().map(|v| shared(&[v])).collect(),
            1,
        ),
        ("conforming quadratics", quadratics, 1),
        ("discontinuous linear", of_cells(2, &end), 2),
        ("discontinuous quadratics", of_cells(3, &end), 3),
        ("four unknowns", of_cells(4, &end), 4),
        ("six unknowns", of_cells(6, &end), 6),
        ("ten unknowns", of_cells(10, &end), 10),
    ]
}

#[test]
fn conforming_linear_functions_on_the_mesh_are_the_second_level_of_other_elements() {
    let n_vertices = 6;
    for (name, locations, size) in elements(n_vertices) {
        let n = locations.len();
        println!("{name}: {n} unknowns");
        let matrix = sparse(&random_definite(n, n, 4.0, &mut Random::new(n as u64)));
        let rows = means(&locations);
        let dirichlet: Vec<bool> = (0..n_vertices).map(|v| v == 5).collect();
        let level = galerkin(&matrix, &rows, n_vertices as usize);
        let level = P1Level::new(level, dirichlet.clone(), None).unwrap();
        let spaces = CoarseSpaces::SameMesh(Arc::new(level));
        let coarser = [Coarser { rows, dirichlet }];
        // the children of a vertex are the unknowns with this vertex in their locations
        let children =
            |v: u32| (0..n).filter(|&i| locations[i].vertices().contains(&v)).collect::<Vec<_>>();
        let sets =
            [vec![], vec![0], vec![n - 1, 1, 3], children(2), [children(0), vec![n - 2]].concat()];
        let inequality = with_locations(matrix, locations.clone());
        check_cycle(&inequality, &spaces, (&coarser, size), &sets);
        // a location with a vertex that the level does not have
        let mut outside = inequality.clone();
        outside.locations[n - 1] = DofLocation::new(locations[n - 1].cell(), &[n_vertices]);
        assert!(preconditioner(&outside, &spaces).is_none(), "{name}");
        outside.locations[n - 1] = DofLocation::new(locations[n - 1].cell(), &[0, n_vertices]);
        assert!(preconditioner(&outside, &spaces).is_none(), "{name}");
    }
}

#[test]
fn a_block_that_is_not_positive_is_an_error() {
    let (name, locations, _) = elements(4).swap_remove(3);
    assert_eq!(name, "discontinuous quadratics");
    let n = locations.len();
    let level = P1Level::new(string(3), vec![false; 4], None).unwrap();
    let spaces = CoarseSpaces::SameMesh(Arc::new(level));
    for (diagonal, is_positive) in [(6.0, true), (-6.0, false)] {
        let entry = |i: usize, j: usize| if i == j { diagonal } else { 0.5 };
        let row = |i: usize| {
            (0..n).map(|j| if i / 3 == j / 3 { entry(i, j) } else { 0.0 }).collect::<Vec<_>>()
        };
        let matrix = sparse(&(0..n).map(row).collect::<Vec<_>>());
        let inequality = with_locations(matrix, locations.clone());
        let found = preconditioner(&inequality, &spaces).unwrap().set_fixed(&vec![false; n]);
        let expected = if is_positive { Ok(()) } else { Err(FactorError::NotPositive) };
        assert_eq!(found, expected);
    }
}
