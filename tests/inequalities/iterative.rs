//! The iterative linear solver: counts that do not grow, the same solutions as with factors, the
//! same bits twice, and a reason wherever it does not succeed.

use unilateral::algebra::{Bound, Inequality, SparseMatrix};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, certify};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

fn with(linear: LinearMethod) -> ActiveSet {
    ActiveSet::default().linear(linear)
}

fn rows<const D: usize>(
    scene: Scene<D>,
    scheme: impl Scheme<D>,
    levels: &[usize],
    linear: LinearMethod,
) -> Vec<Row> {
    let study = Study::<D>::new(scene).scheme(scheme).solver(with(linear));
    let rows = study.levels(levels.iter().copied()).run().unwrap().rows;
    for row in &rows {
        assert!(row.converged(), "{} on level {}", row.scheme, row.level);
        eprintln!(
            "{} {} {}: outer {:?} inner {} bound {:?} linear {}",
            row.scene,
            row.scheme,
            row.level,
            row.iterations.outer,
            row.iterations.linear,
            row.certificate.algebraic_bound,
            row.linear
        );
    }
    rows
}

/// Solves with both and compares; returns the inner iterations of every level.
fn counts<const D: usize>(
    scene: fn(f64) -> Scene<D>,
    scheme: impl Scheme<D> + Clone,
    levels: &[usize],
    linear: &str,
) -> Vec<usize> {
    let found = rows(scene(1.0), scheme.clone(), levels, LinearMethod::Iterative);
    let exact = rows(scene(1.0), scheme, levels, LinearMethod::Direct);
    for (row, exact) in found.iter().zip(&exact) {
        assert_eq!((&*row.linear, &*exact.linear), (linear, "direct"));
        let (a, b) = (row.objective.unwrap(), exact.objective.unwrap());
        assert!((a - b).abs() <= 1e-8 * b.abs(), "objective {a} and {b}");
        let (a, b) = (row.error.l2.unwrap(), exact.error.l2.unwrap());
        // errors differ by no more than solutions do, whose size is one
        assert!((a - b).abs() <= 1e-8, "error {a} and {b}");
        assert!(row.certificate.largest() <= 1e-9, "{:?}", row.certificate);
        assert!(row.certificate.algebraic_bound.unwrap() <= 1e-9, "{:?}", row.certificate);
        let outer = row.iterations.outer.unwrap();
        assert!(outer <= 10, "{outer} outer");
    }
    found.iter().map(|row| row.iterations.linear).collect()
}

fn assert_level(counts: &[usize], most: usize) {
    let (first, rest) = counts.split_first().unwrap();
    for count in rest {
        assert!(count <= &most, "{counts:?}");
        assert!(2 * count <= 3 * first.max(&(most / 2)), "{counts:?}");
    }
}

#[test]
fn counts_of_conforming_functions_do_not_grow() {
    assert_level(&counts::<2>(scenes::radial, ConformingP1, &[32, 64, 128], "multigrid"), 25);
    assert_level(&counts::<3>(scenes::radial, ConformingP1, &[8, 16], "multigrid"), 30);
}

#[test]
fn counts_of_nonconforming_functions_do_not_grow() {
    let counts = counts::<2>(scenes::radial, NonconformingP1, &[16, 32, 64], "auxiliary-space");
    assert_level(&counts, 25);
}

#[test]
fn counts_of_interior_penalty_do_not_grow() {
    let counts = counts::<2>(scenes::radial, Sipg::default(), &[16, 32, 64], "auxiliary-space");
    assert_level(&counts, 20);
}

#[test]
fn counts_of_over_penalty_on_facet_means_do_not_grow() {
    let scheme = Wopsip::default();
    assert_level(&counts::<2>(on_means, scheme, &[16, 32, 64], "facet-split"), 30);
}

#[test]
fn counts_of_over_penalty_on_vertices_do_not_grow() {
    let scheme = Wopsip::default();
    assert_level(&counts::<2>(scenes::radial, scheme, &[16, 32, 64], "facet-split"), 45);
}

/// The forces of jumps, as unknowns besides the values, leave a certificate at rounding where jumps are
/// lost in the differences of values.
#[test]
fn a_huge_penalty_needs_no_factors_under_signorini_conditions() {
    let scheme = Wopsip { eta: Eta::Absolute(1e8), ..Wopsip::default() };
    for row in rows(scenes::signorini_2d(), scheme, &[32, 64], LinearMethod::Iterative) {
        assert_eq!(&*row.linear, "facet-split");
        assert!(row.certificate.largest() <= 1e-11, "{}: {:?}", row.level, row.certificate);
    }
}

#[test]
fn counts_in_three_dimensions_stay_small() {
    let sipg = counts::<3>(scenes::radial, Sipg::default(), &[4, 8], "auxiliary-space");
    assert_level(&sipg, 30);
    let wopsip = counts::<3>(scenes::radial, Wopsip::default(), &[4, 8], "facet-split");
    assert_level(&wopsip, 60);
}

/// The radial scene with bounds on facet means.
fn on_means(scale: f64) -> Scene<2> {
    let mut scene = scenes::radial(scale);
    scene.problem = scene.problem.on(FacetMeans);
    scene
}

fn inequality<S: Scheme<2>>(scheme: &S, level: usize) -> Inequality<f64> {
    on(&scenes::radial(1.0), scheme, level)
}

fn on<S: Scheme<2>>(scene: &Scene<2>, scheme: &S, level: usize) -> Inequality<f64> {
    let mesh = scene.domain.mesh(level).unwrap();
    let space =
        Discretisation::new(scheme, &scene.problem, &mesh, DataQuadrature::default()).unwrap();
    space.inequality().unwrap()
}

