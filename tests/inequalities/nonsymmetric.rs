//! Schemes whose matrices are not symmetric, solved iteratively: the same solutions as with factors,
//! counts that do not grow, bounds that are bounds, and a reason wherever there is no solution.

use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, SinglePrecision, Solution};
use unilateral::linear::{LinearMethod, is_positive_definite};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

fn solve(inequality: &Inequality<f64>, linear: LinearMethod) -> Solution<f64> {
    ActiveSet::default().linear(linear).solve(inequality)
}

fn inequality<const D: usize>(
    scene: &Scene<D>,
    scheme: &impl Scheme<D>,
    level: usize,
) -> Inequality<f64> {
    let mesh = scene.domain.mesh(level).unwrap();
    let quadrature = DataQuadrature::default();
    Discretisation::new(scheme, &scene.problem, &mesh, quadrature).unwrap().inequality().unwrap()
}

/// The energy norm.
fn energy(inequality: &Inequality<f64>, u: &[f64]) -> f64 {
    let mut r = vec![0.0; u.len()];
    inequality.matrix.residual_f64(&vec![0.0; u.len()], u, &mut r);
    (-u.iter().zip(&r).map(|(u, r)| u * r).sum::<f64>()).sqrt()
}

/// Solves iteratively and with factors, and compares; returns the inner iterations.
fn agree(inequality: &Inequality<f64>, what: &str) -> usize {
    let found = solve(inequality, LinearMethod::Iterative);
    let exact = solve(inequality, LinearMethod::Direct);
    assert_eq!((found.outcome, exact.outcome), (Outcome::Converged, Outcome::Converged), "{what}");
    assert_eq!((found.linear_solver, exact.linear_solver), ("auxiliary-space", "direct"), "{what}");
    let difference: Vec<f64> = found.values.iter().zip(&exact.values).map(|(a, b)| a - b).collect();
    let largest = exact.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let distance = difference.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    assert!(distance <= 1e-8 * largest, "{what}: {distance:e} of {largest:e}");
    let error = energy(inequality, &difference) / energy(inequality, &exact.values);
    let bound = found.algebraic_bound.unwrap();
    eprintln!(
        "{what}: {} outer {} inner, error {error:.1e} bound {bound:.1e}",
        found.outer, found.linear
    );
    assert!(error <= bound + 1e-13, "{what}: {error:e} beyond {bound:e}");
    assert!(bound <= 1e-9, "{what}: {bound:e}");
    found.linear
}

/// Both schemes on a scene, with its inequalities and without.
fn agree_on<const D: usize>(scene: &Scene<D>, level: usize) {
    let nipg = inequality::<D>(scene, &Nipg::default(), level);
    let iipg = inequality::<D>(scene, &Iipg::default(), level);
    for (name, mut inequality) in [("nipg", nipg), ("iipg", iipg)] {
        assert!(!inequality.symmetric);
        agree(&inequality, &format!("{} {name} {level}", scene.name));
        for bound in inequality.bounds.iter_mut().filter(|bound| bound.is_inequality()) {
            *bound = Bound::Free;
        }
        agree(&inequality, &format!("{} {name} {level} without bounds", scene.name));
    }
}

#[test]
fn solutions_are_those_of_factors() {
    agree_on(&scenes::radial::<2>(1.0), 24);
    agree_on(&scenes::signorini_2d(), 16);
    agree_on(&scenes::radial::<3>(1.0), 6);
    agree_on(&scenes::signorini_harmonic::<3>(), 4);
}

/// Rows of a study, which knows nested meshes, on several levels.
fn rows<const D: usize>(
    scene: fn(f64) -> Scene<D>,
    scheme: impl Scheme<D>,
    levels: &[usize],
    linear: LinearMethod,
) -> Vec<Row> {
    let solver = ActiveSet::default().linear(linear);
    let study = Study::<D>::new(scene(1.0)).scheme(scheme).solver(solver);
    let rows = study.levels(levels.iter().copied()).run().unwrap().rows;
    for row in &rows {
        eprintln!(
            "{} {} {}: {} {} outer {:?} inner {} bound {:.1e} certificate {:.1e} in {:.2} s, {:.0} MB",
            row.scene,
            row.scheme,
            row.level,
            row.status,
            row.linear,
            row.iterations.outer,
            row.iterations.linear,
            row.certificate.algebraic_bound.unwrap_or(f64::NAN),
            row.certificate.largest(),
            row.seconds.solve,
            row.peak_memory_bytes.unwrap_or(0) as f64 / 1e6,
        );
    }
    rows
}

/// On nested meshes at most as many inner iterations on each level as told.
fn level_counts<const D: usize>(scheme: impl Scheme<D>, levels: &[usize], most: usize) -> Vec<Row> {
    let found = rows(scenes::radial, scheme, levels, LinearMethod::Iterative);
    for row in &found {
        assert_eq!((row.status, &*row.linear), (Outcome::Converged, "auxiliary-space"));
        assert!(row.certificate.largest() <= 1e-9, "{:?}", row.certificate);
        assert!(row.certificate.algebraic_bound.unwrap() <= 1e-9, "{:?}", row.certificate);
        assert!(row.iterations.linear <= most, "{} inner", row.iterations.linear);
        assert!(row.iterations.outer.unwrap() <= 5, "{:?} outer", row.iterations.outer);
    }
    found
}

