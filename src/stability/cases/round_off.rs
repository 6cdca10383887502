//! Over-penalty and rounding: Poisson on meshes fine enough for it to show.

use crate::error::Error;
use crate::real::Precision;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{rows_in, sines};
use crate::study::Row;

/// The largest factor between errors of a mesh and of the coarser one.
const HALVING: f64 = 0.3;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let one = Penalty::Eta(1.0);
    let further = [Choice::new("wopsip", one), Choice::new("wopsip:facet-means", one)];
    let (strings, squares) = (plan.pick_of(7, 10, 15), plan.pick_of(4, 5, 7));
    for choice in plan.compared_and(&further) {
        plan.add("round-off", choice, "string f64", move |c, sink| {
            sweep::<1>(c, (strings, Precision::Double), sink)
        });
        plan.add("round-off", choice, "string f32", move |c, sink| {
            sweep::<1>(c, (strings.min(12), Precision::Single), sink)
        });
        plan.add("round-off", choice, "square f32", move |c, sink| {
            sweep::<2>(c, (squares, Precision::Single), sink)
        });
        plan.add("round-off", choice, "square f64", move |c, sink| {
            sweep::<2>(c, (squares, Precision::Double), sink)
        });
    }
}

/// Halves the mesh size from four subdivisions on.
fn sweep<const D: usize>(
    choice: &Choice,
    (finest, precision): (u32, Precision),
    sink: Sink<'_>,
) -> Result<(), Error> {
    let levels: Vec<usize> = (2..=finest).map(|k| 2_usize.pow(k)).collect();
    let error = |row: &Row| row.error.l2;
    let rounding = 0.5 * precision.epsilon();
    let barrier = 4.0 * rounding.powf(1.0 / 6.0);
    let floor = rounding.powf(0.25);
    let mut coarser: Option<Row> = None;
    for &level in &levels {
        let row = rows_in::<D>(precision, sines(), choice, &[level])?.swap_remove(0);
        let size = 1.0 / level as f64;
        if let Some(before) = &coarser {
            let ratio = quotient(of(&row, error), of(before, error));
            let claim = |name| {
                RowBuilder::new(name, choice)
                    .on(&row.scene)
                    .precision(precision.name())
                    .level(level)
                    .at("h", size)
                    .quantity("L2 error over that on twice h")
                    .underlying("L2 error", of(&row, error))
                    .detail(figures(&row))
                    .at_most(HALVING)
            };
            if choice.penalty == Penalty::Eta(1.0)
                && choice.scheme == "wopsip"
                && 2.0 * size >= barrier
            {
                sink(claim("halving-above-barrier").measured(ratio));
            }
            let claim = claim("halving-to-floor");
            // quadratics reach the floor of rounding with their higher order long before
            let is_judged = size >= floor && !choice.scheme.starts_with("p2");
            sink(if is_judged { claim } else { claim.only_reported() }.measured(ratio));
        }
        coarser = Some(row);
    }
    Ok(())
}
