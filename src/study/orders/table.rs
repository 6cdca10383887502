//! Observed and promised orders, as tables in Markdown.

use std::fmt::Write;

use super::check::{ObservedOrders, OrderVerdict, PROMISED, levels_in_words, order_in_words};
use crate::measure::{ErrorNorm, FittedOrder};
use crate::study::row::distinct;

/// The cell of a number that does not apply.
const NONE: &str = "-";

/// What the words of the tables mean.
fn reading(tolerance: f64) -> String {
    format!(
        "An order is the exponent of the power of the mesh size that is closest to the errors of all \
         levels that converged, by least squares of logarithms; `±` is one standard error, half of the \
         spread. A promise is `kept` if the order is at least the promised one less {tolerance} and half \
         the spread, `undecided` if the spread exceeds 0.3 and that limit lies inside of it or if the \
         orders from level to level rise and one more rise like the last reaches it, `missed` \
         otherwise; with fewer than four levels there is no verdict.\n\n"
    )
}

/// One line for every scheme on every scene: where bounds are imposed, the levels, observed and
/// promised order in L2 and H1, and the verdict.
///
/// The verdict is that of all norms, or the norms follow it; `exact` where errors are rounding.
/// Levels that did not converge follow with the outcome of their solves.
pub fn orders_table(orders: &[ObservedOrders], tolerance: f64) -> String {
    let mut text = reading(tolerance)
        + "| scene | scheme | bounds at | levels | L2 | promised | H1 | promised | verdict |\n\
           |---|---|---|---|---|---|---|---|---|\n";
    for line in orders {
        let norms = PROMISED.map(|norm| {
            format!("{} | {}", observed(line.fitted(norm)), promised(line.promised(norm)))
        });
        // writing to a string does not fail
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            line.scene,
            line.label,
            line.constraint,
            levels_in_words(&line.levels),
            norms.join(" | "),
            verdicts(line, tolerance)
        );
    }
    text
}

/// How many promises each scheme keeps, and every promise that it was not seen to keep, with the orders
/// from level to level beside the fitted one; then the levels that did not converge.
pub fn orders_summary(orders: &[ObservedOrders], tolerance: f64) -> String {
    let heads = OrderVerdict::ALL.map(OrderVerdict::name).join(" | ");
    let mut text = reading(tolerance)
        + &format!("| scheme | {heads} |\n|---{}|\n", "|--:".repeat(OrderVerdict::ALL.len()));
    let count = |wanted: &dyn Fn(&ObservedOrders) -> bool, verdict| {
        let lines = orders.iter().filter(|line| wanted(line));
        let verdicts = lines.flat_map(|o| PROMISED.map(|norm| o.verdict(norm, tolerance)));
        verdicts.filter(|v| *v == verdict).count().to_string()
    };
    for label in distinct(orders.iter().map(|line| &line.label)) {
        let counts = OrderVerdict::ALL.map(|v| count(&|line| line.label == *label, v));
        let _ = writeln!(text, "| {label} | {} |", counts.join(" | "));
    }
    let all = OrderVerdict::ALL.map(|v| count(&|_| true, v));
    let _ = writeln!(text, "| all | {} |", all.join(" | "));
    text += "\n| scene | scheme | norm | levels | order | promised | level to level | verdict |\n\
             |---|---|---|---|---|---|---|---|\n";
    for missed in orders.iter().flat_map(|line| line.missed(tolerance)) {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            missed.scene,
            missed.label,
            missed.norm,
            levels_in_words(&missed.levels),
            observed(missed.fitted.as_ref()),
            missed.promised,
            missed.fitted.as_ref().map_or(NONE.to_owned(), local_orders),
            missed.verdict.name(),
        );
    }
    let failures: Vec<String> = orders.iter().flat_map(failures).collect();
    if !failures.is_empty() {
        let _ = writeln!(text, "\nLevels that did not converge: {}.", failures.join("; "));
    }
    text
}

fn observed(fitted: Option<&FittedOrder>) -> String {
    fitted.map_or(NONE.to_owned(), order_in_words)
}

fn local_orders(fitted: &FittedOrder) -> String {
    fitted.local.iter().map(|order| format!("{order:.2}")).collect::<Vec<_>>().join(", ")
}

fn promised(order: Option<f64>) -> String {
    order.map_or(NONE.to_owned(), |order| order.to_string())
}

fn failures(line: &ObservedOrders) -> Vec<String> {
    let of = |(level, why): &(usize, _)| format!("{} {} {level} {why}", line.scene, line.label);
    line.failures.iter().map(of).collect()
}

/// The verdict of all norms, or one after the other; norms without a promise count where no norm has
/// one.
fn verdicts(line: &ObservedOrders, tolerance: f64) -> String {
    let of = |norm: &ErrorNorm| line.verdict(*norm, tolerance);
    let idle = |v: &OrderVerdict| matches!(v, OrderVerdict::NothingPromised | OrderVerdict::Exact);
    let mut found = distinct(PROMISED.iter().map(of));
    if found.iter().any(|v| !idle(v)) {
        found.retain(|v| !idle(v));
    } else if found.contains(&OrderVerdict::Exact) {
        found = vec![OrderVerdict::Exact];
    }
    let in_words = |v: &OrderVerdict| match found.len() {
        1 if *v != OrderVerdict::Missed => v.name().to_owned(),
        _ => {
            let norms: Vec<&str> =
                PROMISED.iter().filter(|norm| of(norm) == *v).map(|norm| norm.name()).collect();
            format!("{} in {}", v.name(), norms.join(", "))
        }
    };
    let mut parts: Vec<String> = found.iter().map(in_words).collect();
    parts.extend(line.failures.iter().map(|(level, why)| format!("level {level} {why}")));
    parts.join("; ")
}
