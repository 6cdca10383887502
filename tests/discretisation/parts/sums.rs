//! Certificates and errors that parts merge.

use super::compare::{Assembled, some_values};
use super::meshes::{box_mesh, moved};
use super::problems::{obstacle_problem, schemes, signorini_problem};
use std::sync::Arc;
use unilateral::inequality::{Certificate, certify};
use unilateral::measure::Errors;
use unilateral::prelude::*;
use unilateral::processes::{Exchange, InProcess, in_process};

const ROUNDING: f64 = 1e-14;

/// Rules of quadrature may differ, too, but their results by less.
const RULES: f64 = 2e-14;

#[track_caller]
fn close(merged: f64, serial: f64, tolerance: f64, label: &str) {
    assert!(
        (merged - serial).abs() <= tolerance * serial.abs(),
        "{label}: merged {merged:e}, serial {serial:e}"
    );
}

fn numbers(certificate: &Certificate) -> [f64; 4] {
    let Certificate { feasibility, multiplier, complementarity, residual, .. } = *certificate;
    [feasibility, multiplier, complementarity, residual]
}

/// What one part finds for values: certificate and errors.
type Merged = (Certificate, Errors);

/// What the parts find, each in a thread of its own; all find the same bits.
fn merged<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    (parts, x): (usize, &[f64]),
) -> Merged {
    let whole = Assembled::new(scheme, problem, mesh);
    let of_part = |number, exchange: &Arc<InProcess>| -> Merged {
        let exchange: Arc<dyn Exchange> = exchange.clone();
        let layers = scheme.layers(mesh);
        let hierarchy = Hierarchy::of_parts(mesh, 0, layers, (number, &exchange)).unwrap();
        let part = hierarchy.part(0).unwrap();
        let on_part = Assembled::new(scheme, problem, &part.mesh);
        let numbers = whole.numbers_of(part, &on_part.discretisation);
        let u: Vec<f64> = numbers.iter().map(|&k| x[k]).collect();
        let judged = NestedIteration::new(problem, &hierarchy).judge_on(0, scheme, &u).unwrap();
        (judged.certificate(), judged.errors().unwrap())
    };
    let mut found = in_process(parts, of_part);
    assert!(found.iter().all(|of| *of == found[0]));
    found.swap_remove(0)
}

/// Merged and serial numbers of every scheme, for values of any size.
fn every_scheme<const D: usize>(mesh: &Mesh<D>, parts: usize) {
    for entry in schemes::<D>() {
        let [obstacle, signorini] =
            [obstacle_problem(), signorini_problem()].map(|problem| problem.on(entry.set.clone()));
        let problems = [(&obstacle, 1.0), (&obstacle, 1e-200), (&signorini, 1e3)];
        for (problem, unit) in problems {
            let label = entry.label_on(problem.constraint_set());
            let whole = Assembled::new(&*entry.scheme, problem, mesh);
            let inequality = &whole.inequality;
            let x: Vec<f64> = some_values(inequality.size()).iter().map(|x| unit * x).collect();
            let (certificate, errors) = merged(&*entry.scheme, problem, mesh, (parts, &x));
            let serial = certify(inequality, &x);
            let pairs = numbers(&certificate).into_iter().zip(numbers(&serial));
            for (k, (merged, serial)) in pairs.enumerate() {
                // parts do not have the forces of nodes, which count as multipliers
                match k == 1 && inequality.penalised.is_some() {
                    true => assert!(merged <= serial * (1.0 + ROUNDING), "{label}"),
                    false => close(merged, serial, ROUNDING, &label),
                }
            }
            if problem.exact.is_none() {
                continue;
            }
            let serial = whole.discretisation.errors(&x).unwrap();
            let of = |errors: &Errors| {
                [errors.l2, errors.h1, errors.energy, errors.broken_energy, errors.max]
            };
            for (merged, serial) in of(&errors).into_iter().zip(of(&serial)) {
                close(merged.unwrap(), serial.unwrap(), RULES, &label);
            }
        }
    }
}

#[test]
fn parts_merge_certificates_and_errors_on_an_interval() {
    every_scheme(&moved::<1>(9), 4);
}

#[test]
fn parts_merge_certificates_and_errors_in_the_plane() {
    every_scheme(&moved::<2>(4), 3);
}

#[test]
fn parts_merge_certificates_and_errors_in_space() {
    every_scheme(&box_mesh::<3>(2), 2);
}
