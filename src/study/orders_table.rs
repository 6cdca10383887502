//! Observed and promised orders, as a table in Markdown.

use std::fmt::Write;

use crate::measure::ErrorNorm;
use crate::study::order_check::{ObservedOrders, PROMISED, order_in};

/// The cell of a number that does not apply.
const NONE: &str = "-";

/// One line for every scheme on every scene: where bounds are imposed, the levels, observed and
/// promised order in L2 and H1, and whether the promises were kept.
///
/// The verdict is `kept` or, by norm, `missed`; `exact` where errors are rounding; `nothing
/// promised` where nothing is proven, and
/// `unobserved` where fewer than two levels converged. Levels that did not converge follow with the
/// outcome of their solves.
pub fn orders_table(orders: &[ObservedOrders], tolerance: f64) -> String {
    let mut text = format!(
        "Orders are observed on the two finest levels that converged. A promise is kept if the \
         observed order is at least the promised one less {tolerance}.\n\n\
         | scene | scheme | bounds at | levels | L2 | promised | H1 | promised | verdict |\n\
         |---|---|---|---|---|---|---|---|---|\n"
    );
    for line in orders {
        let levels = line.levels.map_or(NONE.to_owned(), |[a, b]| format!("{a}, {b}"));
        let norms: Vec<String> = PROMISED
            .iter()
            .map(|norm| {
                let observed =
                    order_in(*norm, &line.observed).map_or(NONE.to_owned(), |x| format!("{x:.2}"));
                let promised =
                    order_in(*norm, &line.promised).map_or(NONE.to_owned(), |x| x.to_string());
                format!("{observed} | {promised}")
            })
            .collect();
        // writing to a string does not fail
        let _ = writeln!(
            text,
            "| {} | {} | {} | {levels} | {} | {} |",
            line.scene,
            line.scheme,
            line.constraint,
            norms.join(" | "),
            verdict(line, tolerance)
        );
    }
    text
}

fn verdict(line: &ObservedOrders, tolerance: f64) -> String {
    let missed = |norm: &ErrorNorm| {
        let promised = order_in(*norm, &line.promised).filter(|_| !line.exact.contains(norm))?;
        let kept = order_in(*norm, &line.observed)? >= promised - tolerance;
        (!kept).then(|| norm.to_string())
    };
    let promised =
        |norm: &ErrorNorm| order_in(*norm, &line.promised).is_some() && !line.exact.contains(norm);
    let unobserved = |norm: &ErrorNorm| promised(norm) && order_in(*norm, &line.observed).is_none();
    let missed: Vec<String> = PROMISED.iter().filter_map(missed).collect();
    let mut parts = vec![if !line.exact.is_empty() && !PROMISED.iter().any(promised) {
        "exact".to_owned()
    } else if !PROMISED.iter().any(promised) {
        "nothing promised".to_owned()
    } else if !missed.is_empty() {
        format!("missed in {}", missed.join(", "))
    } else if PROMISED.iter().any(unobserved) {
        "unobserved".to_owned()
    } else {
        "kept".to_owned()
    }];
    parts.extend(line.failures.iter().map(|(level, why)| format!("level {level} {why}")));
    parts.join("; ")
}
