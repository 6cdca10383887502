//! The whole family of discontinuous schemes: one solution, the orders of theory.

mod support;

use support::accuracy::{Boxed, Checks, label, own_scene, rows, solve_as_tables};
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::scenes::{BoxDomain, Scene};
use unilateral::solve::Outcome;
use unilateral::study::{SchemeOptions, scheme_by_name};

/// The scheme of this name with its default penalty.
fn named<const D: usize>(name: &str) -> Boxed<f64, D> {
    scheme_by_name(name, &SchemeOptions::default()).unwrap()
}

/// The members on linears that no other test of accuracy looks at.
const LINEARS: [&str; 5] = ["iipg", "ldg", "ldg-switch", "br2", "bmmpr"];

/// All members on quadratics.
const QUADRATICS: [&str; 8] =
    ["sipg-p2", "nipg-p2", "iipg-p2", "ldg-p2", "ldg-switch-p2", "br2-p2", "bmmpr-p2", "wopsip-p2"];

/// L2 norm and broken H1 seminorm of a difference of linear functions on each cell.
fn distance<const D: usize>(mesh: &Mesh<f64, D>, one: &[f64], other: &[f64]) -> [f64; 2] {
    let rule = Rule::of_degree(D, 2);
    let [mut l2, mut h1] = [0.0; 2];
    for (cell, (one, other)) in one.chunks(D + 1).zip(other.chunks(D + 1)).enumerate() {
        let geometry = mesh.geometry(cell);
        let values: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
        let slope = |s: Point<f64, D>, k: usize| s + geometry.gradient(k) * values[k];
        h1 += geometry.volume * (0..=D).fold(Point::zeros(), slope).norm_squared();
        for (point, weight) in rule.iter() {
            let value: f64 = point.iter().zip(&values).map(|(b, u)| b * u).sum();
            l2 += weight * geometry.volume * value * value;
        }
    }
    [l2.sqrt(), h1.sqrt()]
}

/// The order in each norm between two levels, the finer with half the mesh size.
fn orders([coarse, fine]: [[f64; 2]; 2]) -> [f64; 2] {
    std::array::from_fn(|norm| (coarse[norm] / fine[norm]).log2())
}

/// Members on linears: orders of the error over the last pair of levels, and of the distance from
/// the symmetric method, which falls over every pair and as fast as the errors over the last.
fn linears(scene: &Scene<2>, levels: [usize; 3]) {
    let mut checks = Checks::default();
    let symmetric = levels.map(|n| solve_as_tables(scene, &*named("sipg"), n).1.fields.unwrap().u);
    for name in LINEARS {
        let scheme = named(name);
        let mut errors = [[0.0; 2]; 3];
        let mut distances = [[0.0; 2]; 3];
        for (k, (&level, symmetric)) in levels.iter().zip(&symmetric).enumerate() {
            let (mesh, solved) = solve_as_tables(scene, &*scheme, level);
            let (outcome, found) = (solved.outcome, solved.certificate.largest());
            checks.that(outcome == Outcome::Converged && found < 1e-9, || {
                format!("{name} on {}, level {level}: {outcome}, {found:e}", scene.name)
            });
            errors[k] = [solved.error.l2, solved.error.h1].map(Option::unwrap);
            distances[k] = distance(&mesh, &solved.fields.unwrap().u, symmetric);
        }
        let what = format!("{name} on {}", scene.name);
        let [l2, h1] = orders([errors[1], errors[2]]);
        checks.that((0.95..1.1).contains(&h1) && (1.9..2.2).contains(&l2), || {
            format!("{what}: H1 {h1:.3}, L2 {l2:.3}")
        });
        let [early, [l2, h1]] = [0, 1].map(|k| orders([distances[k], distances[k + 1]]));
        checks.that(early.iter().all(|&o| o > 0.8) && h1 > 0.9 && l2 > 1.8, || {
            format!("{what}, distance from sipg: H1 {h1:.3}, L2 {l2:.3}, before {early:?}")
        });
    }
    checks.finish();
}

/// Measured over the last pair: H1 1.007, 1.067, 0.969, 0.978, 1.004, L2 1.925, 2.153, 1.984, 1.986,
/// 1.992; the distances H1 1.011, 1.101, 0.946, 0.908, 0.944, L2 1.939, 2.078, 1.947, 1.839, 1.864.
#[test]
fn linears_on_the_radial_obstacle() {
    linears(&scenes::radial(1.0), [16, 32, 64]);
}

/// Measured over the last pair: H1 1.004, 1.081, 0.999, 0.993, 0.994, L2 2.009, 2.176, 2.005, 1.990,
/// 1.994; the distances H1 1.037, 1.093, 0.992, 0.985, 0.971, L2 1.984, 2.126, 1.989, 1.964, 1.969.
#[test]
fn linears_under_a_signorini_condition() {
    linears(&scenes::signorini_2d(), [8, 16, 32]);
}

/// The equation `-Laplace u = D u` of a product of cosines, Dirichlet data on the whole boundary.
fn smooth<const D: usize>() -> Scene<D> {
    let angle = |x: &Point<f64, D>, k: usize| x[k] + 0.3 * k as f64;
    let value = move |x: &Point<f64, D>| (0..D).map(|k| angle(x, k).cos()).product::<f64>();
    let gradient = move |x: &Point<f64, D>| Point::from_fn(|k, _| -value(x) * angle(x, k).tan());
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let load = move |x: &Point<f64, D>| D as f64 * value(x);
    own_scene("smooth", domain, Problem::new().source(load).exact(value, gradient))
}

fn smooth_quadratics<const D: usize>(levels: [usize; 2]) {
    let mut checks = Checks::default();
    for name in QUADRATICS {
        let clock = std::time::Instant::now();
        for row in rows(smooth::<D>(), vec![named(name)], levels) {
            checks.certified(&row, 1e-9);
            eprintln!(
                "{} H1 {:?} L2 {:?}  {:?}",
                label(&row),
                row.order.h1,
                row.order.l2,
                clock.elapsed()
            );
        }
    }
    checks.finish();
}

#[test]
fn quadratics_on_an_interval() {
    smooth_quadratics::<1>([64, 128]);
}

#[test]
fn quadratics_in_the_plane() {
    smooth_quadratics::<2>([16, 32]);
}

#[test]
fn quadratics_in_space() {
    smooth_quadratics::<3>([3, 6]);
}

fn quadratics(scene: impl Fn() -> Scene<2>, levels: [usize; 3]) {
    let mut checks = Checks::default();
    for name in QUADRATICS {
        let clock = std::time::Instant::now();
        for row in rows(scene(), vec![named(name)], levels) {
            checks.certified(&row, 1e-9);
            eprintln!(
                "{} H1 {:?} L2 {:?} {:?}",
                label(&row),
                row.order.h1,
                row.order.l2,
                clock.elapsed()
            );
        }
    }
    checks.finish();
}

#[test]
fn quadratics_on_the_radial_obstacle() {
    quadratics(|| scenes::radial::<2>(1.0), [8, 16, 32]);
}

#[test]
fn quadratics_under_a_signorini_condition() {
    quadratics(scenes::signorini_harmonic::<2>, [8, 16, 32]);
}