#[test]
fn counts_do_not_grow() {
    let nipg = level_counts::<2>(Nipg::default(), &[16, 32, 64, 128], 68);
    level_counts::<2>(Iipg::default(), &[16, 32, 64, 128], 60);
    let exact = rows::<2>(scenes::radial, Nipg::default(), &[64], LinearMethod::Direct).remove(0);
    // errors differ by no more than solutions do, whose size is one
    let (a, b) = (nipg[2].error.l2.unwrap(), exact.error.l2.unwrap());
    assert!((a - b).abs() <= 1e-8, "error {a} and {b}");
}

#[test]
fn counts_in_space_do_not_grow() {
    level_counts::<3>(Nipg::default(), &[6, 8, 12], 92);
    level_counts::<3>(Iipg::default(), &[4, 8, 12], 74);
}

#[test]
fn threads_do_not_change_a_bit() {
    let inequality = inequality::<2>(&scenes::radial(1.0), &Nipg::default(), 64);
    let solve = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&inequality, LinearMethod::Iterative))
    };
    let (one, two) = (solve(1), solve(2));
    assert_eq!((one.outcome, one.linear_solver), (Outcome::Converged, "auxiliary-space"));
    assert_eq!((one.values, one.linear), (two.values, two.linear));
}

#[test]
fn single_precision_converges() {
    for inequality in [
        inequality::<2>(&scenes::radial(1.0), &Nipg::default(), 32),
        inequality::<2>(&scenes::radial(1.0), &Iipg::default(), 32),
    ] {
        let iterative = ActiveSet::default().linear(LinearMethod::Iterative);
        let found = SinglePrecision::new(iterative).solve(&inequality);
        let exact = solve(&inequality, LinearMethod::Direct);
        assert_eq!((found.outcome, found.linear_solver), (Outcome::Converged, "auxiliary-space"));
        for (a, b) in found.values.iter().zip(&exact.values) {
            assert!((a - b).abs() <= 1e-4, "{a} and {b}");
        }
    }
}

/// Transport beside diffusion, on values at vertices: a skew part that no facet term makes.
#[test]
fn values_at_vertices_may_be_transported() {
    for strength in [0.1, 1.0] {
        let mut inequality = inequality::<2>(&scenes::radial(1.0), &ConformingP1, 48);
        inequality.symmetric = false;
        let matrix = &mut inequality.matrix;
        for i in 0..matrix.size() {
            for k in matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize {
                let j = matrix.columns[k] as usize;
                // both ends of an edge agree on its direction
                matrix.values[k] += strength * (j as f64 - i as f64).signum() * f64::from(i != j);
            }
        }
        let found = solve(&inequality, LinearMethod::Iterative);
        let exact = solve(&inequality, LinearMethod::Direct);
        assert_eq!((found.outcome, found.linear_solver), (Outcome::Converged, "multigrid"));
        for (a, b) in found.values.iter().zip(&exact.values) {
            assert!((a - b).abs() <= 1e-8, "{a} and {b}");
        }
    }
}

/// Factors of the whole matrix would not tell: that of the incomplete form is regular all the same,
/// and what they find passes for a solution.
#[test]
fn without_coercivity_there_is_a_reason() {
    let scene = scenes::radial::<2>(1.0);
    let named = |inequality: &Inequality<f64>, what: &str| {
        let free: Vec<u32> = (0..inequality.size() as u32).collect();
        assert_eq!(is_positive_definite(&inequality.matrix, false, &free), Ok(false), "{what}");
        let solution = solve(inequality, LinearMethod::Iterative);
        eprintln!("{what}: {} after {}", solution.outcome, solution.linear);
        assert_eq!(solution.outcome, Outcome::NotCoercive, "{what}");
        assert!(solution.algebraic_bound.is_none() && solution.linear <= 30, "{what}");
    };
    for sigma in [0.01, 0.1, 0.3] {
        let scheme = Iipg { penalty: PenaltyRule::Diameter(sigma) };
        named(&inequality(&scene, &scheme, 32), &format!("iipg {sigma}"));
    }
    // without penalty the symmetric part of NIPG couples no cells
    let scheme = Nipg { penalty: PenaltyRule::Diameter(0.0) };
    let mesh = scene.domain.mesh(4).unwrap();
    let refused = Discretisation::new(&scheme, &scene.problem, &mesh, DataQuadrature::default());
    assert!(matches!(refused, Err(Error::Parameter(_))), "{:?}", refused.err());
}

#[test]
#[ignore = "a measurement of three minutes"]
fn seconds() {
    for linear in [LinearMethod::Iterative, LinearMethod::Direct] {
        for level in [64, 128, 256] {
            rows::<2>(scenes::radial, Nipg::default(), &[level], linear);
            rows::<2>(scenes::radial, Iipg::default(), &[level], linear);
        }
        for level in [8, 16] {
            rows::<3>(scenes::radial, Nipg::default(), &[level], linear);
            rows::<3>(scenes::radial, Iipg::default(), &[level], linear);
        }
    }
}
