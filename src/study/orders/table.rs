//! Observed and promised orders, as tables in Markdown.

use super::check::{
    ObservedOrders, OrderMissed, OrderVerdict, PROMISED, levels_in_words, order_in_words,
};
use crate::measure::{ErrorNorm, FittedOrder};
use crate::study::row::distinct;
use crate::table::{Cell, Table};

/// The paragraph that explains the words of the tables.
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
    let line = |line: &ObservedOrders| {
        let mut cells = vec![
            Cell::Words(line.scene.clone()),
            Cell::Words(line.label.clone()),
            Cell::Words(line.constraint.clone()),
            Cell::Words(levels_in_words(&line.levels)),
        ];
        for norm in PROMISED {
            cells.extend([observed(line.fitted(norm)), promised(line.promised(norm))]);
        }
        cells.push(Cell::Words(verdicts(line, tolerance)));
        cells
    };
    let heads = "scene,scheme,bounds at,levels,L2,promised,H1,promised,verdict";
    let table =
        Table::new("Observed and promised orders", heads, orders.iter().map(line).collect());
    reading(tolerance) + &table.to_markdown()
}

/// How many promises each scheme keeps, and every promise that it was not seen to keep, with the orders
/// from level to level beside the fitted one; then the levels that did not converge.
pub fn orders_summary(orders: &[ObservedOrders], tolerance: f64) -> String {
    let count = |name: &str, wanted: &dyn Fn(&ObservedOrders) -> bool| {
        let lines = orders.iter().filter(|line| wanted(line));
        let found: Vec<OrderVerdict> =
            lines.flat_map(|o| PROMISED.map(|norm| o.verdict(norm, tolerance))).collect();
        let of = |verdict| Cell::whole(Some(found.iter().filter(|v| **v == verdict).count()));
        [Cell::Words(name.to_owned())].into_iter().chain(OrderVerdict::ALL.map(of)).collect()
    };
    let labels = distinct(orders.iter().map(|line| &line.label));
    let of_schemes = labels.into_iter().map(|label| count(label, &|line| line.label == *label));
    let heads = ["scheme"].into_iter().chain(OrderVerdict::ALL.map(OrderVerdict::name));
    let counts = Table::new(
        "Verdicts by scheme",
        &heads.collect::<Vec<_>>().join(","),
        of_schemes.chain([count("all", &|_| true)]).collect(),
    );
    let missed = |missed: OrderMissed| {
        let fitted = missed.observed.fitted(missed.norm);
        vec![
            Cell::Words(missed.observed.scene.clone()),
            Cell::Words(missed.observed.label.clone()),
            Cell::Words(missed.norm.to_string()),
            Cell::Words(levels_in_words(&missed.observed.levels)),
            observed(fitted),
            promised(Some(missed.promised)),
            Cell::number(fitted.map(|fitted| {
                let orders = fitted.local.iter().map(|order| format!("{order:.2}"));
                orders.collect::<Vec<_>>().join(", ")
            })),
            Cell::Words(missed.verdict.name().to_owned()),
        ]
    };
    let not_kept = Table::new(
        "Promises that were not seen to be kept",
        "scene,scheme,norm,levels,order,promised,level to level,verdict",
        orders.iter().flat_map(|line| line.missed(tolerance)).map(missed).collect(),
    );
    let mut text = reading(tolerance) + &counts.to_markdown() + "\n" + &not_kept.to_markdown();
    let failures = orders.iter().flat_map(|line| {
        let of = |(level, why): &(usize, _)| format!("{} {} {level} {why}", line.scene, line.label);
        line.failures.iter().map(of).collect::<Vec<_>>()
    });
    let failures: Vec<String> = failures.collect();
    if !failures.is_empty() {
        text += &format!("\nLevels that did not converge: {}.\n", failures.join("; "));
    }
    text
}

fn observed(fitted: Option<&FittedOrder>) -> Cell {
    Cell::number(fitted.map(order_in_words))
}

fn promised(order: Option<f64>) -> Cell {
    Cell::number(order.map(|order| order.to_string()))
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
