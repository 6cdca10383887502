//! The tables and the page of a report.

use std::path::Path;

use serde_json::Value;

use super::csv::flatten;
use super::html::{HtmlCell, HtmlPage, HtmlTable};
use super::table::{Cell, Table};
use crate::input::beginning;
use crate::study::orders::rates::rates;
use crate::study::remarks::{failure, warnings};
use crate::study::row::distinct;
use crate::study::series::names;
use crate::study::table::{Column, columns, heading, limits, scenes, totals, unproven};
use crate::study::{Program, Report, Row, file_name};

/// Columns of the page that are shown at first, by their keys.
const SHOWN: [&str; 20] = [
    "against",
    "label",
    "level",
    "mesh_size",
    "unknowns",
    "status",
    "message",
    "error.l2",
    "order.l2",
    "error.h1",
    "order.h1",
    "error.broken_energy",
    "bound.discrete",
    "order.bound",
    "energy",
    "contact_measure",
    "resultant",
    "active",
    "iterations.outer",
    "seconds.total",
];
/// Columns of tables in LaTeX: what fits into the width of a page.
const PRINTED: [&str; 17] = [
    "scheme",
    "solver",
    "n",
    "step",
    "unknowns",
    "bound",
    "L2",
    "order",
    "H1",
    "energy norm",
    "energy",
    "contact",
    "resultant",
    "outer",
    "solve",
    "stages (outer)",
    "total",
];

impl Report {
    /// Program and settings in one line.
    fn heading(&self) -> String {
        let Program { name, version, threads, precision, repeat, target_cpu, .. } = &self.program;
        let times = match repeat {
            1 => "times in seconds".to_owned(),
            _ => format!("every time is the least of {repeat} runs, in seconds"),
        };
        let end = if self.complete { "" } else { "; not complete: the run was interrupted" };
        format!("{name} {version}, {target_cpu}; {threads} threads; {precision}; {times}{end}")
    }

    /// Two tables for each scene, with the columns of the tables for a terminal: errors and times, then
    /// energy, contact measure, resultant, error bound and stages.
    pub fn tables(&self) -> Vec<Table> {
        let tables = |(scene, rows): (String, Vec<&Row>)| {
            [Some(table(&scene, &rows)), second(&scene, &rows)].into_iter().flatten()
        };
        scenes(&self.rows).into_iter().flat_map(tables).collect()
    }

    /// The tables in Markdown.
    pub fn to_markdown(&self) -> String {
        let tables: Vec<String> = self.tables().iter().map(Table::to_markdown).collect();
        format!("# Comparison\n\n{}\n\n{}", self.heading(), tables.join("\n"))
    }

    /// The tables in LaTeX, with the columns that fit into the width of a page; see
    /// [`LATEX_PACKAGES`](super::LATEX_PACKAGES).
    pub fn latex_tables(&self) -> Vec<Table> {
        let mut tables = self.tables();
        for table in &mut tables {
            let kept: Vec<bool> =
                table.columns.iter().map(|name| PRINTED.contains(&&**name)).collect();
            let retain = |cells: &mut Vec<_>| {
                let mut kept = kept.iter();
                cells.retain(|_| kept.next() == Some(&true));
            };
            table.rows.iter_mut().for_each(retain);
            let mut kept = kept.iter();
            table.columns.retain(|_| kept.next() == Some(&true));
        }
        tables
    }

