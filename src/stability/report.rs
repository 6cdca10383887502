//! The report of a stability study and the files it is written to.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::cases::{STABILITY_CASES, criteria};
use super::criterion::Criterion;
use super::plan::Effort;
use super::row::{StabilityRow, Verdict};
use super::summary::{by_criterion, by_scheme, conditions, missed};
use crate::error::Error;
use crate::files::replace_text;
use crate::output::csv;
use crate::output::document::Document;
use crate::output::html::{HtmlPage, Section};
use crate::study::Program;
use crate::table::{Cell, Table, WIDTH};

/// Notes before the tables.
const READING: [&str; 3] = [
    "Every row has a figure, the limits it should keep, and the verdict that follows from the two. A row that fails as expected shows a choice of which theory or experience says that it is not enough there; a row that is missed is a failure that nobody announced. What is reported only has no limits. Figures have the digits that decide.",
    "Schemes: p1 and p2, conforming linear and quadratic elements with bounds at nodes; cr, Crouzeix-Raviart elements with bounds on facet means; sipg and nipg, symmetric and non-symmetric interior penalty on broken linears; wopsip, the weakly over-penalised method on broken linears with bounds at vertices, wopsip:facet-means the same with bounds on facet means.",
    "Penalties: sipg has 1.5 times the proven bound, the least interior penalty that is provably enough on each cell, nipg 1/h_F, with h_F the diameter of a facet; sigma is the factor of 1/h_F. wopsip has eta/h_F^3, with eta the square of the diameter of the domain unless it is given; weight=anisotropic puts h^2 l_F in place of h_F^3, with h the mesh size and l_F the height of the cells over the facet. All but what ignores it carry the coefficient of the problem. L2 and H1 are norms of the error (H1 broken and without values), energy is the scheme's own norm, with its penalty. Problems are those of the catalogue of scenes; sines-Dd is Poisson's equation solved by the product of sin(pi x_k).",
];

/// All rows, in the order run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StabilityReport {
    /// The program.
    pub program: Program,
    /// Whether all jobs have run.
    pub complete: bool,
    /// The size of the study.
    pub effort: Effort,
    /// One row for every figure.
    pub rows: Vec<StabilityRow>,
    /// Jobs that ended in an error, with the error.
    pub failures: Vec<String>,
}

impl StabilityReport {
    /// A report without rows.
    pub fn new(effort: Effort) -> Self {
        Self {
            program: Program::new("stability", "f64, f32", rayon::current_num_threads(), 1),
            complete: false,
            effort,
            rows: Vec::new(),
            failures: Vec::new(),
        }
    }

    /// Number of rows with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }

    /// Verdicts by scheme and by criterion, and what was missed.
    fn verdict_tables(&self) -> Vec<Table> {
        let mut tables = vec![by_scheme(&self.rows), by_criterion(&self.rows)];
        tables.extend(missed(&self.rows));
        tables
    }

