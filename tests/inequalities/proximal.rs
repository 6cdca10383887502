//! The proximal point method: counts of linear systems from a cold start, the solutions of the other solvers, and what
//! it says where it stalls.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use crate::problems::*;
use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::DataQuadrature;
use unilateral::in_its_dimension;
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid, Outcome, ProximalPoint, SOLVERS,
    SinglePrecision, Solution, certify, solver_by_name,
};
use unilateral::linear::LinearMethod;
use unilateral::nested::NestedIteration;
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::{AnyScene, Parameters, Scene};

/// Largest number of linear systems of a run.
const MAX_SYSTEMS: usize = 60;

const SCENES: [&str; 12] = [
    "radial-2d",
    "ball-2d",
    "torsion-2d",
    "lshape-2d",
    "cone-2d",
    "biactive-half-2d",
    "biactive-ring-2d",
    "degenerate2-2d",
    "degenerate4-2d",
    "signorini-2d",
    "signorini-smooth3-2d",
    "signorini-biactive-2d",
];

const SCHEMES: [&str; 6] = ["p1", "cr", "sipg", "p2", "wopsip:facet-means", "wopsip"];

/// The scene of a name, or the example of a problem file.
fn scene(name: &str) -> AnyScene {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems");
    match name.ends_with(".toml") {
        true => unilateral::problem_file::read(&examples.join(name)).unwrap().scene,
        false => scenes::by_name(name).unwrap().make(&Parameters::default()).unwrap(),
    }
}

fn problem_for<const D: usize>(scene: &Scene<D>, scheme: &NamedScheme) -> Problem<D> {
    let mut problem = scene.problem.clone();
    problem.constraint_set = scheme.constraint_set().or(problem.constraint_set);
    problem
}

/// The inequality of a scheme on a level of a scene, without a start.
pub fn inequality_of(name: &str, scheme: &str, level: usize) -> Inequality<f64> {
    let scheme: NamedScheme = scheme.parse().unwrap();
    in_its_dimension!(&scene(name), |scene| {
        let mesh = scene.domain.mesh(level).unwrap();
        let problem = problem_for(scene, &scheme);
        scheme.make().inequality(&problem, &mesh, DataQuadrature::default()).unwrap()
    })
}

fn solved(inequality: &Inequality<f64>, what: &str) -> Solution<f64> {
    let solution = ProximalPoint.solve(inequality);
    assert_eq!(solution.outcome, Outcome::Converged, "{what} after {} systems", solution.outer);
    solution
}

/// The counts of a prototype, which are independent of the mesh where gap and multiplier do not vanish together.
#[test]
fn cold_starts_take_the_expected_numbers_of_systems() {
    for (name, scheme, level, count) in [
        ("radial-2d", "p1", 16, 9),
        ("radial-2d", "p1", 32, 9),
        ("radial-2d", "p1", 64, 9),
        ("radial-2d", "p1", 128, 11),
        ("signorini-2d", "p1", 16, 10),
        ("signorini-2d", "p1", 32, 10),
        ("signorini-2d", "p1", 64, 11),
        ("signorini-2d", "p1", 128, 12),
        ("radial-3d", "p1", 8, 9),
        ("radial-3d", "cr", 8, 9),
        ("radial-3d", "sipg", 8, 10),
        ("radial-3d", "wopsip", 8, 12),
        ("radial-3d", "wopsip:facet-means", 8, 9),
        ("biactive-ring-2d", "p1", 32, 10),
        ("ball-2d", "wopsip", 32, 15),
        ("ball-2d", "wopsip:facet-means", 32, 9),
        ("ball-2d", "p2", 32, 11),
        ("bilateral-1d", "p1", 1024, 11),
        ("membrane.toml", "p1", 3, 9),
        ("membrane.toml", "p2", 3, 14),
        ("membrane.toml", "wopsip", 3, 20),
    ] {
        let what = format!("{name}, {scheme}, {level}");
        let found = solved(&inequality_of(name, scheme, level), &what).outer;
        assert!(found.abs_diff(count) <= 2, "{what}: {found} systems, expected {count}");
    }
}

