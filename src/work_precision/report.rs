//! The report of a work-precision study and the files it is written to.

use std::path::{Path, PathBuf};

use serde_json::json;

#[cfg(feature = "plot")]
use super::figures::figures;
use super::measured::{Failure, Measured, scenes, variants};
use super::tables::{details, summary};
use super::verdict::verdict;
use super::work_at_error::{WorkAtError, work_at_errors};
use crate::error::Error;
use crate::files::replace_text;
use crate::output::html::{HtmlPage, Section};
use crate::output::{Provenance, csv};
use crate::study::row::distinct;
use crate::study::{Program, Variant};
use crate::table::{Table, WIDTH, latex_document, markdown};

/// The results of a work-precision study on any number of scenes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WorkReport {
    /// The program; `repeat` is the number of rounds.
    pub program: Program,
    /// Time and machine.
    pub provenance: Provenance,
    /// What the scenes share and their names do not say, such as a mesh file or a parameter; empty if
    /// there is nothing.
    pub setting: String,
    /// The label of the scheme that verdicts compare with the others.
    pub subject: String,
    /// One row for every scene, variant and level that gave one.
    pub rows: Vec<Measured>,
    /// Cases that were not run or ended in an error.
    pub refused: Vec<Failure>,
}

impl WorkReport {
    /// A report without rows, made by a program of this name.
    pub fn new(name: &str, rounds: usize) -> Self {
        WorkReport {
            program: Program::new(name, "", rayon::current_num_threads(), rounds),
            provenance: Provenance::now(rounds),
            setting: String::new(),
            subject: String::new(),
            rows: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// Time, unknowns and entries at given errors.
    pub fn reach(&self) -> Vec<WorkAtError> {
        work_at_errors(&self.rows, &self.refused)
    }

    /// One sentence for every scene whose errors are known.
    pub fn verdicts(&self) -> Vec<String> {
        let reach = self.reach();
        self.scenes().iter().filter_map(|s| verdict(&reach, s, &self.subject)).collect()
    }

    /// Every case without a solution: what did not converge first, then what was not run.
    pub fn failures(&self) -> Vec<Failure> {
        let failed = self.rows.iter().filter(|m| !m.row.converged());
        let failed = failed.map(|m| Failure::new(m.case(), m.row.status.name()));
        failed.chain(self.refused.iter().cloned()).collect()
    }

    /// The scenes in the order run.
    pub fn scenes(&self) -> Vec<&str> {
        scenes(&self.rows, &self.refused)
    }

    /// The variants in the order run.
    pub fn variants(&self) -> Vec<Variant> {
        variants(&self.rows)
    }

    /// Costs and times to reach errors, scene by scene.
    pub fn summary_tables(&self) -> Vec<Table> {
        summary(&self.rows, &self.failures(), &self.reach())
    }

    /// What was run and where the time went, scene by scene.
    pub fn detail_tables(&self) -> Vec<Table> {
        details(&self.rows, &self.failures())
    }

    /// All tables: details, then the summary.
    pub fn tables(&self) -> Vec<Table> {
        [self.detail_tables(), self.summary_tables()].concat()
    }

    /// The report as JSON: `program`, `provenance`, `setting`, `rows`, `failures`, `reach` and
    /// `verdicts`. What does not apply is null.
    pub fn to_json(&self) -> String {
        let value = json!({
            "program": self.program,
            "provenance": self.provenance,
            "setting": self.setting,
            "rows": self.rows,
            "failures": self.failures(),
            "reach": self.reach(),
            "verdicts": self.verdicts(),
        });
        format!("{value:#}\n")
    }

    /// The rows as comma-separated values, the keys of JSON joined by dots.
    pub fn to_csv(&self) -> String {
        csv::lines(&self.rows)
    }

    /// What it takes to reach given errors, as comma-separated values.
    pub fn reach_csv(&self) -> String {
        csv::lines(&self.reach())
    }

    /// Tables for a terminal, between provenance and verdicts.
    pub fn to_text(&self) -> String {
        self.document(|table| table.to_text(WIDTH), |line| format!("{line}\n"))
    }

    /// Tables, provenance and verdicts in Markdown.
    pub fn to_markdown(&self) -> String {
        self.document(Table::to_markdown, |line| format!("{}\n\n", markdown(line)))
    }

    /// Provenance, verdicts and the tables of the summary in LaTeX, for `\input`; see
    /// [`LATEX_PACKAGES`](crate::output::LATEX_PACKAGES).
    pub fn to_latex(&self) -> String {
        latex_document(&self.paragraphs(), &self.summary_tables())
    }

    fn paragraphs(&self) -> Vec<String> {
        [self.heading()].into_iter().chain(self.verdicts()).collect()
    }

    /// The report as one page, with its figures.
    fn page(&self) -> String {
        #[cfg_attr(not(feature = "plot"), expect(unused_mut))]
        let mut plots = Vec::new();
        #[cfg(feature = "plot")]
        for scene in self.scenes() {
            for (name, figure) in figures(&self.rows, scene) {
                plots.push((name, figure.to_svg()));
            }
        }
        let section =
            |title: &str, tables| Section { title: title.to_owned(), tables, ..Section::default() };
        HtmlPage {
            title: "Work against precision".to_owned(),
            lead: self.verdicts().join(" "),
            plots,
            summary: self.summary_tables(),
            sections: vec![section("All runs", self.detail_tables())],
            provenance: vec![self.heading()],
        }
        .to_html()
    }

    fn document(&self, table: fn(&Table) -> String, line: impl Fn(&str) -> String) -> String {
        let mut text = line(&self.heading());
        for t in self.tables() {
            text += "\n";
            text += &table(&t);
        }
        text += "\n";
        for sentence in self.verdicts() {
            text += &line(&sentence);
        }
        text
    }

    /// Program and provenance in one line.
    fn heading(&self) -> String {
        let Program { name, version, threads, precision, target_cpu, .. } = &self.program;
        let Provenance { date, processor, rounds, complete } = &self.provenance;
        let known = |text: &Option<String>| text.clone().unwrap_or_else(|| "unknown".to_owned());
        let end = if *complete { "" } else { " (not all of them done)" };
        let mut text = format!(
            "{name} {version}, {}; {target_cpu}, {}; {threads} threads; {precision}; {rounds} rounds{end}; times in seconds",
            known(date),
            known(processor),
        );
        if !self.setting.is_empty() {
            text += &format!("; {}", self.setting);
        }
        let references = distinct(self.rows.iter().filter_map(|m| m.row.reference()));
        if !references.is_empty() {
            text += &format!("; errors against {}", references.join(", "));
        }
        text
    }

    /// Writes `report.json`, `report.csv`, `reach.csv`, `report.md`, `report.tex` and, if the report is complete,
    /// `report.html` into a directory, which is made if need be. Each file takes the place of an earlier one
    /// only when it is whole.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write_data(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = vec![
            ("report.json", self.to_json()),
            ("report.csv", self.to_csv()),
            ("reach.csv", self.reach_csv()),
            ("report.md", self.to_markdown()),
            ("report.tex", self.to_latex()),
        ];
        if self.provenance.complete {
            files.push(("report.html", self.page()));
        }
        files.iter().map(|(name, text)| replace_text(&directory.join(name), text)).collect()
    }

    /// Writes the errors of a scene against time and unknowns as `SCENE-time.svg` and `SCENE-unknowns.svg`.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    #[cfg(feature = "plot")]
    pub fn write_figures(&self, directory: &Path, scene: &str) -> Result<Vec<PathBuf>, Error> {
        let figures = figures(&self.rows, scene).into_iter();
        figures
            .map(|(name, figure)| {
                replace_text(&directory.join(format!("{name}.svg")), &figure.to_svg())
            })
            .collect()
    }

    /// Without the feature `plot` there are no figures.
    #[cfg(not(feature = "plot"))]
    pub(super) fn write_figures(&self, _: &Path, _: &str) -> Result<Vec<PathBuf>, Error> {
        Ok(Vec::new())
    }

    /// Writes data, and figures of all scenes.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let mut written = self.write_data(directory.as_ref())?;
        for scene in self.scenes() {
            written.extend(self.write_figures(directory.as_ref(), scene)?);
        }
        Ok(written)
    }
}
