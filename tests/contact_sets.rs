//! Multipliers and contact sets of discrete solutions against the exact ones.

mod support;

use support::accuracy::{Boxed, Checks, all_schemes, label, rows};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

fn show<const D: usize>(scene: Scene<D>, levels: &[usize]) {
    for row in rows::<f64, D>(scene, all_schemes::<f64, D>(), levels.to_vec()) {
        eprintln!(
            "{} {} mult {:?} order {:?} area {:?} dist/h {:?}",
            label(&row),
            row.status,
            row.contact.multiplier_l2,
            row.order.multiplier_l2,
            row.contact.contact_area_error,
            row.contact.free_boundary_distance.map(|d| d / row.mesh_size)
        );
    }
}

#[test]
fn measure_radial() {
    show(scenes::radial::<2>(1.0), &[8, 16, 32, 64]);
}
#[test]
fn measure_ball() {
    show(scenes::ball_2d(), &[8, 16, 32]);
}
#[test]
fn measure_others() {
    show(scenes::signorini_2d(), &[8, 16, 32, 64]);
    show(scenes::hertz_2d(), &[8, 16, 32, 64]);
    show(scenes::radial::<1>(1.0), &[16, 32, 64, 128]);
    show(scenes::radial::<3>(1.0), &[4, 8]);
}
