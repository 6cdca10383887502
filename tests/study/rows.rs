//! Rows to report, for the tests of reports.

use unilateral::facet::PenaltyParameters;
use unilateral::inequality::Certificate;
use unilateral::measure::{ContactErrors, Errors};
use unilateral::scheme::ExpectedOrders;
use unilateral::study::{Iterations, Orders, Program, Report, Row, Seconds, fill_orders};

/// A row with errors of order 2 and 1.
pub fn row(scene: &str, scheme: &str, level: usize) -> Row {
    let h = 1.0 / level as f64;
    Row {
        scene: scene.into(),
        dimension: 2,
        scheme: scheme.into(),
        constraint: "vertices".into(),
        level,
        parameters: PenaltyParameters { sigma: Some(6.5), eta: None, rule: Some("proven".into()) },
        solver: "active-set".into(),
        linear: "direct".into(),
        cells: 2 * level * level,
        unknowns: 6 * level * level,
        nonzeros: 70 * level * level,
        mesh_size: h,
        status: "converged".into(),
        error: Errors {
            l2: Some(0.7 * h * h),
            h1: Some(2.0 * h),
            energy: None,
            max: Some(0.1 * h),
        },
        contact: ContactErrors {
            multiplier_l1: Some(0.3 * h),
            multiplier_l2: Some(0.5 * h.sqrt()),
            contact_area_error: Some(0.2 * h),
            free_boundary_distance: None,
        },
        order: Orders::default(),
        expected_order: ExpectedOrders { l2: Some(2.0), h1: Some(1.0) },
        objective: Some(-0.1 - h / 3.0),
        active: Some(level),
        iterations: Iterations { outer: Some(3), linear: 0, levels: 1 },
        certificate: Certificate::new([0.0, 1e-16, 0.0, 2.5e-15]),
        seconds: Seconds { mesh: 1e-4, assemble: 2e-4, solve: 0.0125, total: 0.0128 },
        peak_memory_bytes: Some(12_345_678),
        warnings: Vec::new(),
    }
}

/// Two scenes, three schemes, three levels.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for scene in ["radial-2d", "signorini-2d"] {
        for scheme in ["p1", "sipg", "wopsip"] {
            rows.extend([8, 16, 32].map(|level| row(scene, scheme, level)));
        }
    }
    fill_orders(&mut rows);
    rows
}

/// A report of rows.
pub fn report(rows: Vec<Row>) -> Report {
    Report { program: Program::new("compare", "f64", 2, 1), rows }
}
