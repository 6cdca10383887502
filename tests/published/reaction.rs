//! A string with reaction, Signorini conditions at both ends: tables of a thesis (bachelor's
//! thesis, Technical University of Munich, on the Signorini problem in one dimension).

use crate::support::checks::Checks;
use unilateral::algebra::Inequality;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::mesh::Mesh;
use unilateral::prelude::*;

/// Mesh size as a power of one half, then largest error, full H1 and L2 norm.
type Rows<'a> = &'a [(i32, [&'a str; 3])];

/// A mesh of the interval `(-1, 1)`.
fn mesh(power: i32) -> Mesh<1> {
    let domain = scenes::signorini_reaction_1d().domain.bounding_box();
    Mesh::kuhn_box(&domain, [2 << power]).unwrap()
}

/// Solves, and tells the size of what rounding does. The entries of a cell's matrix are of size `1/h`
/// and rounded, the same way in all cells of a uniform mesh, so that it does not average out; the sum
/// of a row, the mass `h` of the reaction, is that of four of them and hence known to `2 eps / h^2`
/// of itself, and so is the solution where nothing but the reaction holds it.
fn solve(inequality: &Inequality<f64>) -> (Vec<f64>, f64) {
    let solution = ActiveSet::default().solve(inequality);
    assert_eq!(solution.outcome, Outcome::Converged);
    let h = 2.0 / (inequality.size() - 1) as f64;
    let noise = 2.0 * f64::EPSILON / (h * h);
    let size = norms(&solution.values)[0];
    (solution.values, noise * size)
}

/// Compares a row, up to this noise.
fn compare(checks: &mut Checks, power: i32, ours: [f64; 3], printed: [&str; 3], noise: f64) {
    for ((norm, ours), printed) in ["largest", "H1", "L2"].into_iter().zip(ours).zip(printed) {
        checks.printed_within(&format!("{norm}, h = 2^-{power}"), ours, printed, noise);
    }
}

/// Largest error, between nodes too, and L2 norm are those of the thesis; the last L2 norm is that
/// of the discrete solution in forty digits, where the thesis has 4.7594e-8, which is rounding. Its
/// H1 norms leave out the last element; those here are of an independent program.
#[test]
fn smooth_load() {
    let table: Rows<'_> = &[
        (1, ["1.9989e-2", "8.6406e-2", "1.2335e-2"]),
        (2, ["5.7357e-3", "4.3580e-2", "3.1109e-3"]),
        (3, ["1.5349e-3", "2.1835e-2", "7.7933e-4"]),
        (4, ["3.9704e-4", "1.0923e-2", "1.9493e-4"]),
        (5, ["1.0097e-4", "5.4623e-3", "4.8739e-5"]),
        (6, ["2.5460e-5", "2.7312e-3", "1.2185e-5"]),
        (8, ["1.6015e-6", "6.8281e-4", "7.6157e-7"]),
        (10, ["1.0026e-7", "1.7070e-4", "4.7598e-8"]),
    ];
    let scene = scenes::signorini_reaction_1d();
    let exact = scene.problem.exact.as_ref().unwrap();
    let quadrature = DataQuadrature::default().cell(19);
    let mut checks = Checks::default();
    for &(power, printed) in table {
        let mesh = mesh(power);
        let space = Discretisation::new(&ConformingP1, &scene.problem, &mesh, quadrature).unwrap();
        let (values, noise) = solve(&space.inequality().unwrap());
        let errors = space.errors(&values).unwrap();
        let [l2, h1] = [errors.l2, errors.h1].map(Option::unwrap);
        // many points of each cell
        let largest = values.windows(2).enumerate().flat_map(|(cell, ends)| {
            let mesh = &mesh;
            (0..=512).map(move |k| {
                let t = f64::from(k) / 512.0;
                let u = ends[0] * (1.0 - t) + ends[1] * t;
                (u - exact.value.at(&mesh.point(cell, &[1.0 - t, t]))).abs()
            })
        });
        let largest = largest.fold(0.0, f64::max);
        compare(&mut checks, power, [largest, h1.hypot(l2), l2], printed, noise);
    }
    checks.finish();
}

/// Integrals of `|x|^-0.499` times each hat function on a mesh of `(-1, 1)` that has a node at
/// zero.
fn rough_load(mesh: &Mesh<1>) -> Vec<f64> {
    let x: Vec<f64> = mesh.vertices().iter().map(|x| x[0]).collect();
    let mut load = vec![0.0; x.len()];
    for k in 0..x.len() - 1 {
        // the mirror image where the cell is on the left, its nodes in turn
        let (inner, outer) = if x[k] >= 0.0 { (k, k + 1) } else { (k + 1, k) };
        let [a, b] = [x[inner].abs(), x[outer].abs()];
        let moment = |power: f64| (b.powf(power) - a.powf(power)) / power;
        let [whole, first] = [moment(0.501), moment(1.501)];
        load[outer] += (first - a * whole) / (b - a);
        load[inner] += (b * whole - first) / (b - a);
    }
    load
}

/// Nodal values of the discrete solution with the rough load, and their noise.
fn rough_solution(power: i32) -> (Vec<f64>, f64) {
    let mesh = mesh(power);
    let problem = Problem::new().reaction(1.0).signorini(|_| 0.0);
    let mut inequality = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default())
        .unwrap()
        .inequality()
        .unwrap();
    inequality.load = rough_load(&mesh);
    solve(&inequality)
}

/// Largest value, full H1 and L2 norm of a piecewise linear function on `(-1, 1)`.
fn norms(values: &[f64]) -> [f64; 3] {
    let h = 2.0 / (values.len() - 1) as f64;
    let max = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let [mut h1, mut l2] = [0.0; 2];
    for pair in values.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        h1 += (b - a) * (b - a) / h;
        l2 += h * (a * a + a * b + b * b) / 3.0;
    }
    [max, (h1 + l2).sqrt(), l2.sqrt()]
}

/// Errors against the solution on a mesh of size `2^-12`, the load integrated exactly: the figures
/// of a computation in forty digits. The thesis names another load, but its figures are those of
/// this one: its H1 norms to every digit, the others but for up to a hundredth on the finest mesh.
#[test]
fn rough_load_without_exact_solution() {
    let table: Rows<'_> = &[
        (1, ["1.6743e-2", "1.2787e-1", "1.4965e-2"]),
        (3, ["4.6155e-3", "5.3941e-2", "1.9150e-3"]),
        (5, ["8.1865e-4", "1.8801e-2", "1.7483e-4"]),
        (7, ["1.1857e-4", "5.8610e-3", "1.3895e-5"]),
        (10, ["5.6405e-6", "8.8349e-4", "2.6170e-7"]),
    ];
    let (reference, noise) = rough_solution(12);
    let mut checks = Checks::default();
    for &(power, printed) in table {
        let (coarse, _) = rough_solution(power);
        let ratio = (reference.len() - 1) / (coarse.len() - 1);
        let interpolated = |k: usize| {
            let (cell, part) = (k / ratio, (k % ratio) as f64 / ratio as f64);
            let next = coarse[(cell + 1).min(coarse.len() - 1)];
            coarse[cell] * (1.0 - part) + next * part
        };
        let differences: Vec<f64> =
            reference.iter().enumerate().map(|(k, fine)| fine - interpolated(k)).collect();
        compare(&mut checks, power, norms(&differences), printed, noise);
    }
    checks.finish();
}
