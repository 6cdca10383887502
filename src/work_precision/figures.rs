//! Errors against what they cost, drawn.

use super::reach::curves;
use super::report::WorkReport;
use crate::plot::{Cost, Figure, NamedCurve, cost_figure};

/// The figures `SCENE-time`, `SCENE-unknowns` and `SCENE-memory` of a scene.
pub(crate) fn figures(report: &WorkReport, scene: &str) -> Vec<(String, Figure)> {
    let variants = report.variants();
    let curves: Vec<NamedCurve<'_>> = curves(&report.rows, scene)
        .into_iter()
        .map(|(variant, levels)| NamedCurve {
            label: variant.label(&variants),
            rows: levels.into_iter().map(|m| &m.row).collect(),
        })
        .collect();
    let figure =
        |cost: Cost| (format!("{scene}-{}", cost.name()), cost_figure(scene, &curves, cost));
    [Cost::Seconds, Cost::Unknowns, Cost::Memory].map(figure).into()
}
