//! Figures that are rounding errors have no orders.

use unilateral::element::P2;
use unilateral::inequality::{ActiveSet, Outcome, in_precision};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// Schemes whose spaces contain the linear functions, and solve them exactly.
const EXACT: [&str; 8] = ["p1", "p2", "cr", "sipg", "nipg", "ldg", "br2", "sipg-p2"];

fn rows<const D: usize>(
    precision: Precision,
    scene: Scene<D>,
    schemes: &[&str],
    levels: &[usize],
) -> Vec<Row> {
    let study = Study::<D>::new(scene).levels(levels.iter().copied());
    let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
    let add = |study: Study<'static, D>, name: &&str| study.named_scheme(&name.parse().unwrap());
    let rows = schemes.iter().fold(study, add).run().unwrap().rows;
    assert!(rows.iter().all(|row| row.status == Outcome::Converged));
    rows
}

fn linear<const D: usize>() -> Scene<D> {
    let gradient: Point<D> = Point::from_fn(|k, _| 2.0 - k as f64);
    let problem = Problem::new().exact(move |x| 1.0 + gradient.dot(x), move |_| gradient);
    Scene::new("linear", BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), problem)
}

/// Errors that differ by chance from level to level.
#[test]
fn a_function_of_the_space_has_no_orders() {
    fn check<const D: usize>(precision: Precision, levels: &[usize]) {
        for row in rows::<D>(precision, linear(), &EXACT, levels) {
            let what = format!("{precision:?} {D}D, {} {}: {row:?}", row.label, row.level);
            assert_eq!(row.order, Default::default(), "{what}");
            assert_eq!(row.bound.effectivity, None, "{what}");
        }
    }
    check::<1>(Precision::Double, &[16, 64, 256]);
    check::<2>(Precision::Double, &[4, 8, 16]);
    check::<3>(Precision::Double, &[2, 4]);
    check::<1>(Precision::Single, &[16, 64]);
    check::<2>(Precision::Single, &[4, 8, 16]);
}

/// The membrane lies on its obstacle: values, energies and errors are zero but for rounding.
#[test]
fn a_solution_that_vanishes_has_no_orders() {
    let problem = Problem::new().constant_source(-1.0).obstacle_below(|_| 0.0);
    let problem = problem.exact(|_| 0.0, |_| Point::zeros());
    let square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    let scene = Scene::new("zero", square, problem);
    let schemes = ["p1", "p2", "cr", "sipg", "sipg-p2", "wopsip", "wopsip-p2"];
    for row in rows::<2>(Precision::Double, scene, &schemes, &[4, 8, 16]) {
        let of = row.order;
        assert_eq!([of.l2, of.h1, of.energy, of.max], [None; 4], "{}: {row:?}", row.label);
    }
}

/// What is no noise keeps its order, in both precisions.
#[test]
fn errors_above_rounding_keep_their_orders() {
    let schemes = ["p1", "sipg", "wopsip"];
    let double = rows::<1>(Precision::Double, scenes::parabola_1d(), &schemes, &[64, 1024]);
    let single = rows::<2>(Precision::Single, scenes::radial(1.0), &schemes, &[16, 32]);
    for row in [double, single].concat().iter().skip(1).step_by(2) {
        let of = row.order;
        let all = [of.l2, of.h1, of.energy, of.bound, of.multiplier_l1];
        assert!(all.iter().all(Option::is_some), "{}: {row:?}", row.label);
    }
}

/// Limits of energies and forces: none of figures that are rounding, no order of differences that are.
#[test]
fn noise_is_not_extrapolated() {
    let study = |problem| {
        let square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
        let study = Study::<2>::new(Scene::new("membrane", square, problem));
        let schemes = ["sipg", "wopsip-p2"].map(|name| name.parse().unwrap());
        let study = schemes.iter().fold(study, |study, scheme| study.named_scheme(scheme));
        study.levels([4, 8, 16]).run().unwrap()
    };
    let on_obstacle = Problem::new().constant_source(-1.0).obstacle_below(|_| 0.0);
    for of in study(on_obstacle).extrapolated() {
        assert_eq!(of.energy, None, "{of:?}");
    }
    let mut report = study(Problem::new().constant_source(-1.0));
    let [a, b, c] = [0, 1, 2].map(|k: usize| report.rows[k].energy.unwrap());
    assert!(report.extrapolated()[0].energy.is_some_and(|limit| limit.order > Some(1.5)));
    // the same differences, as rounding of a thousand times the energy
    for row in &mut report.rows {
        let rounding = row.rounding.as_mut().unwrap();
        rounding.energy = 2.0 * (a - b).abs().max((b - c).abs());
    }
    let limit = report.extrapolated()[0].energy.unwrap();
    assert_eq!((limit.value, limit.order), (c, None));
}

