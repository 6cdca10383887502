//! Loads that jump or have kinks within cells, and the degree of the rule for smooth ones.

use std::f64::consts::PI;

use crate::support::checks::Checks;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::scheme::scheme_by_name;

fn errors(report: &Report) -> impl Iterator<Item = (usize, f64, f64)> {
    report.rows.iter().map(|row| (row.level, row.error.l2.unwrap(), row.error.h1.unwrap()))
}

/// Figures of an independent program with the exact load, to the digits printed.
#[test]
fn conforming_linears_on_a_load_with_jumps_have_the_errors_of_the_exact_load() {
    const EXACT: [(usize, &str, &str); 4] = [
        (8, "1.250e-2", "2.699e-1"),
        (64, "4.065e-4", "4.255e-2"),
        (256, "2.552e-5", "1.067e-2"),
        (1024, "1.594e-6", "2.679e-3"),
    ];
    let levels = EXACT.map(|row| row.0);
    let study = Study::<1>::new(scenes::icelike_1d()).scheme(ConformingP1).levels(levels);
    let report = study.run().unwrap();
    let mut checks = Checks::default();
    for ((n, l2, h1), exact) in errors(&report).zip(EXACT) {
        assert_eq!(n, exact.0);
        checks.printed(&format!("L2, n = {n}"), l2, exact.1, 1.0);
        checks.printed(&format!("H1, n = {n}"), h1, exact.2, 1.0);
    }
    checks.finish();
}

/// On polynomial-1d with two intervals `u_h = c |x|`, `c = 0.51^2` the Dirichlet value, and the exact solution is
/// `max(x^2 - 0.49, 0)^2`: its kinks are the free boundary and the jump of the derivative of the load at once. Three
/// Gauss points on `(3/4, 1)`, a part of a divided cell, leave 6.7e-7 of the sixth power of `x`.
#[test]
fn errors_see_kinks_at_which_free_boundary_and_load_coincide() {
    let study = Study::<1>::new(scenes::polynomial()).scheme(ConformingP1).levels([2]);
    let report = study.run().unwrap();
    let c = 0.51_f64.powi(2);
    // 16 x^2 (x^2 - 0.49)^2, integrated
    let squared = |x: f64| 16.0 * (x.powi(7) / 7.0 - 0.196 * x.powi(5) + 0.2401 / 3.0 * x.powi(3));
    let exact = (2.0 * (squared(1.0) - squared(0.7) - c * c)).sqrt();
    let (_, _, h1) = errors(&report).next().unwrap();
    assert!((h1 - exact).abs() <= 1e-6 * exact, "{h1} and {exact}");
}

/// The order swings with the place of jumps and free boundary in their cells: over four levels it is
/// three halves, where a rule across the jumps had one.
#[test]
fn quadratics_on_a_load_with_jumps_keep_their_order() {
    let study = Study::<1>::new(scenes::icelike_1d()).scheme(ConformingP2);
    let report = study.levels([16, 32, 64, 128, 256, 512]).run().unwrap();
    let h1: Vec<f64> = errors(&report).map(|row| row.2).collect();
    for four in h1.windows(4) {
        // least squares of log e over equidistant log h
        let log = |k: usize| four[k].log2();
        let order = (3.0 * (log(0) - log(3)) + log(1) - log(2)) / 10.0;
        assert!(order >= 1.4, "{order:.2} of {four:?}");
    }
}

/// The sum of all entries of the load, which is the integral of the source.
fn integral<const D: usize>(scheme: &dyn Scheme<D>, n: usize, load: Datum<D>) -> f64 {
    let domain = BoxDomain::dirichlet(Point::repeat(-1.0), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, [n; D]).unwrap();
    let mut problem = Problem::new();
    problem.source.everywhere = Some(load);
    let discretisation =
        Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default()).unwrap();
    discretisation.load().unwrap().iter().sum()
}

/// One within the sphere of radius 0.7, minus two outside.
fn jump_at_a_sphere<const D: usize>() -> Datum<D> {
    let level = |x: &Point<D>| x.norm_squared() - 0.49;
    Datum::piecewise(move |x| if level(x) > 0.0 { -2.0 } else { 1.0 }, level)
}

/// Planes in pieces of a cell replace the sphere: of order two.
#[test]
fn a_load_that_jumps_at_a_sphere_is_integrated_along_it() {
    let exact = |volume: f64, box_volume: f64| volume - 2.0 * (box_volume - volume);
    let disc = exact(PI * 0.49, 4.0);
    let error = |n| (integral::<2>(&ConformingP1, n, jump_at_a_sphere()) - disc).abs();
    assert!(error(8) < 3e-3 && 12.0 * error(32) < error(8), "{:e} {:e}", error(8), error(32));
    let ball = exact(4.0 / 3.0 * PI * 0.343, 8.0);
    let error = |n| (integral::<3>(&ConformingP2, n, jump_at_a_sphere()) - ball).abs();
    assert!(error(8) < 1e-2 && 5.0 * error(32) < error(8), "{:e} {:e}", error(8), error(32));
}

