//! The report of a work-precision study and the files it is written to.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

#[cfg(feature = "plot")]
use super::figures::figures;
use super::measured::{Failure, Measured, Variant, scenes, variants};
use super::tables::tables;
use super::verdict::verdict;
use super::work_at_error::{WorkAtError, work_at_errors};
use crate::error::Error;
use crate::files::replace;
use crate::output::table::{latex, markdown};
use crate::output::{Provenance, Table, csv};
use crate::study::Program;

/// The results of a work-precision study on any number of scenes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WorkReport {
    /// The program; `precision` lists all scalars, `repeat` is the number of rounds.
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

    /// Time, unknowns and memory at given errors.
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

    /// All tables, scene by scene.
    pub fn tables(&self) -> Vec<Table> {
        tables(&self.rows, &self.failures(), &self.reach())
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
        self.document(Table::to_text, |line| format!("{line}\n"))
    }

    /// Tables, provenance and verdicts in Markdown.
    pub fn to_markdown(&self) -> String {
        self.document(Table::to_markdown, |line| format!("{}\n\n", markdown(line)))
    }

    /// Tables, provenance and verdicts in LaTeX, for `\input`; it needs the package `booktabs`.
    pub fn to_latex(&self) -> String {
        let text = self.document(Table::to_latex, |line| {
            format!("{{\\raggedright\\noindent {}\\par}}\n", latex(line))
        });
        format!("% needs \\usepackage{{booktabs}}\n{text}")
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
        text
    }

    /// Writes `report.json`, `report.csv`, `reach.csv`, `report.txt`, `report.md` and `report.tex`
    /// into a directory, which is made if need be. Each file takes the place of an earlier one only
    /// when it is whole.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write_data(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        let files = [
            ("report.json", self.to_json()),
            ("report.csv", self.to_csv()),
            ("reach.csv", self.reach_csv()),
            ("report.txt", self.to_text()),
            ("report.md", self.to_markdown()),
            ("report.tex", self.to_latex()),
        ];
        let put = |(name, text): (&str, String)| {
            replace(&directory.join(name), |path| fs::write(path, text))
        };
        files.into_iter().map(put).collect()
    }

    /// Writes the errors of a scene against time, unknowns and memory as `SCENE-time`,
    /// `SCENE-unknowns` and `SCENE-memory`, each as `.svg` and `.png`.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    #[cfg(feature = "plot")]
    pub fn write_figures(&self, directory: &Path, scene: &str) -> Result<Vec<PathBuf>, Error> {
        let mut written = Vec::new();
        for (name, figure) in figures(&self.rows, scene) {
            let svg = directory.join(format!("{name}.svg"));
            written.push(replace(&svg, |path| {
                fs::write(path, figure.to_svg()?).map_err(|e| e.to_string())
            })?);
            let png = directory.join(format!("{name}.png"));
            written.push(replace(&png, |path| figure.write_png(path))?);
        }
        Ok(written)
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
