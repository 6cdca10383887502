//! Rounding under an over-penalty: the matrix as it is multiplied out, the matrix as the sum it is.

use crate::runs::{own_scene, solve, solve_in};
use crate::support::checks::Checks;
use crate::support::scheme_lists::entry;
use crate::support::schemes::wopsip;
use std::f64::consts::PI;
use unilateral::algebra::Inequality;
use unilateral::assemble::Discretisation;
use unilateral::inequality::{ActiveSet, Outcome, Solution, in_precision};
use unilateral::linear::LinearMethod;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::real::Precision;
use unilateral::scenes::Scene;

/// The unit cube, Dirichlet data but on one side.
fn cube<const D: usize>(n: usize) -> Mesh<D> {
    Mesh::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), [n; D]).unwrap()
}

fn assemble<const D: usize, S: Scheme<D>>(
    scheme: &S,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Inequality<f64> {
    Discretisation::new(scheme, problem, mesh, Default::default()).unwrap().inequality().unwrap()
}

/// The sum is the matrix and the load, in every basis and degree; no other scheme keeps it.
#[test]
fn the_penalised_form_is_the_matrix() {
    fn check<const D: usize, S: Scheme<D>>(
        checks: &mut Checks,
        scheme: &S,
        set: impl ConstraintSet + 'static,
    ) {
        let problem = Problem::new()
            .source(|x: &Point<D>| 1.0 + x[0])
            .dirichlet(|x: &Point<D>| 2.0 - x[0] * x[D - 1])
            .coefficient(|x: &Point<D>| 1.0 + x[0])
            .reaction(3.0)
            .on(set);
        let inequality = assemble(scheme, &problem, &cube::<D>(2));
        let penalised = inequality.penalised.as_ref().unwrap();
        let n = inequality.size();
        let mut assembled = vec![0.0; n];
        let mut kept = vec![0.0; n];
        for seed in 0..3 {
            let u: Vec<f64> = (0..n).map(|i| ((i * 37 + seed * 11) % 17) as f64 / 17.0).collect();
            let load = inequality.assembled_load();
            inequality.matrix.residual_f64(&load, &u, &mut assembled);
            penalised.residual(&inequality.load, |i| u[i], &mut kept);
            let largest = assembled.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            let off = assembled.iter().zip(&kept).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            checks.that(off <= 1e-13 * largest, || {
                format!("{}, {D}D: off by {off:.1e} of {largest:.1e}", scheme.name())
            });
        }
    }
    fn dimension<const D: usize>(checks: &mut Checks) {
        check::<D, _>(checks, &wopsip(3.0), Nodes);
        check::<D, _>(checks, &wopsip(3.0), FacetMeans);
        check::<D, _>(checks, &wopsip(3.0).on(P2), Nodes);
        check::<D, _>(checks, &wopsip(3.0).on(P2), Bernstein);
        let problem = Problem::new();
        let none = assemble(&Sipg::default(), &problem, &cube::<D>(2)).penalised;
        checks.that(none.is_none(), || "interior penalty is no sum of jumps".to_owned());
    }
    let mut checks = Checks::default();
    dimension::<1>(&mut checks);
    dimension::<2>(&mut checks);
    dimension::<3>(&mut checks);
    checks.finish();
}

/// Facet means that are coupled by means of jumps: the row of a facet has the entries of its cell and one of the
/// cell across.
#[test]
fn rows_of_facet_means_have_one_entry_of_another_cell() {
    fn check<const D: usize>(checks: &mut Checks) {
        let mesh = cube::<D>(2);
        let inequality = assemble(&wopsip(3.0), &Problem::new().on(FacetMeans), &mesh);
        let means = |i: usize| inequality.locations[i].vertices().to_vec();
        let mut across = 0;
        for i in 0..inequality.size() {
            let (columns, _) = inequality.matrix.row(i);
            checks
                .that(columns.is_sorted_by(|a, b| a < b), || format!("{D}D: row {i} is unordered"));
            let is_own = |&&j: &&u32| j as usize / (D + 1) == i / (D + 1);
            checks
                .that(columns.iter().filter(is_own).count() == D + 1, || format!("{D}D: row {i}"));
            for &j in columns.iter().filter(|j| !is_own(j)) {
                across += 1;
                let (mut mine, mut theirs) = (means(i), means(j as usize));
                mine.sort_unstable();
                theirs.sort_unstable();
                checks.that(mine == theirs, || format!("{D}D: {i} and {j} are on two facets"));
            }
        }
        let boundary = 2 * D * (1 << (D - 1)) * (1..D).product::<usize>();
        let interior_sides = mesh.n_cells() * (D + 1) - boundary;
        checks.that(across == interior_sides, || format!("{D}D: {across} of {interior_sides}"));
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks);
    check::<2>(&mut checks);
    check::<3>(&mut checks);
    checks.finish();
}

/// Direct solution with the matrix multiplied out (`is_old`), or as the sum it is.
fn solution(precision: Precision, inequality: &Inequality<f64>, is_old: bool) -> Solution<f64> {
    let mut inequality = inequality.clone();
    if is_old {
        inequality.load = inequality.assembled_load().into_owned();
        inequality.penalised = None;
    }
    in_precision(precision, ActiveSet::default().linear(LinearMethod::Direct)).solve(&inequality)
}

/// The largest error at nodes for `-u'' = pi^2 sin(pi x)` on `2^level` cells, over-penalty with
/// factor one.
fn sine_on_a_line(precision: Precision, level: u32, is_old: bool) -> (Outcome, f64) {
    let problem = Problem::new().source(|x: &Point<1>| PI * PI * (PI * x[0]).sin());
    let mesh = cube::<1>(1 << level);
    let inequality = assemble(&wopsip(1.0), &problem, &mesh);
    let solution = solution(precision, &inequality, is_old);
    let at = |k: usize| mesh.vertices()[inequality.locations[k].vertices()[0] as usize][0];
    let error = |k: usize| (solution.values[k] - (PI * at(k)).sin()).abs();
    (solution.outcome, (0..inequality.size()).map(error).fold(0.0, f64::max))
}

/// On a line the error falls like `h^2` down to the root of the rounding unit, in both precisions, where
/// the matrix multiplied out loses all digits.
#[test]
fn errors_on_a_line_fall_to_the_root_of_rounding() {
    let mut checks = Checks::default();
    let mut check = |what: &str, level: u32, (outcome, error): (Outcome, f64)| {
        checks.that(outcome == Outcome::Converged, || format!("{what}, {level}: {outcome}"));
        // the penalty opens gaps of h^2 pi / eta; what is left is smaller
        let due = 1.2 * 0.25_f64.powi(level as i32);
        checks.that(error <= due, || format!("{what}, 2^{level}: {error:.3e} above {due:.3e}"));
    };
    for level in 4..16 {
        check("f64", level, sine_on_a_line(Precision::Double, level, false));
    }
    for level in 4..12 {
        check("f32", level, sine_on_a_line(Precision::Single, level, false));
    }
    // where single precision has no digits left, nothing is called a solution
    for level in 14..16 {
        let (outcome, error) = sine_on_a_line(Precision::Single, level, false);
        let is_told = outcome != Outcome::Converged;
        checks.that(is_told, || format!("f32, 2^{level}: {outcome}, {error:.1e}"));
    }
    let double = Precision::Double;
    let old = sine_on_a_line(double, 12, true).1 / sine_on_a_line(double, 12, false).1;
    checks.that(old > 100.0, || format!("multiplied out only {old:.1} times worse"));
    checks.finish();
}

/// The solution at vertices and the L2 error, `None` if it did not converge.
fn solved<const D: usize>(
    precision: Precision,
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Result<(Vec<f64>, f64), String> {
    let solved = solve_in(precision, scheme, problem, mesh);
    let certificate = solved.certificate.largest();
    match solved.outcome {
        Outcome::Converged if certificate <= precision.certificate_limit() => {
            Ok((solved.fields.unwrap().u, solved.error.l2.unwrap()))
        }
        outcome => Err(format!("{outcome}, certificate {certificate:.1e}")),
    }
}

/// Solves in `f64` in two units of force, in which everything is rounded otherwise, and in `f32`:
/// the largest difference over the root mean square of the error, in both precisions.
fn rounding_over_error<const D: usize>(
    (scheme, is_in_single): (&dyn Scheme<D>, bool),
    scene: &Scene<D>,
    in_thirds: &Scene<D>,
    level: usize,
) -> Result<[f64; 2], String> {
    let mesh = scene.domain.mesh(level).unwrap();
    let (u, error) = solved(Precision::Double, scheme, &scene.problem, &mesh)?;
    let (v, _) = solved(Precision::Double, scheme, &in_thirds.problem, &mesh)?;
    let bounds = scene.domain.bounding_box();
    let volume: f64 = (0..D).map(|k| bounds.upper[k] - bounds.lower[k]).product();
    let over_error = |v: &[f64]| {
        let off = u.iter().zip(v).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        off * volume.sqrt() / error
    };
    let single = match is_in_single {
        true => over_error(&solved(Precision::Single, scheme, &scene.problem, &mesh)?.0),
        false => 0.0,
    };
    Ok([over_error(&v), single])
}

/// Factors over ten decades.
const FACTORS: [f64; 6] = [1e-2, 1.0, 1e2, 1e4, 1e6, 1e8];

/// Rounding stays below one hundredth of the discretisation error for all factors: Poisson's
/// equation in both precisions, in every basis and degree.
#[test]
fn rounding_is_small_for_every_factor() {
    let mut checks = Checks::default();
    let in_units = [sines_in_units(1.0), sines_in_units(3.0)];
    let on_means = in_units.clone().map(|mut scene| {
        scene.problem = scene.problem.on(FacetMeans);
        scene
    });
    for eta in FACTORS {
        let w = wopsip(eta);
        type Pair<'s> = (&'s dyn Scheme<2>, bool);
        let p2 = w.on(P2);
        let pairs: [(Pair<'_>, &[Scene<2>; 2], usize); 3] = [
            ((&w, true), &in_units, 32),
            ((&w, true), &on_means, 32),
            ((&p2, false), &in_units, 8),
        ];
        for (pair, [one, thirds], level) in pairs {
            let what = format!("{}, eta = {eta:e}", pair.0.name());
            match rounding_over_error(pair, one, thirds, level) {
                Ok(off) => checks.that(off.iter().all(|&x| x <= 0.01), || {
                    format!("{what}: {off:?} of the error is rounding")
                }),
                Err(why) => checks.that(false, || format!("{what}: {why}")),
            }
        }
    }
    checks.finish();
}

/// The same under an obstacle, with bounds on vertices and on facet means.
#[test]
fn rounding_is_small_under_an_obstacle() {
    let mut checks = Checks::default();
    let thirds = |mut scene: Scene<2>| {
        scene.problem = scene.problem.coefficient(|_| 3.0);
        scene.problem.source = Datum::Constant(-6.0).into();
        scene
    };
    let radial = || scenes::radial::<2>(1.0);
    for eta in FACTORS {
        for entry in [entry(wopsip(eta), Nodes), entry(wopsip(eta), FacetMeans)] {
            let what = format!("{} ({}), eta = {eta:e}", entry.name(), entry.constraint());
            let [one, thirds] = [radial(), thirds(radial())].map(|mut scene| {
                scene.problem = entry.constrain(&scene.problem);
                scene
            });
            match rounding_over_error((&*entry, false), &one, &thirds, 16) {
                Ok([off, _]) => checks.that(off <= 0.01, || format!("{what}: {off:.1e}")),
                Err(why) => checks.that(false, || format!("{what}: {why}")),
            }
        }
    }
    checks.finish();
}

/// The mesh of a scene with every coordinate drawn to zero by a power.
fn graded(scene: &Scene<2>, level: usize, power: i32) -> Mesh<2> {
    let mesh = scene.domain.mesh(level).unwrap();
    let vertices = mesh.vertices().iter().map(|x| x.map(|t| t.signum() * t.abs().powi(power)));
    let boundary: Vec<TaggedFacet<2>> = mesh
        .boundary()
        .iter()
        .map(|f| {
            let mut ends = mesh.facet_vertices(f.cell as usize, f.local as usize);
            let vertices = [ends.next().unwrap(), ends.next().unwrap()];
            TaggedFacet { vertices, condition: f.condition }
        })
        .collect();
    Mesh::new(vertices.collect(), mesh.cells().to_vec(), &boundary).unwrap()
}

/// On meshes graded to `1e-6` and `1e-12` of the domain the H1 error is at most twice that of
/// Crouzeix-Raviart elements.
#[test]
fn graded_meshes() {
    let mut checks = Checks::default();
    for (scene, level) in [(scenes::signorini_2d(), 32), (sines_in_units(1.0), 32)] {
        for power in [1, 2, 4, 8] {
            let mesh = graded(&scene, level, power);
            let cr = solve(&NonconformingP1, &scene.problem, &mesh).error;
            for scheme in [wopsip(1.0), Wopsip::default()] {
                let ours = solve(&scheme, &scene.problem, &mesh);
                let what = format!("{}, power {power}, {:?}", scene.name, scheme.eta);
                let converged = ours.outcome == Outcome::Converged;
                checks.that(converged, || format!("{what}: {}", ours.outcome));
                let [ours, cr] = [ours.error.h1, cr.h1].map(|e| e.unwrap_or(f64::NAN));
                checks.that(ours <= 2.0 * cr, || {
                    format!("{what}: {ours:.3e}, Crouzeix-Raviart {cr:.3e}")
                });
            }
        }
    }
    checks.finish();
}

/// The table of errors on a line:
/// `cargo test --test discretisation rounding::table -- --ignored --nocapture`.
#[test]
#[ignore = "a table, some seconds"]
fn table_on_a_line() {
    for level in 4..16 {
        let [a, b] = [true, false].map(|old| sine_on_a_line(Precision::Single, level, old));
        let [c, d] = [true, false].map(|old| sine_on_a_line(Precision::Double, level, old));
        println!(
            "| 2^{level} | {:.2e} {} | {:.2e} {} | {:.3e} {} | {:.3e} {} |",
            a.1, a.0, b.1, b.0, c.1, c.0, d.1, d.0
        );
    }
}

/// Poisson's equation with the product of sines on the unit square, forces in some unit.
fn sines_in_units(unit: f64) -> Scene<2> {
    let value = |x: &Point<2>| (PI * x[0]).sin() * (PI * x[1]).sin();
    let gradient = |x: &Point<2>| {
        let [(s, c), (t, d)] = [(PI * x[0]).sin_cos(), (PI * x[1]).sin_cos()];
        Point::<2>::new(PI * c * t, PI * s * d)
    };
    let problem = Problem::new()
        .coefficient(move |_| unit)
        .source(move |x| 2.0 * PI * PI * unit * value(x))
        .exact(value, gradient);
    own_scene("sines", BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), problem)
}

/// Outcome, L2 error and seconds for it.
fn sines(precision: Precision, n: usize, eta: f64, is_old: bool) -> (Outcome, f64, f64) {
    let problem = sines_in_units(1.0).problem;
    let mesh = cube::<2>(n);
    let scheme = wopsip(eta);
    let space = Discretisation::new(&scheme, &problem, &mesh, Default::default()).unwrap();
    let inequality = space.inequality().unwrap();
    let clock = std::time::Instant::now();
    let solution = solution(precision, &inequality, is_old);
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
            let [a, b] = [true, false].map(|old| sines(Precision::Single, n, eta, old));
            let [c, d] = [true, false].map(|old| sines(Precision::Double, n, eta, old));
            print!("| {n} | {eta:e}");
            for (outcome, error, seconds) in [a, b, c, d] {
                print!(" | {error:.3e} {outcome} {seconds:.3}s");
            }
            println!(" |");
        }
    }
}

/// The table of errors under an obstacle, with the seconds that the solution takes.
#[test]
#[ignore = "a table, a minute"]
fn table_under_an_obstacle() {
    let scene = scenes::radial::<2>(1.0);
    for n in [16, 32, 64, 128] {
        for eta in [1.0, 1e4, 1e8] {
            let mesh = scene.domain.mesh(n).unwrap();
            let problem = scene.problem.clone().on(FacetMeans);
            let space =
                Discretisation::new(&wopsip(eta), &problem, &mesh, Default::default()).unwrap();
            let clock = std::time::Instant::now();
            let inequality = space.inequality().unwrap();
            print!("| {n} | {eta:e} | {:.3}s", clock.elapsed().as_secs_f64());
            for is_old in [true, false] {
                let clock = std::time::Instant::now();
                let found = solution(Precision::Double, &inequality, is_old);
                let seconds = clock.elapsed().as_secs_f64();
                let error = space.errors(&found.values).unwrap().l2.unwrap();
                print!(" | {error:.3e} {} {} {seconds:.3}s", found.outcome, found.outer);
            }
            println!(" |");
        }
    }
}
