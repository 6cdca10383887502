//! A report of a study as files.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::csv;
use super::pages::history_file;
use crate::error::Error;
use crate::files::replace_text;
#[cfg(feature = "plot")]
use crate::plot::{Figure, Quantity, convergence, cost_figure, history_figure, work_precision};
#[cfg(feature = "plot")]
use crate::real::Precision;
#[cfg(feature = "plot")]
use crate::study::row::distinct;
#[cfg(feature = "plot")]
use crate::study::series::by_scene;
use crate::study::tables::summary::summaries;
use crate::study::tables::values;
use crate::study::{Report, Series, Variant, file_name};
use crate::table::latex_document;

impl Report {
    /// The report as JSON. Numbers that do not apply, and numbers that are not finite, are null. A report of rounds has two
    /// keys more, `reach` and `verdicts`.
    pub fn to_json(&self) -> String {
        // `serde_json` writes every NaN and infinity as null: JSON has no other way
        let mut value = json!(self);
        if self.has_rounds() {
            value["reach"] = json!(self.work_at_errors());
            value["verdicts"] = json!(self.verdicts());
        }
        format!("{value:#}\n")
    }

    /// Rows as comma-separated values after a header of keys, nested keys joined by dots (`error.l2`,
    /// `iterations.outer`). A value that does not apply, or that a row does not have, is an empty cell; several
    /// warnings, and the points of a history as in JSON, are separated by `"; "`.
    ///
    /// Lines are made from the same serialisation as the JSON report, so that the two agree in keys,
    /// order and digits. Without rows there are no keys, and the text is empty.
    pub fn to_csv(&self) -> String {
        csv::lines(&self.rows)
    }

    /// Removes the files of this report from a directory, except `report.json`: the files that [`Report::write`] and
    /// [`Journal`](crate::study::Journal) write, and the fields and pictures of its rows. Another report written to the
    /// directory afterwards stands there without files of this one.
    pub fn remove_files(&self, directory: impl AsRef<Path>) {
        let mut names: Vec<String> =
            ["csv", "jsonl", "md", "tex", "html"].map(|end| format!("report.{end}")).into();
        let others = ["request.json", "reach.csv", "convergence.svg", "work_precision.svg"];
        names.extend(others.map(str::to_owned));
        for Series { variant: Variant { scene, label, solver, .. }, rows, .. } in self.series() {
            names.extend(["time", "unknowns"].map(|cost| format!("{scene}-{cost}.svg")));
            names.push(history_file(&scene));
            for stem in [format!("{scene}-{label}"), format!("{scene}-{label}-{solver}")] {
                let stem = file_name(&stem);
                names.extend(["svg", "vtu", "pvd"].map(|end| format!("{stem}.{end}")));
                names.extend(rows.iter().map(|row| format!("{stem}-{}.vtu", row.level)));
            }
        }
        for name in names {
            // a file that is not there need not go, and one that stays is noticed when it is written
            let _ = std::fs::remove_file(directory.as_ref().join(name));
        }
    }

    /// Writes `report.json`, `report.csv`, `report.md`, `report.tex`, the plots `convergence.svg` and
    /// `work_precision.svg`, where rows have a history `SCENE-history.svg`, of rounds `reach.csv`, `SCENE-time.svg` and
    /// `SCENE-unknowns.svg`, and `report.html` into a directory, which is made if need be. Returns the files in order. The page shows these plots and the pictures `SCENE-LABEL.svg` of the
    /// directory. Without the feature `plot` there are no plots. Each file is replaced as a whole: a reader never sees a
    /// part of it.
    ///
    /// # Errors
    /// [`Error::Write`] of the first file that cannot be written; the others are written all the same.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let directory = directory.as_ref();
        let mut results = Vec::new();
        let mut put = |name: &str, text: &str| {
            results.push(replace_text(&directory.join(name), text));
        };
        put("report.json", &self.to_json());
        put("report.csv", &self.to_csv());
        put("report.md", &self.to_markdown());
        put("report.tex", &self.to_latex());
        if self.has_rounds() {
            put("reach.csv", &csv::lines(&self.work_at_errors()));
        }
        #[cfg(feature = "plot")]
        {
            put("convergence.svg", &convergence(&self.rows).to_svg());
            put("work_precision.svg", &work_precision(&self.rows).to_svg());
            let precision = Precision::by_name(&self.program.precision);
            let limit = precision.map(|precision| precision.certificate_limit());
            for scene in distinct(self.rows.iter().map(|row| &*row.scene)) {
                if let Some(figure) = history_figure(&self.rows, scene, limit) {
                    put(&history_file(scene), &figure.to_svg());
                }
            }
        }
        #[cfg(feature = "plot")]
        for (name, figure) in self.work_figures() {
            put(&(name + ".svg"), &figure.to_svg());
        }
        let page = self.page(directory);
        results.push(replace_text(&directory.join("report.html"), &page.to_html()));
        results.into_iter().collect()
    }

    /// The tables of the first screen in LaTeX, for `\input`; see [`LATEX_PACKAGES`](crate::output::LATEX_PACKAGES).
    pub fn to_latex(&self) -> String {
        match self.has_rounds() {
            true => {
                let words = [vec![self.heading()], self.verdicts()].concat();
                latex_document(&words, &self.work_tables())
            }
            false => latex_document(&[], &[summaries(&self.rows), values(&self.rows)].concat()),
        }
    }

    /// The errors of every scene of a report of rounds against time and unknowns, as `SCENE-time` and `SCENE-unknowns`.
    #[cfg(feature = "plot")]
    pub fn work_figures(&self) -> Vec<(String, Figure)> {
        let mut figures = Vec::new();
        for (scene, series) in by_scene(&self.series()).into_iter().filter(|_| self.has_rounds()) {
            for (name, cost) in [("time", Quantity::Seconds), ("unknowns", Quantity::Unknowns)] {
                figures.push((format!("{scene}-{name}"), cost_figure(scene, &series, cost)));
            }
        }
        figures
    }
}
