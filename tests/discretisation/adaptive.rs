//! Meshes that follow the error bound.

use crate::elements::{ConformingP3, P3};
use rayon::ThreadPoolBuilder;
use unilateral::error::Error;
use unilateral::inequality::ActiveSet;
use unilateral::linear::{LinearMethod, Prolongation};
use unilateral::mesh::BisectedMesh;
use unilateral::nested::{AdaptiveIteration, AdaptiveStep};
use unilateral::prelude::*;
use unilateral::problem::Exact;
use unilateral::scenes::Scene;

/// The Laplace equation around a corner of 270 degrees, whose solution is like the power 2/3 of the distance.
fn corner() -> Scene<2> {
    // the angle from the middle of the domain
    let polar = |x: &Point<2>| (x.norm(), (-x[0] - x[1]).atan2(x[1] - x[0]));
    let value = move |x: &Point<2>| {
        let (r, phi) = polar(x);
        r.powf(2.0 / 3.0) * (2.0 * phi / 3.0).cos()
    };
    let gradient = move |x: &Point<2>| {
        let (r, phi) = polar(x);
        let (along, across) = ((2.0 * phi / 3.0).cos(), -(2.0 * phi / 3.0).sin());
        let radial = x / r;
        (radial * along + Point::<2>::new(-radial[1], radial[0]) * across)
            * (2.0 / 3.0 * r.powf(-1.0 / 3.0))
    };
    let problem = Problem::new().solved_by(Exact::new(value, gradient)).dirichlet(value);
    Scene::new("corner", scenes::lshape_2d().domain, problem)
}

/// A step in figures.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Figures {
    unknowns: f64,
    bound: f64,
    /// Bound over the error of the admissible function.
    effectivity: f64,
    /// Of the scheme's own solution, in the broken energy norm.
    error: f64,
}

fn steps<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn Scheme<D>,
    adaptivity: Adaptivity,
) -> Vec<Figures> {
    let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
    let figures = |step: Result<AdaptiveStep<'_, D>, Error>| {
        let solved = step.unwrap().solved;
        let pair = solved.primal_dual_pair().unwrap();
        let of_pair = solved.discretisation().error_of_pair(&pair).unwrap();
        let bound = solved.bound().unwrap().total;
        Figures {
            unknowns: solved.values().len() as f64,
            bound,
            effectivity: bound / of_pair,
            error: solved.errors().unwrap().broken_energy.unwrap(),
        }
    };
    adapt(&scene.problem, &meshes, scheme, adaptivity).unwrap().map(figures).collect()
}

