//! Rows to report, for the tests of reports.

use unilateral::facet::PenaltyParameters;
use unilateral::inequality::{Certificate, Outcome};
use unilateral::scheme::ExpectedOrders;
use unilateral::study::{Program, Report, Row, Seconds, fill_orders};

/// A row with errors of order 2 and 1.
pub fn row(scene: &str, scheme: &str, level: usize) -> Row {
    let h = 1.0 / level as f64;
    let mut row = Row::new(scene, 2, scheme, level, Outcome::Converged);
    row.constraint = "vertices".into();
    row.parameters =
        PenaltyParameters { sigma: Some(6.5), eta: None, rule: Some("proven".to_owned()) };
    row.solver = "active-set".into();
    row.linear = "direct".into();
    row.cells = 2 * level * level;
    row.unknowns = Some(6 * level * level);
    row.nonzeros = Some(70 * level * level);
    row.mesh_size = h;
    row.error.l2 = Some(0.7 * h * h);
    row.error.h1 = Some(2.0 * h);
    row.error.max = Some(0.1 * h);
    row.contact.multiplier_l1 = Some(0.3 * h);
    row.contact.multiplier_l2 = Some(0.5 * h.sqrt());
    row.contact.contact_area_error = Some(0.2 * h);
    row.expected_order = ExpectedOrders { l2: Some(2.0), h1: Some(1.0) };
    row.objective = Some(-0.1 - h / 3.0);
    row.active = Some(level);
    row.iterations.outer = Some(3);
    row.iterations.levels = 1;
    row.iterations.systems = Some(4);
    row.certificate = Certificate::new([0.0, 1e-16, 0.0, 2.5e-15]);
    row.seconds = Seconds::new(1e-4, 2e-4, 0.0125);
    row.seconds.total = 0.0128;
    row.peak_memory_bytes = Some(12_345_678);
    row
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
    Report::new(Program::new("compare", "f64", 2, 1), rows)
}
