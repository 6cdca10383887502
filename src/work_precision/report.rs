//! A report of several rounds as work against precision, and the files it is written to.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::tables::{details, summary};
use super::verdict::verdict;
use super::work_at_error::{WorkAtError, work_at_errors};
use crate::error::Error;
use crate::files::replace_text;
use crate::output::csv;
use crate::output::document::Document;
use crate::output::html::{HtmlPage, Section};
#[cfg(feature = "plot")]
use crate::plot::{Figure, Quantity, cost_figure};
use crate::study::Report;
use crate::study::row::distinct;
#[cfg(feature = "plot")]
use crate::study::series::by_scene;
use crate::table::Table;

/// The work that the rows of a report took to reach given errors.
#[derive(Clone, Copy, Debug)]
pub struct WorkPrecision<'r> {
    report: &'r Report,
    subject: &'r str,
}

impl<'r> WorkPrecision<'r> {
    /// The work of a report, best from [`Rounds`](super::Rounds).
    #[must_use]
    pub fn of(report: &'r Report) -> Self {
        Self { report, subject: "" }
    }
    /// Sets the label of the scheme that verdicts compare with the others; the fastest one by default.
    #[must_use]
    pub fn subject(mut self, label: &'r str) -> Self {
        self.subject = label;
        self
    }

    /// Time, unknowns and entries at given errors.
    pub fn reach(&self) -> Vec<WorkAtError> {
        work_at_errors(&self.report.rows)
    }

    /// One sentence for every scene whose errors are known.
    pub fn verdicts(&self) -> Vec<String> {
        let reach = self.reach();
        let scenes = distinct(self.report.rows.iter().map(|row| row.scene.as_str()));
        scenes.into_iter().filter_map(|scene| verdict(&reach, scene, self.subject)).collect()
    }

    /// Costs and times to reach errors, scene by scene.
    pub fn summary_tables(&self) -> Vec<Table> {
        summary(&self.report.rows, &self.reach())
    }

    /// All levels, and where the time went.
    pub fn detail_tables(&self) -> Vec<Table> {
        [self.report.tables(), details(&self.report.rows)].concat()
    }

    /// The report as JSON with two keys more: `reach` and `verdicts`. What does not apply is null.
    pub fn to_json(&self) -> String {
        let mut value = json!(self.report);
        value["reach"] = json!(self.reach());
        value["verdicts"] = json!(self.verdicts());
        format!("{value:#}\n")
    }

    /// All tables for a terminal, between provenance and verdicts.
    pub fn to_text(&self, width: usize) -> String {
        let tables = [self.detail_tables(), self.summary_tables()].concat();
        self.document(tables).to_text(width)
    }

    /// The summary, then all tables, in Markdown.
    pub fn to_markdown(&self) -> String {
        self.document([self.summary_tables(), self.detail_tables()].concat()).to_markdown()
    }

    /// Provenance, verdicts and the tables of the summary in LaTeX, for `\input`; see
    /// [`LATEX_PACKAGES`](crate::output::LATEX_PACKAGES).
    pub fn to_latex(&self) -> String {
        self.document(self.summary_tables()).to_latex()
    }

    fn document(&self, tables: Vec<Table>) -> Document {
        let (opening, closing) = (vec![self.report.heading()], self.verdicts());
        Document { title: "Work against precision", opening, tables, closing }
    }

    /// The report as one page: the plots of a comparison and the summary first, then figures and tables of all runs.
    fn page(&self) -> HtmlPage {
        let figures = Section {
            title: "All errors".to_owned(),
            plots: self.svg_files(),
            ..Section::default()
        };
        let tables = self.detail_tables();
        let details = Section { title: "All runs".to_owned(), tables, ..Section::default() };
        let scenes = distinct(self.report.rows.iter().map(|row| row.scene.as_str()));
        HtmlPage {
            title: match scenes[..] {
                [scene] => format!("{scene}: work against precision"),
                _ => "Work against precision".to_owned(),
            },
            lead: self.verdicts().join(" "),
            plots: self.report.overview(),
            summary: self.summary_tables(),
            sections: vec![figures, details],
            provenance: self.report.provenance(),
            ..HtmlPage::default()
        }
    }

    /// The errors of every scene against time and unknowns, as `SCENE-time` and `SCENE-unknowns`.
    #[cfg(feature = "plot")]
    pub fn figures(&self) -> Vec<(String, Figure)> {
        let costs = [("time", Quantity::Seconds), ("unknowns", Quantity::Unknowns)];
        let mut figures = Vec::new();
        for (scene, series) in by_scene(&self.report.series()) {
            let figure = |cost| cost_figure(scene, &series, cost);
            figures.extend(costs.map(|(name, cost)| (format!("{scene}-{name}"), figure(cost))));
        }
        figures
    }

    #[cfg(feature = "plot")]
    fn svg_files(&self) -> Vec<(String, String)> {
        self.figures().into_iter().map(|(name, figure)| (name, figure.to_svg())).collect()
    }
    /// Without the feature `plot` there are no figures.
    #[cfg(not(feature = "plot"))]
    fn svg_files(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// Writes `report.json`, `report.csv`, `reach.csv`, `report.md` and `report.tex` into a directory, which is made if
    /// need be, and, if the report is complete, `report.html` and the figures. Each file takes the place of an earlier
    /// one only when it is whole.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let mut files = vec![
            ("report.json".to_owned(), self.to_json()),
            ("report.csv".to_owned(), self.report.to_csv()),
            ("reach.csv".to_owned(), csv::lines(&self.reach())),
            ("report.md".to_owned(), self.to_markdown()),
            ("report.tex".to_owned(), self.to_latex()),
        ];
        if self.report.complete {
            files.push(("report.html".to_owned(), self.page().to_html()));
            let figures = self.svg_files().into_iter();
            files.extend(figures.map(|(name, svg)| (format!("{name}.svg"), svg)));
        }
        let directory = directory.as_ref();
        files.iter().map(|(name, text)| replace_text(&directory.join(name), text)).collect()
    }
}