    /// The report as a page: every number of every row, and the pictures `SCENE-LABEL.svg` that are in the
    /// directory.
    pub(super) fn page(&self, directory: &Path) -> HtmlPage {
        let series = self.series();
        let names_of_series = names(&series);
        let mut keys = Vec::new();
        let mut tables = Vec::new();
        for (scene, rows) in scenes(&self.rows) {
            let mut cells = Vec::new();
            for row in &rows {
                let own = series.iter().find(|s| s.rows.iter().any(|r| std::ptr::eq(*r, *row)));
                let place = own.and_then(|s| names_of_series.iter().position(|n| *n == s.name));
                // plain data with string keys: its serialisation cannot fail
                let value = serde_json::to_value(row).unwrap_or(Value::Null);
                let mut found = Vec::new();
                flatten("", &value, &mut found);
                cells.push((place, found));
            }
            // constant columns are in the title of the table, empty ones nowhere
            let mut names = distinct(cells.iter().flat_map(|(_, row)| row.iter().map(|of| &of.0)));
            // objects of a row that failed are null and have no keys
            let text = |row: &[(String, String)], name: &str| {
                row.iter().find(|(key, _)| key == name).map_or(String::new(), |of| of.1.clone())
            };
            let is_there = |key: &str| cells.iter().any(|(_, row)| !text(row, key).is_empty());
            names.retain(|key| is_there(key) && *key != "scene" && *key != "dimension");
            let columns = names.iter().map(|key| place_of(&mut keys, key)).collect();
            let rows_of_table = cells.iter().map(|(place, row)| {
                (*place, names.iter().map(|key| html_cell(&text(row, key))).collect())
            });
            tables.push(HtmlTable {
                title: format!("{scene}, dimension {}", rows[0].dimension),
                columns,
                rows: rows_of_table.collect(),
                remarks: [heading(&rows)]
                    .into_iter()
                    .chain(limits(&rows))
                    .chain(rates(&rows))
                    .chain(unproven(&rows))
                    .collect(),
            });
        }
        let mut pictures = Vec::new();
        // of uniform and adaptive meshes there is one picture
        for (scene, label, solver) in
            distinct(series.iter().map(|s| (&s.variant.scene, &s.variant.label, &s.variant.solver)))
        {
            let is_alone = series.iter().all(|s| s.variant.solver == *solver);
            let of = if is_alone { label.clone() } else { format!("{label}-{solver}") };
            let path = directory.join(file_name(&format!("{scene}-{of}")) + ".svg");
            if let Ok(svg) = std::fs::read_to_string(path) {
                pictures.push((format!("{of} on {scene}"), svg));
            }
        }
        HtmlPage {
            title: "Comparison of schemes".to_owned(),
            paragraphs: vec![self.heading()],
            columns: keys
                .iter()
                .map(|key| (beginning(key.as_bytes(), 80), SHOWN.contains(&&**key)))
                .collect(),
            series: names_of_series,
            tables,
            drawings: Vec::new(),
            pictures,
        }
    }
}

/// The place of a key in a list, to which it is added if need be.
fn place_of(keys: &mut Vec<String>, key: &str) -> usize {
    keys.iter().position(|k| k == key).unwrap_or_else(|| {
        keys.push(key.to_owned());
        keys.len() - 1
    })
}

/// The cell of a value: numbers in four digits, with all digits beside the pointer.
fn html_cell(text: &str) -> HtmlCell {
    let is_whole = text.bytes().all(|b| b.is_ascii_digit());
    let number = text.parse::<f64>().ok();
    let short = number.filter(|_| !is_whole).map(|x| match x.abs() {
        0.0 => "0".to_owned(),
        a if (0.01..1e4).contains(&a) => format!("{x:.4}"),
        _ => format!("{x:.3e}"),
    });
    let full = short.is_some().then(|| text.to_owned());
    HtmlCell { text: short.unwrap_or_else(|| text.to_owned()), full, is_number: number.is_some() }
}

/// The table of a scene.
fn table(scene: &str, rows: &[&Row]) -> Table {
    let failed = || rows.iter().filter(|r| !r.converged()).map(|r| (r, failure(r)));
    let remarks = distinct(failed().map(|of| of.1)).into_iter().map(|why| {
        let of = failed().filter(|of| of.1 == why);
        let of: Vec<String> = of.map(|(r, _)| format!("{}, level {}", r.label, r.level)).collect();
        format!("{}: {why}", of.join("; "))
    });
    let warnings =
        warnings(rows).into_iter().map(|(labels, warning)| format!("{labels}: {warning}"));
    let remarks = [heading(rows)].into_iter().chain(remarks).chain(warnings);
    let remarks = distinct(remarks.chain(rates(rows)).chain(unproven(rows)));
    with_columns(scene.to_owned(), &columns(rows), rows, remarks)
}

/// The second table of a scene, if it says anything.
fn second(scene: &str, rows: &[&Row]) -> Option<Table> {
    let columns = totals(rows);
    let title = format!("{scene}: totals and stages");
    (!columns.is_empty()).then(|| with_columns(title, &columns, rows, limits(rows)))
}

fn with_columns(title: String, columns: &[Column], rows: &[&Row], remarks: Vec<String>) -> Table {
    let cell = |text: String, left: bool| match (left, &text[..]) {
        (true, _) => Cell::Words(text),
        (_, "-") => Cell::Nothing,
        _ => Cell::Number(text, None),
    };
    let line = |row: &&Row| columns.iter().map(|c| cell((c.cell)(row), c.left)).collect();
    let names = columns.iter().map(|c| c.name.to_owned()).collect();
    Table { title, columns: names, rows: rows.iter().map(line).collect(), remarks }
}
