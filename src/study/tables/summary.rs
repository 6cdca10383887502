//! The summary of a report: one table for each scene at the finest level of every series, and how the runs ended.

use super::columns::{Shown, columns};
use super::levels::scenes;
use super::remarks::remarks;
use crate::study::row::{Row, distinct};
use crate::study::series::{Series, series_of};
use crate::table::{Cell, Table};

/// One sentence: what was compared and how it ended, with the runs that did not converge.
pub(crate) fn lead(rows: &[Row]) -> String {
    let names = |names: Vec<&str>, what: &str| match &names[..] {
        names if names.len() <= 4 => names.join(", "),
        names => format!("{} {what}", names.len()),
    };
    let schemes = names(distinct(rows.iter().map(|r| r.label.as_str())), "schemes");
    let scenes = names(distinct(rows.iter().map(|r| r.scene.as_str())), "scenes");
    let levels = distinct(rows.iter().map(|r| r.level));
    let levels = match (levels.iter().min(), levels.iter().max()) {
        (Some(least), Some(most)) if least < most => format!("levels {least} to {most}"),
        (Some(level), _) => format!("level {level}"),
        _ => "no level".to_owned(),
    };
    let failed: Vec<&Row> = rows.iter().filter(|r| !r.converged()).collect();
    let end = match failed.len() {
        0 => format!("all {} runs converged", rows.len()),
        n => {
            let name = |r: &&Row| format!("{} on {} at {}", r.label, r.scene, r.level);
            let named: Vec<String> = failed.iter().take(3).map(name).collect();
            let more = if n > 3 { format!(" and {} more", n - 3) } else { String::new() };
            format!("{n} of {} runs did not converge: {}{more}", rows.len(), named.join(", "))
        }
    };
    format!("{schemes} on {scenes}, {levels}: {end}.")
}

/// The tables of all scenes, the best number of a column marked.
pub(crate) fn summaries(rows: &[Row]) -> Vec<Table> {
    let tables = scenes(rows).into_iter();
    tables.map(|(title, rows)| summary(title, rows[0].theta.is_some(), &series_of(&rows))).collect()
}

fn summary(title: &str, is_adaptive: bool, series: &[Series<'_>]) -> Table {
    let mut finest = series.to_vec();
    finest.iter_mut().for_each(|of| of.rows = of.rows.split_off(of.rows.len() - 1));
    let rows: Vec<&Row> = finest.iter().map(|of| of.rows[0]).collect();
    let levels = distinct(rows.iter().map(|r| r.level));
    let name = |of: &Series<'_>| match levels.len() {
        1 => of.name.clone(),
        _ => format!("{} at {}", of.name, of.rows[0].level),
    };
    let mut columns = columns(&rows);
    columns.retain(|column| [Shown::Everywhere, Shown::InSummary].contains(&column.shown));
    let names = ["scheme"].into_iter().chain(columns.iter().map(|of| of.name)).chain(["status"]);
    let mut all = vec![finest.iter().map(|of| Cell::Words(name(of))).collect::<Vec<_>>()];
    all.extend(columns.iter().map(|column| column.cells(&rows, true)));
    all.push(rows.iter().map(|row| Cell::Words(row.status.to_string())).collect());
    let references = distinct(rows.iter().filter_map(|r| r.reference()));
    let references = references.iter().map(|reference| format!("; errors against {reference}"));
    let kind = if is_adaptive { "step" } else { "level" };
    let place = match levels[..] {
        [level] => format!(", {kind} {level}"),
        _ => format!(", each scheme at its last {kind}"),
    };
    Table {
        title: title.to_owned(),
        detail: place + &references.collect::<String>(),
        columns: names.map(str::to_owned).collect(),
        rows: (0..rows.len()).map(|k| all.iter().map(|cells| cells[k].clone()).collect()).collect(),
        remarks: remarks(series, &finest),
    }
}