/// The energies agree to more digits than the values, whose certificates are below 1e-9.
#[test]
fn energies_are_those_of_the_other_solvers() {
    for name in SCENES {
        for scheme in SCHEMES {
            let what = format!("{name}, {scheme}");
            let inequality = inequality_of(name, scheme, 16);
            let energy = inequality.objective(&solved(&inequality, &what).values);
            for other in [&ActiveSet::default() as &dyn InequalitySolver<f64>, &InteriorPoint] {
                let solution = other.solve(&inequality);
                assert_eq!(solution.outcome, Outcome::Converged, "{what}: {}", other.name());
                let difference = (energy - inequality.objective(&solution.values)).abs();
                assert!(difference < 1e-11 * energy.abs(), "{what}: {difference:e} of {energy:e}");
            }
        }
    }
}

/// The string pressed onto a lower bound, the same turned upside down, and between two bounds of which it reaches one.
#[test]
fn lower_upper_and_both_bounds_are_symmetric() {
    let n = 60;
    let with = |force: f64, bound: Bound<f64>| {
        inequality(laplacian(n, 1, 2.0), &vec![force / (n * n) as f64; n], vec![bound; n])
    };
    let lower = solved(&with(-8.0, Bound::Lower(-0.5)), "lower");
    let upper = solved(&with(8.0, Bound::Upper(0.5)), "upper");
    assert_eq!(lower.outer, upper.outer);
    let turned: Vec<f64> = upper.values.iter().map(|u| -u).collect();
    assert_eq!(lower.values, turned);
    for (force, bounds) in [(-8.0, Bound::Both(-0.5, 3.0)), (8.0, Bound::Both(-3.0, 0.5))] {
        let both = solved(&with(force, bounds), "both");
        let expected = if force < 0.0 { &lower.values } else { &upper.values };
        assert!(distance(&both.values, expected) < 1e-9);
        assert!(both.outer <= lower.outer + 3, "{} and {}", both.outer, lower.outer);
    }
}

/// Strings of which a half is pressed onto an upper bound and a half onto a lower one: each system is that of a Newton
/// step, with the slope of the value between both bounds.
#[test]
fn steps_between_two_bounds_are_newton_steps() {
    let n = 20;
    let mut total = 0;
    for (width, waves) in [(0.1, 1.0), (0.02, 1.0), (0.02, 3.0), (0.005, 1.0), (0.005, 3.0)] {
        let place = |i: usize| 2.0 * PI * waves * (i + 1) as f64 / (n + 1) as f64;
        let load: Vec<f64> = (0..n).map(|i| 0.02 * place(i).sin()).collect();
        let bounds = vec![Bound::Both(-width, width); n];
        total += solved(&inequality(laplacian(n, 1, 2.0), &load, bounds), "two bounds").outer;
    }
    assert!(total <= 44, "{total} systems");
}

#[test]
fn bounds_of_all_kinds_are_taken_with_and_without_symmetry() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let n = 6 + seed as usize;
        let load: Vec<f64> = (0..n).map(|_| n as f64 * random.signed()).collect();
        let dominant = random_dominant(n, &mut random);
        let symmetric = |i: usize, j: usize| 0.5 * (dominant[i][j] + dominant[j][i]);
        let part = (0..n).map(|i| {
            let shift = |j| if i == j { 2.0 * n as f64 } else { 0.0 };
            (0..n).map(|j| symmetric(i, j) + shift(j)).collect::<Vec<f64>>()
        });
        let bounds = random_bounds(n, &mut random);
        let mut problem = inequality(sparse(&part.collect::<Vec<_>>()), &load, bounds);
        for matrix in [None, Some(sparse(&dominant))] {
            if let Some(matrix) = matrix {
                (problem.matrix, problem.symmetric) = (matrix, false);
            }
            let solution = ProximalPoint.solve(&problem);
            let expected = ActiveSet::default().solve(&problem);
            assert_eq!(solution.outcome, expected.outcome, "seed {seed}");
            if expected.outcome == Outcome::Converged {
                let off = distance(&solution.values, &expected.values);
                assert!(off < 1e-8, "seed {seed}: {off:e}");
            }
        }
    }
}