/// Loads that are smooth within cells, on coarse meshes: with rules of twice the degree no error of
/// linears or quadratics changes by more than one part in a thousand.
#[test]
fn the_rule_for_smooth_loads_limits_no_scheme() {
    fn check<const D: usize>(checks: &mut Checks, n: usize) {
        let scene = scenes::sines::<D>();
        for (name, degree) in [("p1", 5), ("sipg", 5), ("wopsip", 5), ("p2", 7), ("sipg-p2", 7)] {
            let run = |quadrature| {
                let scheme = scheme_by_name::<D>(name, &Default::default()).unwrap();
                let study = Study::<D>::new(scene.clone()).boxed_scheme(scheme).levels([n]);
                let report = study.quadrature(quadrature).run().unwrap();
                errors(&report).map(|(_, l2, h1)| [l2, h1]).next().unwrap()
            };
            let own = run(DataQuadrature::default());
            assert_eq!(own, run(DataQuadrature::default().cell(degree)), "the default of {name}");
            let fine = run(DataQuadrature::default().cell(2 * degree));
            for (norm, own, fine) in [("L2", own[0], fine[0]), ("H1", own[1], fine[1])] {
                let change = (own / fine - 1.0).abs();
                checks.that(change < 1e-3, || format!("{norm} of {name} in {D}D: {change:.1e}"));
            }
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, 4);
    check::<2>(&mut checks, 4);
    check::<3>(&mut checks, 2);
    checks.finish();
}

#[test]
fn cells_that_are_not_cut_keep_their_loads_to_the_bit() {
    let domain = BoxDomain::dirichlet(Point::repeat(-1.0), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [6, 6]).unwrap();
    let smooth = |x: &Point<2>| (x[0] * 3.0).sin() + x[1];
    let load = |problem: &Problem<2>| {
        let quadrature = DataQuadrature::default();
        Discretisation::new(&Sipg::default(), problem, &mesh, quadrature).unwrap().load().unwrap()
    };
    let whole = load(&Problem::new().source(smooth));
    let cut = load(&Problem::new().piecewise_source(smooth, |x| x[0] + x[1] - 0.1));
    let differ = |cell: usize| whole[3 * cell..3 * cell + 3] != cut[3 * cell..3 * cell + 3];
    for cell in 0..mesh.n_cells() {
        let level = |v: &u32| mesh.vertices()[*v as usize].sum() - 0.1;
        let is_cut = mesh.cell(cell).iter().any(|v| level(v) > 0.0)
            && mesh.cell(cell).iter().any(|v| level(v) < 0.0);
        assert_eq!(differ(cell), is_cut, "cell {cell}");
    }
    let largest = whole.iter().zip(&cut).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest < 1e-6, "the load is smooth: {largest:e}");
}

#[test]
fn a_reaction_that_jumps_is_integrated_exactly() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<1>::kuhn_box(&domain, [4]).unwrap();
    let level = |x: &Point<1>| x[0] - 0.3;
    let jump = Datum::piecewise(move |x| if level(x) > 0.0 { 5.0 } else { 1.0 }, level);
    let total = |scheme: &dyn Scheme<1>| {
        let problem = Problem::new().reaction(jump.clone());
        let of = Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default()).unwrap();
        let ones = vec![1.0; of.unknowns()];
        let matrix = of.matrix();
        (0..ones.len()).map(|i| matrix.row_dot(i, &ones)).sum::<f64>()
    };
    // constants have neither gradient nor jumps inside, and the penalty of the boundary is pinned
    assert!((total(&ConformingP1) - (0.3 + 0.7 * 5.0)).abs() < 1e-13);
    assert!((total(&ConformingP2) - (0.3 + 0.7 * 5.0)).abs() < 1e-13);
}

/// The energy norm of the exact solution of contrast-disc-2d, whose gradient jumps by a factor of 1000 across a circle
/// within cells: by the sum over 10 000 parts of each cell, with the level of the coefficient named and not.
#[test]
fn errors_see_jumps_of_a_coefficient_within_cells() {
    const PARTS: usize = 100;
    let scene = || scenes::contrast_disc_2d(1000.0);
    let problem = scene().problem;
    let mesh: Mesh<2> = scene().domain.mesh(16).unwrap();
    let exact = problem.exact.clone().unwrap();
    let alpha = |x: &Point<2>| if x.norm() < 1.0 { 1000.0 } else { 1.0 };
    let mut expected = 0.0;
    for cell in 0..mesh.n_cells() {
        let corners = [0, 1, 2].map(|k| mesh.vertices()[mesh.cell(cell)[k] as usize]);
        let at = |a: f64, b: f64| {
            corners[0] + (corners[1] - corners[0]) * a + (corners[2] - corners[0]) * b
        };
        let area = 0.5 * (corners[1] - corners[0]).perp(&(corners[2] - corners[0])).abs();
        let (mut sum, n) = (0.0, PARTS as f64);
        for i in 0..PARTS {
            for j in 0..PARTS - i {
                // the barycentres of the two parts of a small parallelogram
                let shifts =
                    if i + j + 1 < PARTS { &[1.0 / 3.0, 2.0 / 3.0][..] } else { &[1.0 / 3.0] };
                for shift in shifts {
                    let x = at((i as f64 + shift) / n, (j as f64 + shift) / n);
                    sum += (exact.gradient)(&x).norm_squared();
                }
            }
        }
        expected += alpha(&at(1.0 / 3.0, 1.0 / 3.0)) * area * sum / (n * n);
    }
    let mut unnamed = scene().problem;
    unnamed.coefficient = Datum::from(alpha).into();
    for (problem, tolerance) in [(problem, 2e-3), (unnamed, 0.2)] {
        let quadrature = DataQuadrature::default();
        let space = Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap();
        let error = space.errors(&vec![0.0; space.unknowns()]).unwrap();
        let relative = error.broken_energy.unwrap() / expected.sqrt() - 1.0;
        assert!(relative.abs() < tolerance, "{relative:.1e}");
    }
}
