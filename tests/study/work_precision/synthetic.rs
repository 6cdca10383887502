//! Reports of work against precision to test with.

use crate::rows::{report, row};
use unilateral::study::{Report, Row, Seconds};

/// The row of one run of a scheme whose L2 error is `h^2` and whose time is `factor n^3`.
pub fn measured(scheme: &str, level: usize, factor: f64) -> Row {
    let mut row = row("radial-2d", scheme, level);
    let n = level as f64;
    row.error.l2 = Some(n.powi(-2));
    row.peak_memory_bytes = Some(1_000_000 * (level * level) as u64);
    let total = factor * n.powi(3);
    row.seconds = Seconds::new(0.0, 0.25 * total, 0.75 * total);
    row.seconds.start = Some(0.25 * total);
    row.runs = Some(vec![total]);
    row
}

/// P1 takes `n^3` microseconds, SIPG three times and WOPSIP four and a half times that; WOPSIP was
/// run on one level less.
pub fn synthetic() -> Report {
    let of = [
        ("p1", 1e-6, &[8, 16, 32][..]),
        ("sipg", 3e-6, &[8, 16, 32]),
        ("wopsip", 4.5e-6, &[8, 16]),
    ];
    let rows = of.into_iter().flat_map(|(scheme, factor, levels)| {
        levels.iter().map(move |&level| measured(scheme, level, factor))
    });
    report(rows.collect())
}