/// What single precision changes in figures of quadratics is no more than the rounding that their rows state.
#[test]
fn single_precision_changes_quadratics_by_rounding() {
    let schemes = ["p2", "sipg-p2", "ldg-p2"];
    let of = |precision| rows::<2>(precision, scenes::hertz_2d(), &schemes, &[16]);
    let (single, double) = (of(Precision::Single), of(Precision::Double));
    for (single, double) in single.iter().zip(&double) {
        let rounding = single.rounding.clone().unwrap();
        let (a, b, most) = (single.error.clone(), double.error.clone(), rounding.error);
        let figures = [
            ("L2", a.l2, b.l2, most.l2),
            ("H1", a.h1, b.h1, most.h1),
            ("energy norm", a.energy, b.energy, most.energy),
            ("energy", single.energy, double.energy, Some(rounding.energy)),
            ("resultant", single.resultant, double.resultant, Some(rounding.force)),
        ];
        for (name, a, b, most) in figures {
            let Some(((a, b), most)) = a.zip(b).zip(most) else { continue };
            let what = format!("{} {}, {name}", single.label, single.level);
            assert!((a - b).abs() <= most, "{what}: {a:e} for {b:e}, rounding {most:e}");
        }
    }
}

/// What a row in single precision states of its distance from the discrete solution holds.
#[test]
fn algebraic_bounds_of_quadratics_hold_in_single_precision() {
    let scene = scenes::signorini_2d();
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, 16).unwrap();
    for scheme in [&ConformingP2 as &dyn Scheme<2>, &Sipg::default().on(P2)] {
        let solved = |precision| {
            let solver = in_precision(precision, ActiveSet::default());
            let nested = NestedIteration::new(&scene.problem, &meshes);
            nested.shared_solver(solver.into()).solve(scheme).unwrap()
        };
        let [exact, rounded] = [Precision::Double, Precision::Single].map(solved);
        let matrix = &exact.inequality().matrix;
        let norm = |u: &[f64]| {
            let terms = (0..u.len()).map(|i| u[i] * matrix.row_dot_f64(i, u));
            terms.sum::<f64>().sqrt()
        };
        let pairs = exact.values().iter().zip(rounded.values());
        let apart: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
        let distance = norm(&apart) / norm(exact.values());
        let stated = rounded.certificate().algebraic_bound.unwrap();
        let what = format!("{}: {distance:e}, stated {stated:e}", scheme.name());
        assert!(rounded.converged() && distance <= stated && stated < 1e-2, "{what}");
    }
}

/// The formulas of [`Rounding`](unilateral::measure::Rounding), written a second time for linears in the plane with a
/// load and without Dirichlet data but zero: `a` is eight roundings.
#[test]
fn rounding_errors_are_those_of_the_formulas() {
    let square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(2.0));
    let problem = Problem::new().constant_source(-3.0).obstacle_below(|_| -0.1).dirichlet(|_| 0.0);
    let problem = problem.exact(|_| 0.0, |_| Point::zeros());
    let mesh = Mesh::<2>::kuhn_box(&square, [6, 6]).unwrap();
    let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
    let (inequality, u) = (solved.inequality(), &solved.solution().values);
    let scene = Scene::new("load", square, problem.clone());
    let row = &rows::<2>(Precision::Double, scene, &["p1"], &[6])[0];
    let found = row.rounding.as_ref().unwrap();
    let diagonal: Vec<f64> = (0..u.len()).map(|i| inequality.matrix.get(i, i)).collect();
    let load: f64 = inequality.load.iter().map(|c| c.abs()).sum();
    let squares: f64 = inequality.load.iter().zip(&diagonal).map(|(c, k)| c * c / k).sum();
    let n = (mesh.n_cells() as f64).sqrt();
    let largest = u.iter().fold(0.0_f64, |a, u| a.max(u.abs())).max(n * n * squares / load);
    let a = 8.0 * f64::EPSILON;
    let max = a * n * largest / 16.0;
    let length = 8.0_f64.sqrt();
    let sum: f64 = diagonal.iter().sum();
    let sum_of_squares: f64 = diagonal.iter().map(|k| k * k).sum();
    let broken = a * largest * sum.sqrt();
    let norm = row.error.broken_energy.unwrap();
    for (name, found, expected) in [
        ("max", found.error.max.unwrap(), max),
        ("L2", found.error.l2.unwrap(), max * length),
        ("H1", found.error.h1.unwrap(), 16.0 * max),
        ("broken energy", found.error.broken_energy.unwrap(), broken),
        ("force", found.force, a * (largest * sum_of_squares.sqrt() + load) / 8.0),
        ("energy", found.energy, a * (norm * norm + largest * load)),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-9, "{name}: {found:e} for {expected:e}");
    }
}
