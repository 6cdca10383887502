//! A string with reaction, Signorini conditions at both ends: tables of a thesis (bachelor's thesis,
//! Technical University of Munich, on the Signorini problem in one dimension).

use crate::support::accuracy::Checks;
use unilateral::algebra::Start;
use unilateral::assemble::DataQuadrature;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::scenes::BoxDomain;
use unilateral::solve::{ActiveSet, InequalitySolver, Outcome};
use unilateral::study::Study;

/// Mesh size as a power of one half, then largest nodal error, H1 and L2 norm.
type Rows<'a> = &'a [(u32, [&'a str; 3])];

/// Cells of the interval `(-1, 1)`.
const fn cells(power: u32) -> usize {
    2 << power
}

/// Largest error and L2 norm are those of the thesis, to every digit. Its H1 norms leave out the
/// last element; those here are of an independent program.
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
        (10, ["1.0026e-7", "1.7070e-4", "4.7594e-8"]),
    ];
    let rows = Study::<f64, 1>::new(scenes::signorini_reaction_1d())
        .scheme(ConformingP1)
        .levels(table.iter().map(|row| cells(row.0)))
        .quadrature(DataQuadrature { cell: 19, ..DataQuadrature::default() })
        .run()
        .unwrap()
        .rows;
    let mut checks = Checks::default();
    for (row, (power, printed)) in rows.iter().zip(table) {
        checks.certified(row, 1e-9);
        let error = row.error;
        let [max, h1, l2] = [error.max, error.h1, error.l2].map(Option::unwrap);
        eprintln!("{power} {max:e} {h1:e} {l2:e} {:e}", h1.hypot(l2));
        for ((norm, ours), printed) in
            [("max", max), ("H1", h1), ("L2", l2)].into_iter().zip(printed)
        {
            checks.printed(&format!("{norm}, h = 2^-{power}"), ours, printed, 0.5);
        }
    }
    checks.finish();
}

/// Integrals of `|x|^-0.499` times each hat function on a mesh of `(-1, 1)` that has a node at zero.
fn rough_load(mesh: &Mesh<f64, 1>) -> Vec<f64> {
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

/// Nodal values of the discrete solution with the rough load.
fn rough_solution(power: u32) -> Vec<f64> {
    let scene = scenes::signorini_reaction_1d();
    let domain: BoxDomain<1> = scene.domain.bounding_box();
    let mesh = Mesh::<f64, 1>::kuhn_box(&domain, [cells(power)]).unwrap();
    let problem = Problem::new().reaction(1.0).signorini(|_| 0.0);
    let mut inequality = ConformingP1.inequality(&problem, &mesh, Default::default()).unwrap();
    inequality.load = rough_load(&mesh);
    inequality.start = Start::Cold;
    let solution = ActiveSet::default().solve(&inequality);
    assert_eq!(solution.outcome, Outcome::Converged);
    solution.values
}

/// Largest value, H1 seminorm and L2 norm of a piecewise linear function on `(-1, 1)`.
fn norms(values: &[f64]) -> [f64; 3] {
    let h = 2.0 / (values.len() - 1) as f64;
    let max = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let [mut h1, mut l2] = [0.0; 2];
    for pair in values.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        h1 += (b - a) * (b - a) / h;
        l2 += h * (a * a + a * b + b * b) / 3.0;
    }
    [max, h1.sqrt(), l2.sqrt()]
}

/// Errors against the solution on a mesh of size `2^-12`. The thesis names another load, but its
/// figures are those of this one: its H1 norms to every digit, the others to a few units in the
/// fourth, for it integrates the load by a rule and not exactly. The figures here are of an
/// independent program with exact integrals.
#[test]
fn rough_load_without_exact_solution() {
    let table: Rows<'_> = &[
        (1, ["1.6743e-2", "1.2787e-1", "1.4965e-2"]),
        (3, ["4.6155e-3", "5.3941e-2", "1.9150e-3"]),
        (5, ["8.1866e-4", "1.8801e-2", "1.7483e-4"]),
        (7, ["1.1858e-4", "5.8610e-3", "1.3895e-5"]),
        (10, ["5.6475e-6", "8.8349e-4", "2.6190e-7"]),
    ];
    let reference = rough_solution(12);
    let mut checks = Checks::default();
    for (power, printed) in table {
        let coarse = rough_solution(*power);
        let ratio = (reference.len() - 1) / (coarse.len() - 1);
        let differences: Vec<f64> = reference
            .iter()
            .enumerate()
            .map(|(k, fine)| {
                let (cell, part) = (k / ratio, (k % ratio) as f64 / ratio as f64);
                let next = coarse[(cell + 1).min(coarse.len() - 1)];
                fine - (coarse[cell] * (1.0 - part) + next * part)
            })
            .collect();
        let ours = norms(&differences);
        eprintln!("{power} {ours:?} full {:e}", ours[1].hypot(ours[2]));
        for ((norm, ours), printed) in ["max", "H1", "L2"].into_iter().zip(ours).zip(printed) {
            checks.printed(&format!("{norm}, h = 2^-{power}"), ours, printed, 0.5);
        }
    }
    checks.finish();
}
