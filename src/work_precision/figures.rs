//! Errors against what they cost, drawn.

use super::measured::{Measured, variants};
use super::work_at_error::curves;
use crate::plot::{Cost, Figure, NamedCurve, cost_figure};

/// The figures `SCENE-time` and `SCENE-unknowns` of a scene.
pub(crate) fn figures(rows: &[Measured], scene: &str) -> Vec<(String, Figure)> {
    let variants = variants(rows);
    let curves: Vec<NamedCurve<'_>> = curves(rows, scene)
        .into_iter()
        .map(|(variant, levels)| NamedCurve {
            label: variant.name_among(&variants),
            rows: levels.into_iter().map(|m| &m.row).collect(),
        })
        .collect();
    let figure =
        |cost: Cost| (format!("{scene}-{}", cost.name()), cost_figure(scene, &curves, cost));
    [Cost::Seconds, Cost::Unknowns].map(figure).into()
}
