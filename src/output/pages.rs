//! The tables and the page of a report.

use std::path::Path;

use super::html::{HtmlPage, Section};
#[cfg(feature = "plot")]
use crate::plot::overview;
use crate::study::orders::rates::rates;
use crate::study::row::distinct;
use crate::study::tables::levels::{Column, columns, heading, limits, scenes, totals, unproven};
use crate::study::tables::remarks::{failure, warnings};
use crate::study::tables::summary::{lead, summaries};
use crate::study::{Program, Report, Row, file_name};
use crate::table::{Cell, Table};

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
        scenes(&self.rows).iter().flat_map(|(scene, rows)| tables_of(scene, rows)).collect()
    }

    /// The tables in Markdown.
    pub fn to_markdown(&self) -> String {
        let tables: Vec<String> = self.tables().iter().map(Table::to_markdown).collect();
        format!("# Comparison\n\n{}\n\n{}", self.heading(), tables.join("\n"))
    }

    /// The report as a page, which links the pictures `SCENE-LABEL.svg` that are in the directory.
    pub(super) fn page(&self, directory: &Path) -> HtmlPage {
        let of_scene = |(scene, rows): (String, Vec<&Row>)| Section {
            tables: tables_of(&scene, &rows),
            pictures: self.pictures(&rows[0].scene, directory),
            title: scene,
            ..Section::default()
        };
        HtmlPage {
            title: "Comparison of schemes".to_owned(),
            lead: lead(&self.rows),
            summary: summaries(&self.rows),
            plots: self.overview(),
            sections: [self.plots()]
                .into_iter()
                .flatten()
                .chain(scenes(&self.rows).into_iter().map(of_scene))
                .collect(),
            provenance: [self.heading()].into_iter().chain(self.program.command.clone()).collect(),
        }
    }

    /// The plots of the first screen.
    #[cfg(feature = "plot")]
    fn overview(&self) -> Vec<(String, String)> {
        let titles = ["Error against time", "Error against mesh size"].map(str::to_owned);
        let figures = overview(&self.rows).map(|figure| figure.to_svg());
        titles.into_iter().zip(figures).collect()
    }
    #[cfg(not(feature = "plot"))]
    fn overview(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// The section of the plots with all errors, which stand beside the page.
    fn plots(&self) -> Option<Section> {
        let plot = |file: &str, title: &str| (title.to_owned(), file.to_owned());
        cfg!(feature = "plot").then(|| Section {
            title: "All scenes".to_owned(),
            pictures: vec![
                plot("convergence.svg", "Errors against mesh size"),
                plot("work_precision.svg", "Error against time"),
            ],
            ..Section::default()
        })
    }

    /// The pictures of a scene: titles and files.
    fn pictures(&self, scene: &str, directory: &Path) -> Vec<(String, String)> {
        let mut pictures = Vec::new();
        let of_scene = self.rows.iter().filter(|r| r.scene == scene);
        for (label, solver) in distinct(of_scene.map(|r| (&r.label, &r.solver))) {
            let is_alone = self.rows.iter().all(|r| r.solver == *solver);
            let of = if is_alone { label.clone() } else { format!("{label}-{solver}") };
            let file = file_name(&format!("{scene}-{of}")) + ".svg";
            if directory.join(&file).exists() {
                pictures.push((format!("{of} on {scene}"), file));
            }
        }
        pictures
    }
}

/// The tables of a scene.
fn tables_of(scene: &str, rows: &[&Row]) -> Vec<Table> {
    [Some(table(scene, rows)), second(scene, rows)].into_iter().flatten().collect()
}

/// The first table of a scene.
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
