//! Contact sets do not depend on the linear solver.

use unilateral::algebra::{Contact, Inequality};
use unilateral::assemble::DataQuadrature;
use unilateral::in_its_dimension;
use unilateral::inequality::{ActiveSet, InequalitySolver, Solution};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::scenes::{Scene, catalogue};
use unilateral::scheme::{SchemeOptions, scheme_by_name};

/// The band in which states may differ: the tolerance of the linear systems of a Krylov method.
const BAND: f64 = 1e-10;

/// The distance of an unknown from a change of its contact state, relative to the energy norm of the
/// solution: its gap times the square root of its diagonal entry, or its multiplier divided by it.
fn margin(
    (q, load): (&Inequality<f64>, &[f64]),
    u: &Solution<f64>,
    i: usize,
    energy_norm: f64,
) -> f64 {
    let d = q.matrix.get(i, i);
    let value = u.values[i];
    let margin = match u.contact[i] {
        Contact::Inactive => {
            let gap = |bound: Option<f64>| bound.map_or(f64::INFINITY, |b| (value - b).abs());
            gap(q.bounds[i].lower()).min(gap(q.bounds[i].upper())) * d.sqrt()
        }
        _ => (q.matrix.row_dot_f64(i, &u.values) - load[i]).abs() / d.sqrt(),
    };
    margin / energy_norm
}

/// Solves by factors and by a Krylov method; states may differ only within ten bands. Returns the number of
/// unknowns in contact.
fn check<const D: usize>(scene: &Scene<D>, scheme: &str, level: usize) -> usize {
    let mesh = scene.domain.mesh(level).unwrap();
    let what = format!("{} {scheme}", scene.name);
    let scheme = scheme_by_name::<D>(scheme, &SchemeOptions::default()).unwrap();
    let q = scheme.inequality(&scene.problem, &mesh, DataQuadrature::default()).unwrap();
    let [a, b] = [LinearMethod::Direct, LinearMethod::Iterative]
        .map(|linear| ActiveSet::default().linear(linear).solve(&q));
    assert_eq!(a.outcome, b.outcome, "{what}");
    let energy: f64 = (0..q.size()).map(|i| a.values[i] * q.matrix.row_dot_f64(i, &a.values)).sum();
    let load = q.assembled_load();
    for i in 0..q.size() {
        let largest = [&a, &b].map(|u| margin((&q, &load), u, i, energy.sqrt()));
        let largest = largest[0].max(largest[1]);
        assert!(
            a.contact[i] == b.contact[i] || largest <= 10.0 * BAND,
            "{what}: unknown {i}: {largest:e}"
        );
    }
    a.contact.iter().filter(|&&state| state != Contact::Inactive).count()
}

/// Every scene of the catalogue that is strictly complementary, at the level of its dimension; some of them are
/// open everywhere.
fn check_catalogue(schemes: &[&str], levels: [usize; 3]) {
    let mut scenes_in_contact = 0;
    for entry in catalogue() {
        let level = levels[entry.dimension - 1];
        let scene = entry.make(&Default::default()).unwrap();
        let is_strict = in_its_dimension!(&scene, |scene| scene.regularity.strictly_complementary);
        if !is_strict {
            continue;
        }
        let in_contact = schemes
            .iter()
            .map(|scheme| in_its_dimension!(&scene, |scene| check(scene, scheme, level)));
        scenes_in_contact += usize::from(in_contact.sum::<usize>() > 0);
    }
    assert!(scenes_in_contact > 20, "{scenes_in_contact} scenes");
}

#[test]
fn contact_sets_do_not_depend_on_the_linear_solver() {
    check_catalogue(&["p1", "cr", "sipg", "wopsip"], [32, 8, 2]);
    for scene in [scenes::lshape_2d(), scenes::hertz_2d(), scenes::radial::<2>(1.0)] {
        for scheme in ["nipg", "br2", "p2"] {
            check(&scene, scheme, 16);
        }
    }
}

#[test]
#[ignore = "takes three minutes"]
fn contact_sets_of_all_schemes_do_not_depend_on_the_linear_solver() {
    let schemes: Vec<&str> = unilateral::scheme::SCHEMES.iter().map(|scheme| scheme.0).collect();
    check_catalogue(&schemes, [64, 16, 4]);
}
