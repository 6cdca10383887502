//! Rounding under an over-penalty: the matrix as it is multiplied out, the matrix as the sum it is.

mod support;

use std::f64::consts::PI;
use support::accuracy::{Checks, wopsip};
use unilateral::algebra::Inequality;
use unilateral::assemble::Discretisation;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::scenes::BoxDomain;
use unilateral::solve::{ActiveSet, InequalitySolver, Linear, Outcome, Solution};

/// The unit cube, Dirichlet data but on one side.
fn cube<T: Real, const D: usize>(n: usize) -> Mesh<T, D> {
    Mesh::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), [n; D]).unwrap()
}

fn assemble<T: Real, const D: usize, S: Scheme<T, D>>(
    scheme: &S,
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
) -> Inequality<T> {
    Discretisation::new(scheme, problem, mesh, Default::default()).unwrap().inequality().unwrap()
}

/// The sum is the matrix and the load, in every basis and degree; no other scheme keeps it.
#[test]
fn the_factored_form_is_the_matrix() {
    fn check<const D: usize, S: Scheme<f64, D>>(checks: &mut Checks, scheme: &S) {
        let problem = Problem::new()
            .source(|x: &Point<f64, D>| 1.0 + x[0])
            .dirichlet(|x: &Point<f64, D>| 2.0 - x[0] * x[D - 1])
            .coefficient(|x: &Point<f64, D>| 1.0 + x[0])
            .reaction(3.0);
        let inequality = assemble(scheme, &problem, &cube::<f64, D>(2));
        let factored = inequality.factored.as_ref().unwrap();
        let n = inequality.size();
        let mut assembled = vec![0.0; n];
        let mut kept = vec![0.0; n];
        for seed in 0..3 {
            let u: Vec<f64> = (0..n).map(|i| ((i * 37 + seed * 11) % 17) as f64 / 17.0).collect();
            inequality.matrix.residual_f64(&inequality.load, &u, &mut assembled);
            factored.residual(|i| u[i], &mut kept);
            let largest = assembled.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            let off = assembled.iter().zip(&kept).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            checks.that(off <= 1e-13 * largest, || {
                format!("{}, {D}D: off by {off:.1e} of {largest:.1e}", scheme.name())
            });
        }
    }
    fn dimension<const D: usize>(checks: &mut Checks) {
        check::<D, _>(checks, &wopsip(3.0));
        check::<D, _>(checks, &FacetMeans(wopsip(3.0)));
        check::<D, _>(checks, &wopsip(3.0).on(P2));
        check::<D, _>(checks, &CellMeans(wopsip(3.0).on(P2)));
        let problem = Problem::new();
        let none = assemble(&Sipg::default(), &problem, &cube::<f64, D>(2)).factored;
        checks.that(none.is_none(), || "interior penalty is no sum of jumps".to_owned());
    }
    let mut checks = Checks::default();
    dimension::<1>(&mut checks);
    dimension::<2>(&mut checks);
    dimension::<3>(&mut checks);
    checks.finish();
}

/// Direct solution with the matrix multiplied out (`is_old`), or as the sum it is.
fn solution<T: Real>(inequality: &Inequality<T>, is_old: bool) -> Solution<T> {
    let mut inequality = inequality.clone();
    if is_old {
        inequality.factored = None;
    }
    ActiveSet { linear: Linear::Direct, ..ActiveSet::default() }.solve(&inequality)
}

/// The largest error at nodes for `-u'' = pi^2 sin(pi x)` on `2^level` cells, over-penalty with
/// factor one.
fn sine_on_a_line<T: Real>(level: u32, is_old: bool) -> (Outcome, f64) {
    let problem = Problem::new().source(|x: &Point<f64, 1>| PI * PI * (PI * x[0]).sin());
    let mesh = cube::<T, 1>(1 << level);
    let inequality = assemble(&wopsip(1.0), &problem, &mesh);
    let solution = solution(&inequality, is_old);
    let at = |k: usize| mesh.vertices()[inequality.places[k].vertices()[0] as usize][0].to_f64();
    let error = |k: usize| (solution.values[k].to_f64() - (PI * at(k)).sin()).abs();
    (solution.outcome, (0..inequality.size()).map(error).fold(0.0, f64::max))
}

/// The table of errors on a line: `cargo test --test rounding table -- --ignored --nocapture`.
#[test]
#[ignore = "a table, some seconds"]
fn table_on_a_line() {
    for level in 4..16 {
        let [a, b] = [true, false].map(|old| sine_on_a_line::<f32>(level, old));
        let [c, d] = [true, false].map(|old| sine_on_a_line::<f64>(level, old));
        println!(
            "| 2^{level} | {:.2e} {} | {:.2e} {} | {:.3e} {} | {:.3e} {} |",
            a.1, a.0, b.1, b.0, c.1, c.0, d.1, d.0
        );
    }
}

/// L2 errors for Poisson's equation with the product of sines, over-penalty with factor one.
fn sines<T: Real>(n: usize, eta: f64, is_old: bool) -> (Outcome, f64, f64) {
    let value = |x: &Point<f64, 2>| (PI * x[0]).sin() * (PI * x[1]).sin();
    let gradient = |x: &Point<f64, 2>| {
        let [(s, c), (t, d)] = [(PI * x[0]).sin_cos(), (PI * x[1]).sin_cos()];
        Point::<f64, 2>::new(PI * c * t, PI * s * d)
    };
    let problem = Problem::new().source(move |x| 2.0 * PI * PI * value(x)).exact(value, gradient);
    let mesh = cube::<T, 2>(n);
    let scheme = wopsip(eta);
    let space = Discretisation::new(&scheme, &problem, &mesh, Default::default()).unwrap();
    let inequality = space.inequality().unwrap();
    let clock = std::time::Instant::now();
    let solution = solution(&inequality, is_old);
    let seconds = clock.elapsed().as_secs_f64();
    let error = space.errors(&solution.values).unwrap().l2.unwrap();
    (solution.outcome, error, seconds)
}

/// The table of errors in the plane.
#[test]
#[ignore = "a table, a minute"]
fn table_in_the_plane() {
    for n in [32, 64, 128] {
        for eta in [1.0, 1e4, 1e8] {
            let [a, b] = [true, false].map(|old| sines::<f32>(n, eta, old));
            let [c, d] = [true, false].map(|old| sines::<f64>(n, eta, old));
            print!("| {n} | {eta:e}");
            for (outcome, error, seconds) in [a, b, c, d] {
                print!(" | {error:.3e} {outcome} {seconds:.3}s");
            }
            println!(" |");
        }
    }
}
