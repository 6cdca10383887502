//! Strings over parabolas: the data of a paper on multilevel methods.

use crate::support::checks::Checks;
use unilateral::algebra::{Bound, Contact, Start};
use unilateral::assemble::Discretisation;
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::scenes::Scene;

/// Contact of the nodes of the mesh with twice as many cells: a new node touches if both its
/// neighbours do.
fn refined(coarse: &[Contact]) -> Vec<Contact> {
    let mut fine = vec![Contact::Inactive; 2 * coarse.len() - 1];
    for (k, pair) in coarse.windows(2).enumerate() {
        fine[2 * k] = pair[0];
        fine[2 * k + 1] = if pair[0] == pair[1] { pair[0] } else { Contact::Inactive };
    }
    fine
}

/// Root of `h` times the sum of squares of nodal errors for `2^(J+1)` cells, `J` = 2 to 14, the
/// load `h f` at each node.
fn nodal_errors(checks: &mut Checks, scene: &Scene<1>) -> Vec<f64> {
    let problem = &scene.problem;
    let exact = problem.exact.as_ref().unwrap();
    let load = problem.source.everywhere.as_ref().unwrap();
    let mut start = Vec::new();
    (2..=14)
        .map(|j| {
            let cells = 1 << (j + 1);
            let h = 1.0 / f64::from(cells);
            let mesh = Mesh::<1>::kuhn_box(&scene.domain.bounding_box(), [cells as usize]);
            let mesh = mesh.unwrap();
            let mut inequality =
                Discretisation::new(&ConformingP1, problem, &mesh, Default::default())
                    .unwrap()
                    .inequality()
                    .unwrap();
            inequality.load = mesh.vertices().iter().map(|x| h * load.at(x)).collect();
            if !start.is_empty() {
                inequality.start = Start::Contact(refined(&start));
            }
            let solution = ActiveSet::default().solve(&inequality);
            let (outcome, outer) = (solution.outcome, solution.outer);
            checks.that(outcome == Outcome::Converged && outer <= 10, || {
                format!("{}, J = {j}: {outcome} after {outer} steps", scene.name)
            });
            let nodes = mesh.vertices().iter().zip(&solution.values);
            let squares: f64 = nodes.map(|(x, u)| (u - exact.value.at(x)).powi(2)).sum();
            // the ends, which are pinned, count as touching: contact reaches them
            let touch = |(state, bound): (Contact, &Bound<f64>)| match bound {
                Bound::Fixed(_) => Contact::Lower,
                _ => state,
            };
            start = solution.contact.into_iter().zip(&inequality.bounds).map(touch).collect();
            (h * squares).sqrt()
        })
        .collect()
}

/// The errors of the exact discrete solutions, computed in rational numbers (parabolas with the
/// right values at the first node of contact), to every digit; and those of the paper, whose
/// iteration stopped at a tolerance of 1e-8, as far as they are larger than that.
///
/// E. Bueler, mg-glaciers, the data of its paper on multilevel methods in one dimension, the
/// "traditional" problem.
#[test]
fn the_string_pressed_onto_a_parabola() {
    let discrete = [
        "5.8231e-3",
        "2.0485e-3",
        "4.3549e-4",
        "1.1826e-4",
        "2.8380e-5",
        "7.2423e-6",
        "1.7921e-6",
        "4.5033e-7",
        "1.1230e-7",
        "2.8110e-8",
        "7.0230e-9",
        "1.7563e-9",
        "4.3901e-10",
    ];
    let paper = [
        "5.8231e-3",
        "2.0485e-3",
        "4.3550e-4",
        "1.1826e-4",
        "2.8384e-5",
        "7.2444e-6",
        "1.7941e-6",
        "4.5170e-7",
        "1.1308e-7",
        "2.8832e-8",
    ];
    let mut checks = Checks::default();
    let errors = nodal_errors(&mut checks, &scenes::parabola_1d());
    for (k, (&ours, printed)) in errors.iter().zip(discrete).enumerate() {
        checks.printed(&format!("J = {}", k + 2), ours, printed, 0.5);
    }
    for (k, (&ours, printed)) in errors.iter().zip(paper).enumerate() {
        checks.printed_within(&format!("J = {} in the paper", k + 2), ours, printed, 1e-8);
    }
    checks.finish();
}

/// The "icelike" problem of the same data, where the error of the iteration does not show: its
/// figures to the last digit.
#[test]
fn the_string_held_down_near_its_ends() {
    let paper = [
        "4.8997e-2",
        "2.6793e-2",
        "4.8435e-3",
        "9.8377e-3",
        "1.6172e-3",
        "2.2561e-3",
        "3.7742e-4",
        "5.7662e-4",
        "9.6016e-5",
        "1.4337e-4",
        "2.3900e-5",
        "3.5891e-5",
        "5.9815e-6",
    ];
    let mut checks = Checks::default();
    let errors = nodal_errors(&mut checks, &scenes::icelike_1d());
    for (k, (&ours, printed)) in errors.iter().zip(paper).enumerate() {
        checks.printed(&format!("J = {}", k + 2), ours, printed, 0.5);
    }
    checks.finish();
}
