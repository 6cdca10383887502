//! Certificates and errors that parts merge.

use super::compare::{Assembled, some_values};
use super::meshes::{box_mesh, moved};
use super::problems::{obstacle_problem, schemes, signorini_problem};
use std::sync::Arc;
use unilateral::algebra::Inequality;
use unilateral::inequality::{Certificate, Violations, certify};
use unilateral::measure::Errors;
use unilateral::prelude::*;
use unilateral::processes::{InProcess, in_process, merge_all};

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

/// What one part merges: the certificates with and without jump multipliers, and the errors.
type Merged = ([Certificate; 2], Option<Errors>);

/// What the parts merge, each in a thread of its own; all find the same bits.
fn merged<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    (parts, x): (usize, &[f64]),
) -> Merged {
    let owners = mesh.partition(parts).unwrap();
    let whole = Assembled::new(scheme, problem, mesh);
    let of_part = |number, exchange: &Arc<InProcess>| -> Merged {
        let part = mesh.part(&owners, number, scheme.layers(mesh)).unwrap();
        let on_part = Assembled::new(scheme, problem, &part.mesh);
        let Assembled { discretisation, inequality } = &on_part;
        let u: Vec<f64> = whole.numbers_of(&part, discretisation).iter().map(|&k| x[k]).collect();
        let owner_of = discretisation.owners(&part.owners);
        let owns = |i: usize| owner_of[i] == number;
        let jumps = jump_multipliers(inequality, &u);
        let certificates = [&[], &jumps[..]].map(|p| {
            let own = Violations::of(inequality, &u, p, &owns);
            merge_all(&own, exchange).unwrap().certificate()
        });
        let errors = problem.exact.as_ref().map(|exact| {
            let own = discretisation.squared_errors(exact, &u, &|cell| part.owns(cell)).unwrap();
            merge_all(&own, exchange).unwrap().norms()
        });
        (certificates, errors)
    };
    let mut found = in_process(parts, of_part);
    assert!(found.iter().all(|of| *of == found[0]));
    found.swap_remove(0)
}

/// The jump multipliers that belong to values; none without penalised matrix.
fn jump_multipliers(inequality: &Inequality<f64>, u: &[f64]) -> Vec<f64> {
    inequality.penalised.as_ref().map_or(Vec::new(), |p| p.jump_multipliers(|i| u[i]))
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
            let (certificates, errors) = merged(&*entry.scheme, problem, mesh, (parts, &x));
            let jumps = jump_multipliers(inequality, &x);
            let with_jumps = Violations::of(inequality, &x, &jumps, &|_| true).certificate();
            let alone = Violations::of(inequality, &x, &[], &|_| true).certificate();
            let serial = [alone, with_jumps];
            for (merged, serial) in certificates.iter().zip(&serial) {
                for (merged, serial) in numbers(merged).into_iter().zip(numbers(serial)) {
                    close(merged, serial, ROUNDING, &label);
                }
            }
            let Some(errors) = errors else { continue };
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

/// A part without values and data changes nothing, and one that is not finite, or has another number of values, makes the
/// certificate of all infinite.
#[test]
fn numbers_that_are_not_finite_merge() {
    let mesh = box_mesh::<1>(8);
    let problem = Problem::new();
    let Assembled { inequality, .. } = Assembled::new(&ConformingP1, &problem, &mesh);
    let mut u = vec![0.0; inequality.size()];
    let of = |u: &[f64], own: std::ops::Range<usize>| {
        Violations::of(&inequality, u, &[], &|i| own.contains(&i))
    };
    u[1] = 1e-100;
    let certificate = of(&u, 0..3).merge(of(&u, 3..9)).certificate();
    assert_eq!(certificate, certify(&inequality, &u));
    assert!(certificate.residual > 0.1 && certificate.residual.is_finite());
    let short = of(&u[..8], 0..3);
    assert_eq!(of(&u, 3..9).merge(short).certificate(), Certificate::INVALID);
    u[2] = f64::NAN;
    assert_eq!(of(&u, 0..3).merge(of(&u, 5..9)).certificate(), Certificate::INVALID);
}