#[test]
fn data_times_a_thousand_change_nothing() {
    const FACTOR: f64 = 1000.0;
    for name in ["radial-2d", "signorini-biactive-2d", "bilateral-1d"] {
        for scheme in SCHEMES {
            let what = format!("{name}, {scheme}");
            let mut inequality = inequality_of(name, scheme, 16);
            let before = solved(&inequality, &what);
            inequality.load.iter_mut().for_each(|load| *load *= FACTOR);
            for bound in &mut inequality.bounds {
                *bound = match *bound {
                    Bound::Free => Bound::Free,
                    Bound::Fixed(x) => Bound::Fixed(FACTOR * x),
                    Bound::Lower(l) => Bound::Lower(FACTOR * l),
                    Bound::Upper(u) => Bound::Upper(FACTOR * u),
                    Bound::Both(l, u) => Bound::Both(FACTOR * l, FACTOR * u),
                };
            }
            if let Some(penalised) = &mut inequality.penalised {
                penalised.jump_data.iter_mut().for_each(|jump| *jump *= FACTOR);
            }
            for term in inequality.dirichlet_energy.iter_mut().flat_map(|of| &mut of.terms) {
                (term.load, term.linear) = (FACTOR * term.load, FACTOR * term.linear);
                term.constant *= FACTOR * FACTOR;
            }
            let after = solved(&inequality, &what);
            assert_eq!(after.outer, before.outer, "{what}");
            let back: Vec<f64> = after.values.iter().map(|u| u / FACTOR).collect();
            assert!(distance(&back, &before.values) < 1e-9, "{what}");
        }
    }
}

/// Outcome and number of linear systems of a nested iteration, or of a cold start on the finest mesh.
fn run(
    scene: &Scene<2>,
    scheme: &str,
    level: usize,
    (solver, is_cold): (&Arc<dyn InequalitySolver<f64>>, bool),
) -> (Outcome, usize) {
    let scheme: NamedScheme = scheme.parse().unwrap();
    let problem = problem_for(scene, &scheme);
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, level).unwrap();
    let nested = NestedIteration::new(&problem, &meshes).shared_solver(Arc::clone(solver));
    let solved = nested.cold_start(is_cold).solve(&*scheme.make()).unwrap();
    (solved.outcome(), solved.solution().systems.unwrap())
}

fn nested(
    scene: &Scene<2>,
    scheme: &str,
    solver: impl InequalitySolver<f64> + 'static,
) -> (Outcome, usize) {
    let solver: Arc<dyn InequalitySolver<f64>> = Arc::new(solver);
    run(scene, scheme, 32, (&solver, false))
}

#[test]
fn starting_values_save_systems() {
    for (name, scheme) in [("radial-2d", "p1"), ("torsion-2d", "cr"), ("cone-2d", "sipg")] {
        let AnyScene::Two(scene) = scene(name) else { panic!("a scene in the plane") };
        let cold = solved(&inequality_of(name, scheme, 32), name).outer;
        let (outcome, warm) = nested(&scene, scheme, ProximalPoint);
        assert_eq!(outcome, Outcome::Converged, "{name}");
        assert!(warm + 2 <= cold, "{name}, {scheme}: {warm} systems and {cold} without a start");
    }
}

#[test]
fn every_scheme_is_taken_and_single_precision() {
    let AnyScene::Two(scene) = scene("signorini-2d") else { panic!("a scene in the plane") };
    for scheme in ["nipg", "iipg", "ldg", "br2", "sipg-p2", "wopsip-p2", "wopsip@eta=1e4"] {
        assert_eq!(nested(&scene, scheme, ProximalPoint).0, Outcome::Converged, "{scheme}");
    }
    let single = SinglePrecision::new(ProximalPoint);
    assert_eq!(nested(&scene, "sipg", single).0, Outcome::Converged);
    // the solver that needs symmetry says so
    let multigrid = MonotoneMultigrid::default();
    assert_eq!(nested(&scene, "nipg", multigrid), (Outcome::Unsuitable, 0));
}

