//! Solutions with kinks: those on lines of the mesh are reproduced, the errors of others are known.

use super::compare::column;
use crate::support::checks::Checks;
use crate::support::rows::rows;
use crate::support::tables::{jump_norm, norms_by_rule, solve_as_tables, solve_by_rule};
use unilateral::inequality::Outcome;
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::scenes::Scene;

/// The halves beside the median to the longest side, which joins the first vertex to the last:
/// their corners in barycentric coordinates. In squares on the diagonal that is no line of the
/// mesh, that diagonal runs between them.
const HALVES: [[[f64; 3]; 3]; 2] = {
    let [first, middle, last] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let foot = [0.5, 0.0, 0.5];
    [[first, middle, foot], [foot, middle, last]]
};

/// L2 norm and H1 seminorm of the error of linear elements, which is linear on each half: exact.
fn norms_on_halves(scene: &Scene<2>, level: usize) -> [f64; 2] {
    let (mesh, solved) = solve_as_tables(scene, &*column("p1"), level);
    assert_eq!(solved.outcome, Outcome::Converged, "n = {level}");
    let exact = scene.problem.exact.as_ref().unwrap();
    let rule = Rule::new(2, 2);
    let [mut l2, mut h1] = [0.0; 2];
    for (cell, values) in solved.fields.unwrap().u.chunks(3).enumerate() {
        let geometry = mesh.geometry(cell);
        let volume = geometry.volume / 2.0;
        let slope = |s: Point<2>, k: usize| s + geometry.gradient(k) * values[k];
        let gradient = (0..3).fold(Point::zeros(), slope);
        for half in &HALVES {
            for (point, weight) in rule.iter() {
                let at: [f64; 3] =
                    std::array::from_fn(|k| (0..3).map(|j| point[j] * half[j][k]).sum());
                let x = mesh.point(cell, &at);
                let value: f64 = at.iter().zip(values).map(|(b, u)| b * u).sum();
                l2 += weight * volume * (value - exact.value.at(&x)).powi(2);
                h1 += weight * volume * (gradient - (exact.gradient)(&x)).norm_squared();
            }
        }
    }
    [l2.sqrt(), h1.sqrt()]
}

/// Linear elements interpolate the pyramid. On each of the `n` squares along the diagonal that is
/// no line of the mesh the error is a pyramid of height `1/n`: H1 `2 n^(-1/2)`, L2
/// `(2/3)^(1/2) n^(-3/2)`.
#[test]
fn the_pyramid_is_interpolated() {
    let mut checks = Checks::default();
    for (n, printed) in [(8, "0.70711"), (16, "0.5000"), (32, "0.35355"), (64, "0.2500")] {
        let [l2, h1] = norms_on_halves(&scenes::pyramid_full_2d(), n);
        checks.printed(&format!("H1, n = {n}"), h1, printed, 0.5);
        let cells = n as f64;
        checks.close(&format!("H1, n = {n}"), h1, 2.0 / cells.sqrt(), 1e-12);
        checks.close(&format!("L2, n = {n}"), l2, (2.0_f64 / 3.0).sqrt() / cells.powf(1.5), 1e-12);
    }
    checks.finish();
}

/// The kink lies on lines of the mesh, and the solution is linear on each cell.
#[test]
fn a_ridge_on_mesh_lines_is_reproduced() {
    fn check<const D: usize>(checks: &mut Checks, levels: [usize; 2]) {
        let schemes: Vec<_> = ["p1", "cr", "sipg 20"].into_iter().map(column).collect();
        for row in rows(scenes::ridge::<D>(), schemes, levels) {
            checks.certified(&row, 1e-9);
            let [h1, max] = [row.error.h1, row.error.max].map(Option::unwrap);
            checks.that(h1 < 1e-12 && max < 1e-12, || {
                format!("{} on {}, level {}: {h1:e}, {max:e}", row.scheme, row.scene, row.level)
            });
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, [16, 64]);
    check::<2>(&mut checks, [8, 32]);
    check::<3>(&mut checks, [4, 6]);
    checks.finish();
}

/// A ridge through the middles of cells: figures of an independent program by rules of six points
/// in each direction, which the kink makes inexact, except for conforming elements: these are flat
/// on the cells of the kink.
#[test]
fn a_ridge_between_mesh_lines() {
    let table: &[(&str, &[(usize, &str)])] = &[
        ("p1", &[(9, "3.766e-1"), (17, "2.622e-1"), (33, "1.825e-1"), (65, "1.275e-1")]),
        ("wopsip 1", &[(9, "4.045e-1"), (17, "2.651e-1"), (33, "1.814e-1"), (65, "1.267e-1")]),
        ("cr", &[(9, "3.651e-1"), (65, "1.344e-1")]),
    ];
    let scene = scenes::ridge::<2>();
    let mut checks = Checks::default();
    for (scheme, rows) in table {
        for (n, printed) in *rows {
            let (mesh, solved) = solve_by_rule(&scene, &*column(scheme), *n, 11);
            let [_, h1] = norms_by_rule(&scene, &mesh, &solved.fields.unwrap().u, 11);
            checks.printed(&format!("{scheme}, n = {n}"), h1, printed, 0.5);
        }
    }
    checks.finish();
}

/// What WOPSIP makes of a ridge on mesh lines, which it does not reproduce: figures of an
/// independent program, H1 and norm of the jumps.
#[test]
fn a_ridge_on_mesh_lines_with_weak_over_penalty() {
    let mut checks = Checks::default();
    let printed = [(16, "5.3e-2", "0.202"), (32, "1.4e-2", "0.106"), (64, "3.5e-3", "0.0539")];
    for (n, printed_h1, printed_jump) in printed {
        let (_, solved) = solve_as_tables(&scenes::ridge::<2>(), &*column("wopsip 1"), n);
        let [h1, energy] = [solved.error.h1, solved.error.energy].map(Option::unwrap);
        checks.printed(&format!("H1, n = {n}"), h1, printed_h1, 0.5);
        checks.printed(&format!("jump, n = {n}"), jump_norm(energy, h1), printed_jump, 0.5);
    }
    checks.finish();
}
