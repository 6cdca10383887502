//! The ball obstacle: a program of PETSc.

use crate::support::checks::Checks;
use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::prelude::*;

/// The obstacle problem of PETSc's `snes/tutorials/ex9` (Bueler, *PETSc for Partial Differential
/// Equations*, chapter 12): five-point differences on `N x N` points, which are conforming linear
/// elements on triangles with a right angle. Mean and maximum of the error over all points, points
/// in contact. Up to 33 the errors are PETSc's own, beyond those of an independent program.
#[test]
fn ball_obstacle_of_petsc() {
    let cases = [
        (5, "4.531e-2", "1.635e-1", 1),
        (9, "3.076e-3", "1.334e-2", 9),
        (17, "2.707e-3", "1.428e-2", 29),
        (33, "8.182e-4", "5.747e-3", 109),
        (65, "9.818e-5", "5.991e-4", 421),
        (129, "3.334e-5", "2.154e-4", 1609),
    ];
    let scene = scenes::ball_2d();
    let exact = scene.problem.exact.as_ref().unwrap();
    let mut checks = Checks::default();
    for (points, mean, max, active) in cases {
        let mesh = scene.domain.mesh(points - 1).unwrap();
        let inequality =
            Discretisation::new(&ConformingP1, &scene.problem, &mesh, DataQuadrature::default())
                .unwrap()
                .inequality()
                .unwrap();
        let solution = ActiveSet::default().solve(&inequality);
        assert_eq!(solution.outcome, Outcome::Converged);
        let nodes = mesh.vertices().iter().zip(&solution.values);
        let errors: Vec<f64> = nodes.map(|(x, u)| (u - exact.value.at(x)).abs()).collect();
        let ours = errors.iter().sum::<f64>() / errors.len() as f64;
        checks.printed(&format!("N = {points}, mean"), ours, mean, 0.5);
        let ours = errors.iter().copied().fold(0.0, f64::max);
        checks.printed(&format!("N = {points}, max"), ours, max, 0.5);
        let ours = solution.contact.iter().filter(|c| **c == Contact::Lower).count();
        checks.that(ours == active, || format!("N = {points}: {ours} in contact, not {active}"));
        // the error of the area of contact, printed for two of the meshes
        let disc = std::f64::consts::PI * 0.697_965_148_223_373_6_f64.powi(2);
        let area = 16.0 / ((points - 1) * (points - 1)) as f64 * ours as f64;
        match points {
            9 => checks.printed("area for N = 9", (area - disc) / disc, "0.47016", 0.5),
            17 => checks.printed("area for N = 17", (area - disc) / disc, "0.18430", 0.5),
            _ => {}
        }
    }
    checks.finish();
}