#[test]
fn one_mesh_alone_will_do() {
    let mut inner = Vec::new();
    for level in [32, 64, 128] {
        let inequality = inequality(&ConformingP1, level);
        let solution = with(LinearMethod::Iterative).solve(&inequality);
        assert_eq!((solution.outcome, solution.linear_solver), (Outcome::Converged, "multigrid"));
        eprintln!("alone {level}: {} {}", solution.outer, solution.linear);
        inner.push(solution.linear / solution.outer);
        let exact = with(LinearMethod::Direct).solve(&inequality);
        let largest = exact.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in solution.values.iter().zip(&exact.values) {
            assert!((a - b).abs() <= 1e-8 * largest, "{a} and {b}");
        }
    }
    assert!(inner[2] <= inner[0] + 6, "{inner:?}");
    for solution in [
        with(LinearMethod::Iterative).solve(&inequality(&Sipg::default(), 16)),
        with(LinearMethod::Iterative).solve(&on(&on_means(1.0), &Wopsip::default(), 16)),
    ] {
        assert_eq!(solution.outcome, Outcome::Converged);
        assert!(solution.linear > 0);
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let inequality = inequality(&ConformingP1, 160);
    let solve = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| with(LinearMethod::Iterative).solve(&inequality))
    };
    let (one, again, two) = (solve(1), solve(1), solve(2));
    assert_eq!(one.outcome, Outcome::Converged);
    assert_eq!(one.values, again.values);
    assert_eq!(one.values, two.values);
}

/// Second differences on a square grid with `shift` on the diagonal besides.
fn grid(n: usize, shift: f64) -> Inequality<f64> {
    let mut inequality = inequality(&ConformingP1, n);
    let SparseMatrix { row_starts, columns, values } = &mut inequality.matrix;
    for i in 0..row_starts.len() - 1 {
        for k in row_starts[i] as usize..row_starts[i + 1] as usize {
            if columns[k] as usize == i {
                values[k] += shift;
            }
        }
    }
    inequality.bounds.fill(Bound::Free);
    // the matrix is no longer that of the form
    inequality.is_definite = false;
    inequality
}

#[test]
fn what_cannot_be_solved_is_named() {
    let outcome =
        |inequality: &Inequality<f64>| with(LinearMethod::Iterative).solve(inequality).outcome;
    assert_eq!(outcome(&grid(40, 0.0)), Outcome::Singular);
    assert_eq!(outcome(&grid(40, -0.1)), Outcome::NotCoercive);
    assert_eq!(outcome(&grid(40, 0.1)), Outcome::Converged);
    let mut wrong = grid(40, 0.1);
    wrong.load[5] = f64::NAN;
    assert_eq!(outcome(&wrong), Outcome::NotFinite);
    let mut wrong = grid(40, 0.1);
    wrong.locations.truncate(3);
    let solution = with(LinearMethod::Iterative).solve(&wrong);
    assert_eq!(solution.outcome, Outcome::Malformed);
}

#[test]
fn the_bound_on_the_error_is_one() {
    fn check<S: Scheme<2>>(scene: &Scene<2>, scheme: &S) {
        let inequality = on(scene, scheme, 48);
        let exact = with(LinearMethod::Direct).solve(&inequality).values;
        let solution = with(LinearMethod::Iterative).solve(&inequality);
        let energy = |u: &[f64]| {
            let zero = vec![0.0; u.len()];
            let mut r = zero.clone();
            inequality.matrix.residual_f64(&zero, u, &mut r);
            -u.iter().zip(&r).map(|(u, r)| u * r).sum::<f64>()
        };
        let difference: Vec<f64> = exact.iter().zip(&solution.values).map(|(a, b)| a - b).collect();
        let error = (energy(&difference) / energy(&exact)).sqrt();
        let bound = solution.algebraic_bound.unwrap();
        let name = (&scene.name, scheme.name());
        assert!(error <= bound, "{name:?}: {error} and {bound}");
        assert!(bound <= 1e-9, "{name:?}: {bound}");
        // a certificate carries the bound, and its violations stay what they are
        let without = certify(&inequality, &solution.values);
        let with = without.with_algebraic_bound(Some(bound));
        assert_eq!((without.algebraic_bound, with.algebraic_bound), (None, Some(bound)));
        assert_eq!(with.largest(), without.largest());
    }
    // contact of the last two has no multiplier, so that any of it may come loose
    for scene in [scenes::radial(1.0), scenes::biactive_half_2d(), scenes::degenerate(2)] {
        check(&scene, &ConformingP1);
        check(&scene, &Sipg::default());
    }
}

/// The energy that scales the tolerance is that with Dirichlet data: for over-penalties the other one is
/// larger by orders of magnitude, and the algebraic error with it.
#[test]
fn the_algebraic_error_is_a_small_part_of_the_error() {
    for set in [false, true] {
        let study = |linear| {
            let study = Study::<2>::new(scenes::radial(1.0)).solver(with(linear));
            let study = match set {
                true => study.scheme_on(Wopsip::default(), FacetMeans),
                false => study.scheme(Wopsip::default()),
            };
            study.levels([64]).run().unwrap().rows.remove(0).error.l2.unwrap()
        };
        let (found, exact) = (study(LinearMethod::Iterative), study(LinearMethod::Direct));
        assert!((found - exact).abs() <= 1e-6 * exact, "{found} and {exact}");
    }
}
