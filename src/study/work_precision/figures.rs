//! Errors against what they cost, drawn.

use super::measured::Measured;
use super::reach::curves;
use super::report::WorkReport;
use crate::study::plot::{Cost, Figure, NamedCurve, cost_figure};

/// For every scene the figures `SCENE-time`, `SCENE-unknowns` and `SCENE-memory`.
pub(super) fn figures(report: &WorkReport) -> Vec<(String, Figure)> {
    let variants = report.variants();
    let mut figures = Vec::new();
    for scene in report.scenes() {
        let curves: Vec<NamedCurve<'_>> = curves(&report.rows, scene)
            .into_iter()
            .map(|(variant, levels)| NamedCurve {
                label: variant.label(&variants),
                rows: levels.into_iter().map(row).collect(),
            })
            .collect();
        for cost in [Cost::Seconds, Cost::Unknowns, Cost::Memory] {
            let name = format!("{scene}-{}", cost.name());
            figures.push((name, cost_figure(scene, &curves, cost)));
        }
    }
    figures
}

fn row(measured: &Measured) -> &crate::study::Row {
    &measured.row
}