/// The slope of a figure against unknowns in logarithms, by least squares.
fn slope(steps: &[Figures], figure: fn(&Figures) -> f64) -> f64 {
    let logs: Vec<(f64, f64)> = steps.iter().map(|s| (s.unknowns.ln(), figure(s).ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let products = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>();
    products / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Bound and error fall like the power -1/D of the number of unknowns over the last half of the steps, the
/// bound from step to step, and it stays within three times the error.
fn check_optimal<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn Scheme<D>,
    adaptivity: Adaptivity,
    steeper: f64,
) {
    let steps = steps(scene, scheme, adaptivity);
    let name = format!("{}, {}: {steps:?}", scene.name, scheme.name());
    for step in &steps {
        assert!(step.effectivity > 0.99 && step.effectivity < 3.0, "{name}");
    }
    assert!(steps.windows(2).all(|pair| pair[1].bound < 1.05 * pair[0].bound), "{name}");
    let half = &steps[steps.len() / 2..];
    let rate = -1.0 / D as f64;
    for slope in [slope(half, |s| s.bound), slope(half, |s| s.error)] {
        assert!(rate - 0.05 - steeper < slope && slope < rate + 0.05, "{slope}: {name}");
    }
}

fn four_schemes<const D: usize>(mut f: impl FnMut(&dyn Scheme<D>)) {
    f(&ConformingP1);
    f(&NonconformingP1);
    f(&Sipg::default());
    f(&Wopsip::default());
}

#[test]
fn rates_are_optimal_at_a_corner_and_in_contact() {
    let adaptivity = Adaptivity::default().unknowns(12_000);
    four_schemes(|scheme| {
        check_optimal(&corner(), scheme, adaptivity, 0.0);
        check_optimal(&scenes::hertz_2d(), scheme, adaptivity, 0.0);
    });
    // the uniform slope is -1/3
    let uniform = |n: usize| {
        let mesh = corner().domain.mesh(n).unwrap();
        solve(&corner().problem, &mesh, &ConformingP1).unwrap().bound().unwrap().total
    };
    let order = (uniform(16) / uniform(32)).log2();
    assert!(order < 0.75, "{order}");
}

#[test]
#[ignore = "long: half a million unknowns"]
fn rates_are_optimal_with_contact_beside_a_corner() {
    // the terms of the load along its circles fall faster and are not gone
    let adaptivity = Adaptivity::default().unknowns(500_000);
    four_schemes(|scheme| check_optimal(&scenes::lshape_2d(), scheme, adaptivity, 0.03));
}

#[test]
fn marked_cells_are_the_smallest_set_with_the_share() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(8).unwrap();
    let bound = solve(&scene.problem, &mesh, &ConformingP1).unwrap().bound().unwrap();
    let all: f64 = bound.cells.iter().sum();
    for theta in [0.1, 0.5, 0.9, 0.99] {
        let marked = bound.marked(theta);
        assert!(marked.is_sorted() && !marked.is_empty());
        let sum: f64 = marked.iter().map(|&cell| bound.cells[cell]).sum();
        let least = marked.iter().map(|&cell| bound.cells[cell]).fold(f64::INFINITY, f64::min);
        assert!(sum >= theta * all * (1.0 - 1e-12) && sum - least < theta * all, "{theta}");
        let is_marked = |cell: &usize| marked.binary_search(cell).is_ok();
        let rest = (0..mesh.n_cells()).filter(|cell| !is_marked(cell));
        assert!(rest.map(|cell| bound.cells[cell]).all(|share| share <= least), "{theta}");
    }
    let mut equal = bound.clone();
    equal.cells.fill(0.25);
    equal.cells.truncate(4);
    assert_eq!(equal.marked(0.5), [0, 1]);
    equal.cells.fill(0.0);
    assert!(equal.marked(0.5).is_empty());
}

#[test]
fn prolongations_between_bisected_meshes_keep_continuous_functions() {
    fn check<const D: usize>() {
        let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let first = Mesh::<D>::kuhn_box(&square, [2; D]).unwrap();
        let mut refined = BisectedMesh::new(first.clone());
        let mut parents = Vec::new();
        for _ in 0..5 {
            let n = refined.mesh().vertices().len();
            let mesh = refined.mesh();
            let marked: Vec<usize> =
                (0..mesh.n_cells()).filter(|&c| mesh.cell(c)[0] == 0).collect();
            let bisection;
            (refined, bisection) = refined.bisect(&marked).unwrap();
            parents.extend_from_slice(&bisection.parents[n..]);
        }
        let n = first.vertices().len();
        let prolongation = Prolongation::bisections(parents, n);
        let fine = refined.mesh();
        assert_eq!((prolongation.n_coarse(), prolongation.n_fine()), (n, fine.vertices().len()));
        // a hat function, by its value at every fine vertex from the coarse cell that contains it
        let hat: Vec<f64> = (0..n).map(|v| (v % 3) as f64 - 1.0).collect();
        let values = prolongation.prolongate(&hat);
        for (x, value) in fine.vertices().iter().zip(values) {
            let inside = (0..first.n_cells()).find_map(|cell| {
                let geometry = first.geometry(cell);
                let from = x - first.vertices()[first.cell(cell)[0] as usize];
                let at = |i: usize| f64::from(i == 0) + geometry.gradient(i).dot(&from);
                (0..=D).all(|i| at(i) > -1e-12).then(|| {
                    let vertices = first.cell(cell).iter().enumerate();
                    vertices.map(|(i, &v)| at(i) * hat[v as usize]).sum::<f64>()
                })
            });
            assert!((inside.unwrap() - value).abs() < 1e-12, "{D}, {x}");
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn refinement_ends_where_it_is_told_to() {
    let scene = scenes::radial::<2>(1.0);
    let run = |adaptivity: Adaptivity| {
        let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
        let sipg = Sipg::default();
        let steps = adapt(&scene.problem, &meshes, &sipg, adaptivity).unwrap();
        let steps: Vec<_> = steps.map(|step| step.unwrap()).collect();
        let numbers: Vec<usize> = steps.iter().map(|step| step.number).collect();
        assert_eq!(numbers, (0..meshes.n_meshes()).collect::<Vec<_>>());
        assert!(steps.windows(2).all(|pair| pair[0].seconds() < pair[1].seconds()));
        assert!(steps.iter().rev().skip(1).all(|step| step.stop.is_none()));
        let last = steps.last().unwrap();
        let bound = last.solved.bound().unwrap().total;
        (
            last.stop.unwrap(),
            bound,
            last.number,
            last.solved.values().len(),
            last.solved.warnings().len(),
        )
    };
    let (stop, bound, number, _, warnings) = run(Adaptivity::to_bound(0.6));
    assert!(stop == Stop::Goal && bound <= 0.6 && number > 1 && warnings == 0, "{bound} {number}");
    let (stop, bound, number, _, warnings) = run(Adaptivity::to_bound(0.6).steps(1));
    assert!(stop == Stop::Steps && bound > 0.6 && number == 1 && warnings == 1, "{bound} {number}");
    let (stop, _, number, unknowns, warnings) = run(Adaptivity::default().unknowns(1000));
    assert!(stop == Stop::Unknowns && unknowns <= 1000 && number > 1 && warnings == 0);
    assert_eq!(run(Adaptivity::default().steps(0)).0, Stop::Steps);
    // the goal is one of the bound on the discrete solution, and may be reached by equality
    let mesh = scene.domain.mesh(4).unwrap();
    let first = solve(&scene.problem, &mesh, &Sipg::default()).unwrap().bound().unwrap();
    assert!(first.discrete != first.total, "{first:?}");
    for goal in [first.discrete, first.discrete.max(first.total)] {
        let (stop, _, number, ..) = run(Adaptivity::to_bound(goal));
        assert_eq!((stop, number), (Stop::Goal, 0), "{goal}");
    }
    let below = first.discrete * (1.0 - 1e-9);
    assert!(run(Adaptivity::to_bound(below)).2 > 0);
    // the next mesh has as many unknowns as are allowed
    let (_, _, _, unknowns, _) = run(Adaptivity::default().steps(1));
    let (stop, _, number, found, _) = run(Adaptivity::default().steps(1).unknowns(unknowns));
    assert_eq!((stop, number, found), (Stop::Steps, 1, unknowns));
    assert_eq!(run(Adaptivity::default().steps(1).unknowns(unknowns - 1)).0, Stop::Unknowns);
    // linear solutions are exact
    let linear = |x: &Point<2>| 1.0 + x[0] - 2.0 * x[1];
    let problem = Problem::new().dirichlet(linear);
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let meshes = AdaptiveMeshes::new(Mesh::<2>::kuhn_box(&square, [1, 1]).unwrap());
    let mut steps = adapt(&problem, &meshes, &ConformingP1, Adaptivity::to_bound(1e-9)).unwrap();
    let first = steps.next().unwrap().unwrap();
    assert!(matches!(first.stop, Some(Stop::Exact | Stop::Goal)) && steps.next().is_none());
}

#[test]
fn what_cannot_be_refined_is_refused() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(4).unwrap();
    let meshes = AdaptiveMeshes::new(mesh.clone());
    let message = |scheme: &dyn Scheme<2>, adaptivity| {
        adapt(&scene.problem, &meshes, scheme, adaptivity).unwrap_err().to_string()
    };
    for scheme in [&ConformingP3 as &dyn Scheme<2>, &Sipg::default().on(P3)] {
        let message = message(scheme, Adaptivity::default());
        assert!(message.contains(scheme.name()) && message.contains("no flux"), "{message}");
    }
    for (adaptivity, what) in [
        (Adaptivity::default().theta(0.0), "theta = 0.0"),
        (Adaptivity::default().theta(1.5), "theta = 1.5"),
        (Adaptivity::default().theta(f64::NAN), "theta = NaN"),
        (Adaptivity::to_bound(0.0), "goal = 0.0"),
        (Adaptivity::to_bound(f64::INFINITY), "goal = inf"),
    ] {
        let message = message(&ConformingP1, adaptivity);
        assert!(message.starts_with(what), "{message}");
    }
    let nested = NestedIteration::new(&scene.problem, &mesh);
    let other = AdaptiveIteration::new(nested, &ConformingP1, Adaptivity::default()).unwrap_err();
    assert!(matches!(&other, Error::Parameter(why) if why.starts_with("meshes = ")), "{other}");
    // bad data are an error of the step that meets them, the last one
    let bad = scene.problem.clone().source(|x: &Point<2>| 1.0 / (x[0] - x[0]));
    let mut steps = adapt(&bad, &meshes, &ConformingP1, Adaptivity::default()).unwrap();
    assert!(matches!(steps.next(), Some(Err(Error::DataNotFinite(_)))));
    assert!(steps.next().is_none());
}

#[test]
fn meshes_and_values_have_the_same_bits_for_any_number_of_threads() {
    let scene = scenes::lshape_2d();
    let run = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let values = || {
            let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
            let adaptivity = Adaptivity::default().unknowns(15_000);
            let sipg = Sipg::default();
            let steps = adapt(&scene.problem, &meshes, &sipg, adaptivity).unwrap();
            let last = steps.last().unwrap().unwrap();
            (last.solved.mesh().cells().to_vec(), last.solved.values().to_vec())
        };
        pool.install(values)
    };
    assert_eq!(run(1), run(3));
}

/// Krylov iterations over active sets on the last adaptive mesh, and on a uniform mesh with at least as many
/// unknowns.
#[test]
fn preconditioners_work_on_adaptive_meshes_as_on_uniform_ones() {
    let iterative = || ActiveSet::default().linear(LinearMethod::Iterative);
    let scene = corner();
    four_schemes(|scheme| {
        let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
        let nested = NestedIteration::new(&scene.problem, &meshes).solver(iterative());
        let adaptivity = Adaptivity::default().unknowns(30_000);
        let steps = AdaptiveIteration::new(nested, scheme, adaptivity).unwrap();
        let last = steps.last().unwrap().unwrap().solved;
        let uniform = [32, 64].into_iter().find_map(|n| {
            let meshes = Hierarchy::of_domain(&scene.domain, n).unwrap();
            let mut nested = NestedIteration::new(&scene.problem, &meshes).solver(iterative());
            let solved = nested.solve(scheme).unwrap();
            (solved.values().len() >= last.values().len() || n == 64)
                .then(|| solved.solution().linear)
        });
        let (adaptive, uniform) = (last.solution().linear, uniform.unwrap());
        assert!(
            adaptive > 0 && 2 * adaptive <= 3 * uniform,
            "{}: {adaptive} {uniform}",
            scheme.name()
        );
    });
}

#[test]
fn every_dimension_is_refined() {
    fn check<const D: usize>(scene: &Scene<D>, scheme: &dyn Scheme<D>) {
        let meshes = AdaptiveMeshes::new(scene.domain.mesh(4).unwrap());
        let adaptivity = Adaptivity::default().steps(3);
        let steps = adapt(&scene.problem, &meshes, scheme, adaptivity).unwrap();
        let bounds: Vec<f64> =
            steps.map(|step| step.unwrap().solved.bound().unwrap().total).collect();
        assert!(bounds.len() == 4 && bounds[3] < 0.7 * bounds[0], "{D}: {bounds:?}");
    }
    check::<1>(&scenes::radial(1.0), &Wopsip::default());
    check::<2>(&scenes::radial(1.0), &ConformingP1);
    check::<3>(&scenes::signorini_harmonic(), &NonconformingP1);
}
