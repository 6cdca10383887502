//! Errors against what they cost, drawn.

use super::measured::Measured;
use crate::plot::{Cost, Figure, cost_figure};
use crate::study::series::series_of;

/// The figures `SCENE-time` and `SCENE-unknowns` of a scene.
pub(crate) fn figures(rows: &[Measured], scene: &str) -> Vec<(String, Figure)> {
    let mut series = series_of(rows);
    series.retain(|of| of.variant.scene == scene);
    let figure =
        |cost: Cost| (format!("{scene}-{}", cost.name()), cost_figure(scene, &series, cost));
    [Cost::Seconds, Cost::Unknowns].map(figure).into()
}
