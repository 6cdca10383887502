//! Observed orders of convergence.

mod support;

use std::f64::consts::PI;
use support::accuracy::{Checks, all_schemes, label, own_scene, rows};
use unilateral::mesh::BoundaryPart;
use unilateral::prelude::*;
use unilateral::scenes::{BoxDomain, Scene};
use unilateral::study::Row;

/// How far observed orders may lie from one in H1 and two in L2.
#[derive(Clone, Copy)]
struct Bands {
    h1: f64,
    l2: f64,
}

/// The bands of figures that are asymptotic.
const TIGHT: Bands = Bands { h1: 0.05, l2: 0.15 };

/// Orders of the finest of these rows against the one before, and what theory promises.
fn check_orders(checks: &mut Checks, rows: &[Row], bands: Bands) {
    let finest = rows.iter().map(|row| row.level).max().unwrap();
    for row in rows {
        checks.certified(row, 1e-9);
    }
    for row in rows.iter().filter(|row| row.level == finest) {
        let of = |order: Option<f64>| order.unwrap_or(f64::NAN);
        let [h1, l2] = [of(row.order.h1), of(row.order.l2)];
        let holds = (h1 - 1.0).abs() <= bands.h1 && (l2 - 2.0).abs() <= bands.l2;
        checks.that(holds, || format!("{}: H1 {h1:.3}, L2 {l2:.3}", label(row)));
        for (name, observed, promised) in
            [("H1", h1, row.expected_order.h1), ("L2", l2, row.expected_order.l2)]
        {
            let Some(promised) = promised else { continue };
            let holds = (observed - promised).abs() <= bands.h1;
            checks.that(holds, || format!("{}: {name} {observed:.3}, not {promised}", label(row)));
        }
    }
}

/// Checks the orders of every scheme on a scene.
fn orders<const D: usize>(scene: Scene<D>, levels: &[usize], bands: Bands) {
    let mut checks = Checks::default();
    check_orders(&mut checks, &rows::<f64, D>(scene, all_schemes(), levels.to_vec()), bands);
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
    let found = rows::<f64, 1>(scenes::radial(1.0), all_schemes(), levels);
    let mut checks = Checks::default();
    for of_scheme in found.chunks(levels.len()) {
        for row in of_scheme {
            checks.certified(row, 1e-9);
        }
        let [h1, l2] =
            [fitted(of_scheme, |row| row.error.h1), fitted(of_scheme, |row| row.error.l2)];
        let holds = (h1 - 1.0).abs() <= TIGHT.h1 && (l2 - 2.0).abs() <= TIGHT.l2;
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

/// In space the levels that are quick are not asymptotic. WOPSIP least so: the second order of its
/// over-penalty shows once the cells are small against the root of its factor, until when both
/// orders are larger than they will be.
const SPACE: Bands = Bands { h1: 0.15, l2: 0.3 };

#[test]
fn radial_obstacle_in_space() {
    orders(scenes::radial::<3>(1.0), &[4, 8, 16], SPACE);
}

#[test]
fn signorini_harmonic_in_space() {
    orders(scenes::signorini_harmonic::<3>(), &[4, 8, 16], SPACE);
}

fn unit_box<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// Poisson's equation with the product of sines, no constraint.
fn smooth<const D: usize>() -> Scene<D> {
    let value = |x: &Point<f64, D>| x.iter().map(|t| (PI * t).sin()).product::<f64>();
    let gradient = |x: &Point<f64, D>| {
        let factor = |k: usize, j: usize| {
            if j == k { PI * (PI * x[j]).cos() } else { (PI * x[j]).sin() }
        };
        Point::from_fn(|k, _| (0..D).map(|j| factor(k, j)).product())
    };
    let load = move |x: &Point<f64, D>| D as f64 * PI * PI * value(x);
    own_scene("smooth", unit_box(), Problem::new().source(load).exact(value, gradient))
}

/// Coefficient 3, reaction `1 + x`, Dirichlet data at the lower end of the first axis, Neumann data
/// elsewhere, neither of them zero; the solution is the exponential of the mean of `2x - x_0`.
fn mixed<const D: usize>() -> Scene<D> {
    let slope = |k: usize| if k == 0 { 1.0 } else { 2.0 } / D as f64;
    let value = move |x: &Point<f64, D>| (0..D).map(|k| slope(k) * x[k]).sum::<f64>().exp();
    let gradient = move |x: &Point<f64, D>| Point::from_fn(|k, _| slope(k)) * value(x);
    let reaction = |x: &Point<f64, D>| 1.0 + x[0];
    let squares: f64 = (0..D).map(|k| slope(k) * slope(k)).sum();
    let load = move |x: &Point<f64, D>| (reaction(x) - 3.0 * squares) * value(x);
    let mut problem = Problem::new().source(load).coefficient(|_| 3.0).exact(value, gradient);
    problem.reaction = Some(unilateral::problem::Datum::Function(Box::new(reaction)));
    let mut domain = unit_box();
    for axis in 0..D {
        for end in 0..2 {
            if (axis, end) != (0, 0) {
                domain = domain.side(axis, end, BoundaryPart::Neumann);
            }
        }
    }
    own_scene("mixed", domain, problem)
}

#[test]
fn smooth_solutions() {
    orders(smooth::<1>(), &[64, 128], TIGHT);
    orders(smooth::<2>(), &[32, 64], TIGHT);
    orders(smooth::<3>(), &[8, 16], SPACE);
}

#[test]
fn neumann_data_with_coefficient_and_reaction() {
    orders(mixed::<1>(), &[64, 128], TIGHT);
    orders(mixed::<2>(), &[32, 64], TIGHT);
    orders(mixed::<3>(), &[8, 16], SPACE);
}
