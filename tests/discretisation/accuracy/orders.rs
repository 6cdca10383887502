//! Observed orders of convergence.

use crate::runs::own_scene;
use crate::support::checks::Checks;
use crate::support::rows::{label, rows};
use crate::support::scheme_lists::all_schemes;
use unilateral::mesh::BoundaryCondition;
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// Where observed orders may lie.
#[derive(Clone, Copy)]
struct Bands {
    h1: [f64; 2],
    l2: [f64; 2],
}

/// The bands of figures that are asymptotic.
const TIGHT: Bands = Bands { h1: [0.95, 1.05], l2: [1.85, 2.15] };

fn lies_in(order: f64, [low, high]: [f64; 2]) -> bool {
    low <= order && order <= high
}

/// Orders of the finest of these rows against the one before, and what theory promises.
fn check_orders(checks: &mut Checks, rows: &[Row], bands: Bands) {
    let finest = rows.iter().map(|row| row.level).max().unwrap();
    for row in rows {
        checks.certified(row, 1e-9);
    }
    for row in rows.iter().filter(|row| row.level == finest) {
        let of = |order: Option<f64>| order.unwrap_or(f64::NAN);
        let [h1, l2] = [of(row.order.h1), of(row.order.l2)];
        let holds = lies_in(h1, bands.h1) && lies_in(l2, bands.l2);
        checks.that(holds, || format!("{}: H1 {h1:.3}, L2 {l2:.3}", label(row)));
        let expected = row.expected_order;
        for (name, observed, promised, band, limit) in
            [("H1", h1, expected.h1, bands.h1, 1.0), ("L2", l2, expected.l2, bands.l2, 2.0)]
        {
            let Some(promised) = promised else { continue };
            let holds = lies_in(promised, band) && observed > promised - (limit - band[0]);
            checks.that(holds, || format!("{}: {name} {observed:.3}, not {promised}", label(row)));
        }
    }
}

/// Checks the orders of every scheme on a scene.
fn orders<const D: usize>(scene: Scene<D>, levels: &[usize], bands: Bands) {
    let mut checks = Checks::default();
    check_orders(&mut checks, &rows::<D>(scene, all_schemes(), levels.to_vec()), bands);
    checks.finish();
}

#[test]
fn radial_obstacle_in_the_plane() {
    orders(scenes::radial::<2>(1.0), &[32, 64, 128], TIGHT);
}

#[test]
fn signorini_with_zero_data() {
    orders(scenes::signorini_2d(), &[16, 32, 64], TIGHT);
}

#[test]
fn signorini_harmonic_in_the_plane() {
    orders(scenes::signorini_harmonic::<2>(), &[16, 32, 64], TIGHT);
}

#[test]
fn hertz_contact() {
    orders(scenes::hertz_2d(), &[16, 32, 64], TIGHT);
}

/// The free boundary lies between vertices, at a place that changes with the level: errors
/// oscillate, so that orders are fitted over all levels.
#[test]
fn radial_obstacle_on_an_interval() {
    let levels = [32, 64, 128, 256, 512];
    let found = rows::<1>(scenes::radial(1.0), all_schemes(), levels);
    let mut checks = Checks::default();
    for of_scheme in found.chunks(levels.len()) {
        for row in of_scheme {
            checks.certified(row, 1e-9);
        }
        let [h1, l2] =
            [fitted(of_scheme, |row| row.error.h1), fitted(of_scheme, |row| row.error.l2)];
        let holds = lies_in(h1, TIGHT.h1) && lies_in(l2, TIGHT.l2);
        checks.that(holds, || format!("{}: H1 {h1:.3}, L2 {l2:.3}", label(&of_scheme[0])));
    }
    checks.finish();
}

/// The slope of the straight line closest to the logarithms of errors over those of mesh sizes.
fn fitted(rows: &[Row], error: impl Fn(&Row) -> Option<f64>) -> f64 {
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| (row.mesh_size.ln(), error(row).unwrap().ln())).collect();
    let n = points.len() as f64;
    let [x, y] =
        [points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n];
    let [cross, square] = points
        .iter()
        .fold([0.0; 2], |[c, s], p| [c + (p.0 - x) * (p.1 - y), s + (p.0 - x) * (p.0 - x)]);
    cross / square
}

/// In space the levels that are quick are not asymptotic: the coarsest has four cells along the
/// longest side, the finest sixteen, and the constants of several powers of the mesh size compete.
const SPACE: Bands = Bands { h1: [0.9, 1.1], l2: [1.8, 2.25] };

/// WOPSIP still less so: until cells are small against the root of its factor the error of its
/// missing consistency, of second order in H1 too, is the larger part, and orders lie above those
/// in the limit.
const SPACE_OVER_PENALISED: Bands = Bands { h1: [0.95, 1.45], l2: [1.85, 2.25] };

/// Checks the orders of every scheme on a scene in space.
fn orders_in_space(scene: Scene<3>, levels: &[usize]) {
    let mut checks = Checks::default();
    let found = rows::<3>(scene, all_schemes(), levels.to_vec());
    for of_scheme in found.chunks(levels.len()) {
        let over_penalised = of_scheme[0].scheme == "wopsip";
        let bands = if over_penalised { SPACE_OVER_PENALISED } else { SPACE };
        check_orders(&mut checks, of_scheme, bands);
    }
    checks.finish();
}

#[test]
fn radial_obstacle_in_space() {
    orders_in_space(scenes::radial::<3>(1.0), &[3, 6, 12]);
}

#[test]
#[ignore = "takes a minute"]
fn radial_obstacle_in_space_on_a_finer_mesh() {
    orders_in_space(scenes::radial::<3>(1.0), &[4, 8, 16]);
}

#[test]
fn signorini_harmonic_in_space() {
    orders_in_space(scenes::signorini_harmonic::<3>(), &[2, 4, 8]);
}

fn unit_box<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// Coefficient 3, reaction `1 + x`, Dirichlet data at the lower end of the first axis, Neumann data
/// elsewhere, neither of them zero; the solution is the exponential of the mean of `2x - x_0`.
fn mixed<const D: usize>() -> Scene<D> {
    let slope = |k: usize| if k == 0 { 1.0 } else { 2.0 } / D as f64;
    let value = move |x: &Point<D>| (0..D).map(|k| slope(k) * x[k]).sum::<f64>().exp();
    let gradient = move |x: &Point<D>| Point::from_fn(|k, _| slope(k)) * value(x);
    let reaction = |x: &Point<D>| 1.0 + x[0];
    let squares: f64 = (0..D).map(|k| slope(k) * slope(k)).sum();
    let load = move |x: &Point<D>| (reaction(x) - 3.0 * squares) * value(x);
    let problem =
        Problem::new().source(load).coefficient(|_| 3.0).reaction(reaction).exact(value, gradient);
    let mut domain = unit_box();
    for axis in 0..D {
        for end in 0..2 {
            if (axis, end) != (0, 0) {
                domain = domain.side(axis, end, BoundaryCondition::Neumann);
            }
        }
    }
    own_scene("mixed", domain, problem)
}

#[test]
fn smooth_solutions() {
    orders(scenes::sines::<1>(), &[64, 128], TIGHT);
    orders(scenes::sines::<2>(), &[32, 64], TIGHT);
    orders_in_space(scenes::sines::<3>(), &[6, 12]);
}

#[test]
fn neumann_data_with_coefficient_and_reaction() {
    orders(mixed::<1>(), &[64, 128], TIGHT);
    orders(mixed::<2>(), &[32, 64], TIGHT);
    orders_in_space(mixed::<3>(), &[6, 12]);
}