    /// The rows case by case.
    fn case_tables(&self) -> impl Iterator<Item = Table> + '_ {
        let cases =
            STABILITY_CASES.iter().filter(|case| self.rows.iter().any(|r| r.case == **case));
        cases.map(|case| self.case_table(case))
    }

    /// Verdicts and what was missed, for a terminal: the report without its rows.
    pub fn summary(&self) -> String {
        let mut opening = vec![self.heading()];
        opening.extend(self.findings());
        let tables = self.verdict_tables();
        Document { title: "Stability", opening, tables, closing: Vec::new() }.to_text(WIDTH)
    }

    fn case_table(&self, case: &str) -> Table {
        let rows: Vec<&StabilityRow> = self.rows.iter().filter(|r| r.case == case).collect();
        let line = |row: &&StabilityRow| {
            vec![
                Cell::Words(row.criterion.clone()),
                Cell::Words(row.label.clone()),
                Cell::Words(format!("{} {}", row.problem, row.precision)),
                Cell::whole(row.level),
                Cell::Words(row.place()),
                Cell::Words(row.quantity.clone()),
                Cell::Words(row.expected.words()),
                Cell::number(row.figure_in_words()),
                Cell::Words(row.verdict_words()),
                Cell::Words(row.detail.clone()),
            ]
        };
        let asked = criteria().filter(|of| rows.iter().any(|r| r.criterion == of.1.name));
        let heads =
            "criterion,scheme,problem,n,at,quantity,expected,measured,verdict,further figures";
        Table {
            remarks: asked.map(|(_, c)| format!("{}: {}", c.name, c.sentence())).collect(),
            ..Table::new(format!("Case {case}"), heads, rows.iter().map(line).collect())
        }
    }

    /// The report as JSON: `program`, `complete`, `criteria`, `rows` and `failures`. What does not apply is null.
    pub fn to_json(&self) -> String {
        let criterion = |(case, c): (_, &Criterion)| json!({ "name": c.name, "case": case, "sentence": c.sentence() });
        let value = json!({
            "program": self.program,
            "complete": self.complete,
            "criteria": criteria().map(criterion).collect::<Vec<_>>(),
            "rows": self.rows,
            "failures": self.failures,
        });
        format!("{value:#}\n")
    }

    /// The rows as comma-separated values, the keys of JSON joined by dots.
    pub fn to_csv(&self) -> String {
        csv::lines(&self.rows)
    }

    /// Tables, provenance and notes in Markdown.
    pub fn to_markdown(&self) -> String {
        self.document(self.verdict_tables().into_iter().chain(self.case_tables()).collect())
            .to_markdown()
    }

    /// A summary in Markdown without the rows: verdicts, limits that were missed, criteria in words,
    /// provenance and notes.
    pub fn summary_to_markdown(&self) -> String {
        self.document(self.summary_tables()).to_markdown()
    }

    fn document(&self, tables: Vec<Table>) -> Document {
        Document { title: "Stability", opening: self.paragraphs(), tables, closing: Vec::new() }
    }

    /// Provenance, notes, verdicts, what was missed and the criteria in LaTeX, for `\input`; see
    /// [`LATEX_PACKAGES`](crate::output::LATEX_PACKAGES).
    pub fn to_latex(&self) -> String {
        self.document(self.summary_tables()).to_latex()
    }

    /// Verdicts, limits that were missed, and the criteria in words.
    fn summary_tables(&self) -> Vec<Table> {
        self.verdict_tables().into_iter().chain([conditions(&self.rows)]).collect()
    }

    /// The sweeps of every case over a parameter, drawn: names of files and SVG.
    #[cfg(feature = "plot")]
    fn svg_files(&self) -> Vec<(String, String)> {
        let figures = super::figures::figures(&self.rows).into_iter();
        figures.map(|(name, figure)| (format!("{name}.svg"), figure.to_svg())).collect()
    }
    /// Without the feature `plot` there are no figures.
    #[cfg(not(feature = "plot"))]
    fn svg_files(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// One page with all tables, which links these figures.
    fn page(&self, figures: &[(String, String)]) -> HtmlPage {
        let mut paragraphs = self.paragraphs().into_iter();
        let picture =
            |(file, _): &(String, String)| (file.trim_end_matches(".svg").to_owned(), file.clone());
        HtmlPage {
            title: "Stability".to_owned(),
            lead: paragraphs.next().expect("the heading is the first paragraph"),
            summary: self.verdict_tables(),
            sections: vec![
                Section {
                    title: "Reading".to_owned(),
                    paragraphs: paragraphs.collect(),
                    ..Section::default()
                },
                Section {
                    title: "Sweeps".to_owned(),
                    pictures: figures.iter().map(picture).collect(),
                    ..Section::default()
                },
                Section {
                    title: "Cases".to_owned(),
                    tables: [conditions(&self.rows)]
                        .into_iter()
                        .chain(self.case_tables())
                        .collect(),
                    ..Section::default()
                },
            ],
            ..HtmlPage::default()
        }
    }

    /// The paragraphs before the tables.
    fn paragraphs(&self) -> Vec<String> {
        let command = self.program.command.iter().map(|command| format!("Made by {command}."));
        let mut paragraphs = vec![self.heading()];
        paragraphs.extend(command);
        paragraphs.extend(READING.map(str::to_owned));
        paragraphs.extend(self.findings());
        paragraphs
    }

    /// The jobs that ended in an error.
    fn findings(&self) -> impl Iterator<Item = String> {
        self.failures.iter().map(|failure| format!("Not run to the end: {failure}."))
    }

    /// Program, provenance and the count of verdicts in one line.
    fn heading(&self) -> String {
        let effort = match self.effort {
            Effort::Trial => "trial",
            Effort::Quick => "quick",
            Effort::Full => "full",
        };
        let end = if self.complete { "" } else { " (interrupted or still running)" };
        let counts: Vec<String> = Verdict::ALL
            .into_iter()
            .map(|verdict| format!("{} {}", self.count(verdict), verdict.name()))
            .collect();
        let (program, rows) = (self.program.words(), self.rows.len());
        format!("{program}; {effort} run{end}; {rows} rows: {}.", counts.join(", "))
    }

    /// Writes `stability.json`, `.csv`, `.md` and `.tex` into a directory, which is made if need be, and, if the report
    /// is complete, `stability.html` and its figures `stability-CASE.svg`. Each file takes the place of an earlier one
    /// only when it is whole.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = vec![
            ("stability.json".to_owned(), self.to_json()),
            ("stability.csv".to_owned(), self.to_csv()),
            ("stability.md".to_owned(), self.to_markdown()),
            ("stability.tex".to_owned(), self.to_latex()),
        ];
        if self.complete {
            let figures = self.svg_files();
            files.push(("stability.html".to_owned(), self.page(&figures).to_html()));
            files.extend(figures);
        }
        files.iter().map(|(name, text)| replace_text(&directory.join(name), text)).collect()
    }
}
