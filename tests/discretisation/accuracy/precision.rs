//! Single precision, scaling, stretched meshes, the size of the over-penalty.

use crate::runs::solve;
use crate::support::checks::Checks;
use crate::support::rows::{label, rows, rows_in};
use crate::support::scheme_lists::all_schemes;
use crate::support::schemes::{Entry, wopsip};
use crate::support::tables::{DEGREE_OF_TABLES, jump_norm, norms_by_rule, solve_as_tables};
use unilateral::inequality::Outcome;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::real::Precision;
use unilateral::scenes::Scene;

/// In single precision errors are those of double precision, for the over-penalised scheme too.
#[test]
fn single_precision() {
    let mut checks = Checks::default();
    for build in [|| scenes::radial::<2>(1.0), scenes::signorini_2d] {
        let levels = [8, 16];
        let single = rows_in::<2>(Precision::Single, build(), all_schemes(), levels);
        let double = rows::<2>(build(), all_schemes(), levels);
        for (single, double) in single.iter().zip(&double) {
            let what = label(single);
            checks.certified(double, 1e-9);
            checks.certified(single, 1e-3);
            for (name, s, d) in
                [("L2", single.error.l2, double.error.l2), ("H1", single.error.h1, double.error.h1)]
            {
                let off = s.unwrap_or(f64::NAN) / d.unwrap() - 1.0;
                checks.that(off.abs() <= 0.03, || format!("{what}: {name} off by {off:.1e}"));
            }
        }
    }
    checks.finish();
}

/// The solution at the vertices of every cell.
fn values<const D: usize>(
    checks: &mut Checks,
    what: &str,
    scheme: &Entry<D>,
    scene: &Scene<D>,
    level: usize,
) -> Vec<f64> {
    let mesh = scene.domain.mesh(level).unwrap();
    let solved = solve(&**scheme, &scheme.constrain(&scene.problem), &mesh);
    let certificate = solved.certificate.largest();
    checks.that(solved.outcome.name() == "converged" && certificate < 1e-9, || {
        format!("{what}: {}, certificate {certificate:e}", solved.outcome)
    });
    solved.fields.unwrap().u
}

/// The largest difference over the largest value.
fn distance(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let difference = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    difference / theirs.iter().map(|b| b.abs()).fold(0.0, f64::max)
}

