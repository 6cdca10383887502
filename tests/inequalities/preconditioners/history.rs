//! A preconditioner is the same whatever unknowns were fixed before.

use super::cycles::string_with_levels;
use super::smoothers::{LENGTH, coupled_across};
use super::*;
use std::sync::Arc;
use unilateral::assemble::DataQuadrature;
use unilateral::linear::{CoarseLevel, P1Level, Prolongation};
use unilateral::prelude::*;

/// A preconditioner that was used for other sets has every bit of a new one. Returns the results for all sets.
fn check_history(
    inequality: &Inequality<f64>,
    spaces: &CoarseSpaces<f64>,
    sets: &[Vec<bool>],
    is_each_before_each: bool,
) -> Vec<Vec<f64>> {
    let new = || preconditioner(inequality, spaces).unwrap();
    let mut results = Vec::new();
    let mut after_all = new();
    for (k, after) in sets.iter().enumerate() {
        let r = residual(after, 7);
        let mut fresh = new();
        fresh.set_fixed(after).unwrap();
        let expected = apply(&mut *fresh, &r);
        assert!(expected.iter().zip(after).all(|(z, fixed)| *fixed == (*z == 0.0)), "{k}");
        after_all.set_fixed(after).unwrap();
        assert!(apply(&mut *after_all, &r) == expected, "set {k} after all before it");
        for (l, before) in sets.iter().enumerate().filter(|_| is_each_before_each) {
            let mut used = new();
            used.set_fixed(before).unwrap();
            used.set_fixed(after).unwrap();
            assert!(apply(&mut *used, &r) == expected, "set {k} after set {l}");
        }
        results.push(expected);
    }
    results
}

#[test]
fn a_cycle_depends_on_the_last_fixed_set_only() {
    let n = 64;
    let (inequality, spaces) = string_with_levels(n, false);
    // disjoint sets, and sets that share unknowns, whose rows are kept
    let sets = [
        &[][..],
        &[40],
        &[31, 33],
        &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9],
        &[16, 17, 48],
        &[31, 33, 40],
        &[16, 31, 33],
    ];
    let sets = sets.map(|set| (0..=n).map(|i| set.contains(&i)).collect::<Vec<_>>());
    let results = check_history(&inequality, &spaces, &sets, true);
    assert_ne!(results[0], results[1]);
}

/// The smoother of the coarser level, which has too many unknowns for factors, replaces its outdated rows; couplings
/// between chunks, and what is added to the diagonal because of them, are among them.
#[test]
fn replaced_rows_of_a_smoother_equal_new_ones() {
    let mut rows = coupled_across(6);
    let n_coarse = rows.len();
    let level = P1Level::new(from_rows(rows.clone()), vec![false; n_coarse], None).unwrap();
    // all vertices of the coarser level, then midpoints of neighbours at the ends of chunks
    let mut parents: Vec<[u32; 2]> = (0..n_coarse as u32).map(|i| [i, i]).collect();
    for near in (LENGTH..n_coarse).step_by(LENGTH) {
        parents.extend((near - 40..near + 40).step_by(3).map(|i| [i as u32, i as u32 + 1]));
    }
    for (k, &[a, b]) in parents.iter().enumerate().skip(n_coarse) {
        rows.push(BTreeMap::from([(k as u32, 2.0), (a, -0.1), (b, 0.1)]));
        rows[a as usize].insert(k as u32, -0.1);
        rows[b as usize].insert(k as u32, 0.1);
    }
    let n = rows.len();
    let inequality = with_locations(from_rows(rows), Vec::new());
    let prolongation = Prolongation::midpoints(&parents, n_coarse);
    let coarser = CoarseLevel::new(Arc::new(level), Arc::new(prolongation)).unwrap();
    let spaces = CoarseSpaces::CoarseLevel(coarser);
    let set = |is_fixed: &dyn Fn(usize) -> bool| (0..n).map(is_fixed).collect::<Vec<bool>>();
    let is_parent = |i: usize| parents[n_coarse..].iter().any(|pair| pair[0] as usize == i);
    let sets = [
        set(&|_| false),
        set(&|i| i >= n_coarse && i % 2 == 0),
        set(&|i| i < n_coarse && i % 4 == 1 && is_parent(i)),
        set(&|i| i % 5 == 2 && (i >= n_coarse || is_parent(i))),
        set(&|_| false),
    ];
    let results = check_history(&inequality, &spaces, &sets, false);
    assert_ne!(results[0][..n_coarse], results[1][..n_coarse]);
}

/// The block of cells with free and fixed values takes the memory of larger and smaller ones; its factors are supernodal
/// for many unknowns.
#[test]
fn the_factors_of_mixed_cells_depend_on_the_last_fixed_set_only() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(16).unwrap();
    let assemble = |scheme: &dyn Scheme<2>| {
        scheme.inequality(&scene.problem, &mesh, DataQuadrature::default()).unwrap()
    };
    let p1 = assemble(&ConformingP1);
    let dirichlet = p1.bounds.iter().map(|bound| matches!(bound, Bound::Fixed(_))).collect();
    let level = P1Level::new(p1.matrix, dirichlet, None).unwrap();
    let spaces = CoarseSpaces::SameMesh(Arc::new(level));
    let inequality = assemble(&Wopsip::default());
    let n = inequality.size();
    let sets =
        [(4, 1.0), (1, 1.0), (5, 0.4), (7, 0.01), (4, 0.7), (4, 1.0)].map(|(every, share)| {
            let last = (share * n as f64) as usize;
            (0..n).map(|i| every > 1 && i < last && i % every == 0).collect::<Vec<_>>()
        });
    check_history(&inequality, &spaces, &sets, false);
    let mut splitting = preconditioner(&inequality, &spaces).unwrap();
    assert_eq!(splitting.name(), "facet-split");
    for fixed in &sets {
        splitting.set_fixed(fixed).unwrap();
        check_symmetry(&mut *splitting, fixed);
    }
}
