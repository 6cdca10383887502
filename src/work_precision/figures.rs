//! Errors against what they cost, drawn.

use super::measured::{Measured, variants};
use super::work_at_error::curves;
use crate::plot::{Cost, Figure, NamedCurve, cost_figure};

/// The figures `SCENE-time`, `SCENE-unknowns` and `SCENE-memory` of a scene. Memory is that above the
/// memory of an empty run.
pub(crate) fn figures(
    rows: &[Measured],
    scene: &str,
    empty_memory: Option<u64>,
) -> Vec<(String, Figure)> {
    let variants = variants(rows);
    let mut rows = rows.to_vec();
    for m in &mut rows {
        let above = |peak: u64| peak.saturating_sub(empty_memory.unwrap_or(0));
        m.row.peak_memory_bytes = m.row.peak_memory_bytes.map(above);
    }
    let rows = &rows[..];
    let curves: Vec<NamedCurve<'_>> = curves(rows, scene)
        .into_iter()
        .map(|(variant, levels)| NamedCurve {
            label: variant.name_among(&variants),
            rows: levels.into_iter().map(|m| &m.row).collect(),
        })
        .collect();
    let figure =
        |cost: Cost| (format!("{scene}-{}", cost.name()), cost_figure(scene, &curves, cost));
    [Cost::Seconds, Cost::Unknowns, Cost::Memory].map(figure).into()
}