/// Bounds alone hold the string, which the load presses onto them: the solution without bounds does not exist.
#[test]
fn bounds_may_hold_a_body() {
    let n = 40;
    let mut matrix = laplacian(n, 1, 2.0);
    for end in [0, n - 1] {
        let row = matrix.row_starts[end] as usize..matrix.row_starts[end + 1] as usize;
        let diagonal = row.clone().find(|&k| matrix.columns[k] as usize == end).unwrap();
        matrix.values[diagonal] = 1.0;
    }
    let hill = |i: usize| -0.01 * (i as f64 - 13.0).powi(2);
    let bounds = (0..n).map(|i| Bound::Lower(hill(i))).collect();
    let mut problem = inequality(matrix, &vec![-1e-3; n], bounds);
    problem.kernel = vec![(0..n as u32).map(|i| (i, 1.0)).collect()];
    let expected = ActiveSet::default().solve(&problem);
    let found = solved(&problem, "held by bounds");
    assert_eq!(expected.outcome, Outcome::Converged);
    assert!(distance(&found.values, &expected.values) < 1e-8);
}

/// The bounds at vertices of over-penalty are known to defeat the method on this mesh.
#[test]
fn a_run_that_stalls_says_so_with_its_best_iterate() {
    let inequality = inequality_of("torsion-2d", "wopsip", 64);
    let solution = ProximalPoint.solve(&inequality);
    assert_eq!((solution.outcome, solution.outer), (Outcome::IterationLimit, MAX_SYSTEMS));
    let projected = inequality.bounds.iter().zip(&solution.values);
    assert!(projected.clone().all(|(bound, &u)| bound.nearest(u) == u));
    let zero: Vec<f64> = projected.map(|(bound, _)| bound.nearest(0.0)).collect();
    let [found, of_zero] = [&solution.values, &zero].map(|u| certify(&inequality, u).largest());
    assert!(found > 1e-9 && found < of_zero, "{found:e} and {of_zero:e}");
}

/// Mean and maximum of the counts of the runs that converged, and how many did not.
fn summary(runs: &[(Outcome, usize)]) -> String {
    let converged = runs.iter().filter(|run| run.0 == Outcome::Converged);
    let counts: Vec<usize> = converged.map(|run| run.1).collect();
    let failures = match runs.len() - counts.len() {
        0 => String::new(),
        n => format!(" ({n})"),
    };
    let Some(most) = counts.iter().max() else { return format!("–{failures}") };
    let mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    format!("{mean:.1}/{most}{failures}")
}

#[test]
#[ignore = "takes minutes: prints a table of docs/results/solvers.md"]
fn table_of_solvers() {
    let names: Vec<&str> = SOLVERS.iter().map(|(name, _)| *name).collect();
    println!("| scheme | level | {} |", names.join(" | "));
    println!("|---|--:|{}", "--:|".repeat(names.len()));
    for scheme in SCHEMES {
        for level in [16, 32, 64] {
            let mut cells = Vec::new();
            for name in &names {
                let solver: Arc<dyn InequalitySolver<f64>> =
                    solver_by_name(name, LinearMethod::default(), Precision::default())
                        .unwrap()
                        .into();
                let [cold, warm] = [true, false].map(|is_cold| {
                    let run = |name: &&str| match scene(name) {
                        AnyScene::Two(scene) => run(&scene, scheme, level, (&solver, is_cold)),
                        _ => panic!("a scene in the plane"),
                    };
                    summary(&SCENES.iter().map(run).collect::<Vec<_>>())
                });
                cells.push(format!("{cold}, {warm}"));
            }
            println!("| `{scheme}` | {level} | {} |", cells.join(" | "));
        }
    }
}
