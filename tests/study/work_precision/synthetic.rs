//! Reports of work against precision to test with.

use crate::rows::row;
use unilateral::work_precision::{Measured, Phases, WorkReport};

/// A run of a scheme whose L2 error is `h^2` and whose time is `factor n^3`.
pub fn measured(scheme: &str, level: usize, factor: f64) -> Measured {
    let mut row = row("radial-2d", scheme, level);
    row.linear_asked = Some("direct".into());
    let n = level as f64;
    row.error.l2 = Some(n.powi(-2));
    row.peak_memory_bytes = Some(1_000_000 * (level * level) as u64);
    let total = factor * n.powi(3);
    let phases = Phases {
        mesh: 0.0,
        assemble: 0.25 * total,
        coarse: 0.25 * total,
        solve: 0.5 * total,
        bound: None,
        total,
    };
    Measured::new(row, phases)
}

/// P1 takes `n^3` microseconds, SIPG three times and WOPSIP four and a half times that; WOPSIP was
/// run on one level less.
pub fn synthetic() -> WorkReport {
    let mut report = WorkReport::new("test", 1);
    report.subject = "wopsip".into();
    for (scheme, factor, levels) in
        [("p1", 1e-6, &[8, 16, 32][..]), ("sipg", 3e-6, &[8, 16, 32]), ("wopsip", 4.5e-6, &[8, 16])]
    {
        report.rows.extend(levels.iter().map(|&level| measured(scheme, level, factor)));
    }
    report
}
