//! The sweeps of a stability study, drawn: errors and condition numbers over a parameter.

use super::cases::STABILITY_CASES;
use super::row::{StabilityRow, Verdict};
use crate::plot::{Figure, SweepPoint, sweep_figure};
use crate::study::row::distinct;

/// Whether a quantity is not just yes or no.
fn is_number(rows: &[StabilityRow], quantity: &str) -> bool {
    let figures = rows.iter().filter(|r| r.quantity == quantity).filter_map(|r| r.measured);
    figures.into_iter().any(|figure| figure != 0.0 && figure != 1.0)
}

/// A figure for each case with sweeps, with its name. A panel shows one quantity on one problem: the
/// error or condition number itself where a row has it, otherwise the figure with its limits.
pub(crate) fn figures(rows: &[StabilityRow]) -> Vec<(String, Figure)> {
    let mut figures = Vec::new();
    for case in STABILITY_CASES {
        let swept: Vec<&StabilityRow> = rows
            .iter()
            .filter(|r| r.case == case && r.value.is_some_and(|x| x > 0.0))
            .filter(|r| r.verdict != Verdict::NotApplicable)
            .filter(|r| is_number(rows, &r.quantity))
            .collect();
        let points = swept.iter().map(|r| {
            let is_underlying = !r.underlying_quantity.is_empty();
            let quantity = if is_underlying { &r.underlying_quantity } else { &r.quantity };
            SweepPoint {
                title: match &r.precision[..] {
                    "f64" => r.problem.clone(),
                    precision => format!("{} {precision}", r.problem),
                },
                axes: [r.parameter.clone(), quantity.clone()],
                series: r.series(),
                at: r.value.unwrap_or(f64::NAN),
                value: if is_underlying { r.underlying } else { r.measured },
                limit: r.expected.at_most.filter(|_| !is_underlying),
            }
        });
        let points = distinct(points);
        if let Some(figure) = sweep_figure(&points) {
            figures.push((format!("stability-{case}"), figure));
        }
    }
    figures
}