/// With default penalties the solution on the domain scaled by `L` is the same function of `x/L`.
#[test]
fn scaling_of_the_domain() {
    fn check<const D: usize>(checks: &mut Checks, level: usize) {
        for scheme in all_schemes::<D>() {
            let what = format!("{} ({}), {D}d", scheme.name(), scheme.constraint());
            let one = values(checks, &what, &scheme, &scenes::radial::<D>(1.0), level);
            for scale in [1e-6, 1e-3, 1e3, 1e6] {
                let scaled = scenes::radial::<D>(scale);
                let ours = values(checks, &what, &scheme, &scaled, level);
                let off = distance(&ours, &one);
                checks.that(off <= 1e-10, || format!("{what}, scale {scale}: off by {off:.1e}"));
            }
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, 16);
    check::<2>(&mut checks, 16);
    check::<3>(&mut checks, 4);
    checks.finish();
}

/// Coefficient and load times the same number: the same solution.
#[test]
fn scaling_of_the_coefficient() {
    let scaled = |factor: f64| {
        let mut scene = scenes::radial::<2>(1.0);
        scene.problem = scene.problem.coefficient(move |_| factor);
        scene.problem.source = Datum::Constant(-2.0 * factor).into();
        scene
    };
    let mut checks = Checks::default();
    for scheme in all_schemes::<2>() {
        let what = format!("{} ({})", scheme.name(), scheme.constraint());
        let one = values(&mut checks, &what, &scheme, &scenes::radial(1.0), 16);
        for factor in [1e-8, 1e-3, 7.0, 1e8] {
            let off = distance(&values(&mut checks, &what, &scheme, &scaled(factor), 16), &one);
            checks.that(off <= 1e-10, || format!("{what}, factor {factor}: off by {off:.1e}"));
        }
    }
    checks.finish();
}

/// On `16 x 16 r` boxes the over-penalty with heights of cells and interior penalty with its proven
/// bound stay as good as Crouzeix-Raviart, the over-penalty with the diameter of the facet does
/// not. H1 errors to the digits of an independent implementation, jumps of the over-penalty too.
#[test]
fn stretched_meshes() {
    let ratios = [1, 4, 16, 64];
    let mut checks = Checks::default();
    let scene = scenes::sines::<2>();
    let meshes =
        ratios.map(|r| Mesh::<2>::kuhn_box(&scene.domain.bounding_box(), [16, 16 * r]).unwrap());
    let mut spread = |scheme: &dyn Scheme<2>, printed: [&str; 4], jumps: [&str; 4]| {
        let mut energies = Vec::new();
        for ((mesh, ratio), (h1, jump)) in
            meshes.iter().zip(ratios).zip(printed.into_iter().zip(jumps))
        {
            let error = solve(scheme, &scene.problem, mesh).error;
            let [ours, energy] = [error.h1.unwrap(), error.energy.unwrap()];
            let what = format!("{}, aspect ratio {ratio}", scheme.name());
            checks.printed(&format!("H1 of {what}"), ours, h1, 0.5);
            if !jump.is_empty() {
                checks.printed(&format!("jump of {what}"), jump_norm(energy, ours), jump, 0.5);
            }
            energies.push(energy);
        }
        energies
    };
    let none = [""; 4];
    let cr = spread(&NonconformingP1, ["1.62e-1", "1.18e-1", "1.15e-1", "1.15e-1"], none);
    spread(&ConformingP1, ["2.18e-1", "1.59e-1", "1.54e-1", "1.54e-1"], none);
    let proven = spread(&Sipg::default(), ["1.66e-1", "1.19e-1", "1.15e-1", "1.15e-1"], none);
    let heights = spread(
        &Wopsip { weight: WeightRule::Anisotropic, ..wopsip(1.0) },
        ["1.65e-1", "1.20e-1", "1.17e-1", "1.16e-1"],
        [".47", ".34", ".34", ".34"],
    );
    let diameters = spread(
        &wopsip(1.0),
        ["1.63e-1", "1.24e-1", "1.75e-1", "4.59e-1"],
        [".24", ".28", ".52", ".89"],
    );
    // how much the error relative to Crouzeix-Raviart varies
    let variation = |energies: &[f64]| {
        let relative = energies.iter().zip(&cr).map(|(e, c)| e / c);
        let [least, most] = relative.fold([f64::INFINITY, 0.0], |[a, b], r| [a.min(r), b.max(r)]);
        most / least
    };
    let [proven, heights, diameters] = [&proven, &heights, &diameters].map(|e| variation(e));
    checks.that(proven < 1.5, || format!("interior penalty varies by {proven:.2}"));
    checks.that(heights < 1.5, || format!("over-penalty by heights varies by {heights:.2}"));
    checks.that(diameters > 3.0, || format!("over-penalty by diameters varies by {diameters:.2}"));
    checks.finish();
}

/// The default factor, too, is as robust with the weight by heights as without stretching.
#[test]
fn stretched_meshes_with_the_default_factor() {
    let scene = scenes::sines::<2>();
    let robust = Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() };
    let relative: Vec<f64> = [1, 4, 16, 64]
        .map(|r| {
            let mesh = Mesh::<2>::kuhn_box(&scene.domain.bounding_box(), [16, 16 * r]).unwrap();
            let energy = |s: &dyn Scheme<2>| solve(s, &scene.problem, &mesh).error.energy.unwrap();
            energy(&robust) / energy(&NonconformingP1)
        })
        .to_vec();
    let [least, most] =
        relative.iter().fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], &r| [a.min(r), b.max(r)]);
    assert!(most / least < 1.5, "{relative:?}");
}

/// Units of the last printed digit: half of one for rounding, and as much again of the fifth digit
/// as the rule for the singular load may change, which is not quite that of the tables.
const UNITS: f64 = 0.505;

/// Errors over six decades of the factor: the jumps shrink with its root, the rest tends to that
/// of Crouzeix-Raviart elements with bounds at vertices.
#[test]
fn size_of_the_over_penalty() {
    let mut checks = Checks::default();
    let scene = scenes::signorini_2d();
    for (eta, l2, h1, jump) in [
        (1e-2, "2.571e-1", "3.486e-1", "9.789e-1"),
        (1e-1, "3.044e-2", "1.092e-1", "3.494e-1"),
        (1.0, "3.7924e-3", "9.0014e-2", "1.137e-1"),
        (1e1, "1.6385e-3", "8.9789e-2", "3.609e-2"),
        (1e2, "1.5377e-3", "8.9789e-2", "1.141e-2"),
        (1e4, "1.5294e-3", "8.9790e-2", "1.142e-3"),
    ] {
        let (mesh, solved) = solve_as_tables(&scene, &wopsip(eta), 16);
        let converged = solved.outcome == Outcome::Converged;
        checks.that(converged, || format!("eta = {eta}: {}", solved.outcome));
        let [own_h1, energy] = [solved.error.h1, solved.error.energy].map(Option::unwrap);
        let [ours_l2, ours_h1] =
            norms_by_rule(&scene, &mesh, &solved.fields.unwrap().u, DEGREE_OF_TABLES);
        checks.printed(&format!("L2 for eta = {eta}"), ours_l2, l2, UNITS);
        checks.printed(&format!("H1 for eta = {eta}"), ours_h1, h1, UNITS);
        checks.printed(&format!("jump for eta = {eta}"), jump_norm(energy, own_h1), jump, UNITS);
    }
    checks.finish();
}
