//! The report of a stability study and the files it is written to.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::case::{Criterion, Effort};
use super::cases::criteria;
use super::row::{StabilityRow, Verdict};
use crate::error::Error;
use crate::files::replace_text;
use crate::output::csv;
use crate::output::document::Document;
use crate::study::Program;
use crate::study::row::distinct;
use crate::table::{Cell, Table, WIDTH};

/// Notes before the tables.
const READING: [&str; 3] = [
    "Every row has a figure, the limits it should keep, and the verdict that follows from the two. A row that fails as expected shows a choice of which theory or experience says that it is not enough there; a row that is missed is a failure that nobody announced. What is reported only has no limits.",
    "Schemes: p1 and p2, conforming linear and quadratic elements with bounds at nodes; cr, Crouzeix-Raviart elements with bounds on facet means; sipg and nipg, symmetric and non-symmetric interior penalty on broken linears; wopsip, the weakly over-penalised method on broken linears with bounds at vertices, wopsip:facet-means the same with bounds on facet means.",
    "Penalties: sipg has 1.5 times the proven bound, the least interior penalty that is provably enough on each cell, nipg 1/h_F, with h_F the diameter of a facet; sigma is the factor of 1/h_F. wopsip has eta/h_F^3, with eta the square of the diameter of the domain unless it is given; weight=anisotropic puts h^2 l_F in place of h_F^3, with h the mesh size and l_F the height of the cells over the facet. All carry the coefficient of the problem. L2 and H1 are norms of the error (H1 broken and without values), energy is the scheme's own norm, with its penalty. Problems are those of the catalogue of scenes; sines-Dd is Poisson's equation solved by the product of sin(pi x_k).",
];

/// All rows, in the order run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StabilityReport {
    /// The program.
    pub program: Program,
    /// Whether everything has run.
    pub complete: bool,
    /// The size of the study.
    pub effort: Effort,
    /// One row for every figure.
    pub rows: Vec<StabilityRow>,
    /// Runs that ended in an error, with the error.
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

    /// The criteria that have rows, each with its case and its rows.
    fn asked(
        &self,
    ) -> impl Iterator<Item = (&'static str, &'static Criterion, Vec<&StabilityRow>)> {
        let of = |(case, criterion): (_, &'static Criterion)| {
            let rows = self.rows.iter().filter(|row| row.criterion == criterion.name);
            (case, criterion, rows.collect::<Vec<_>>())
        };
        criteria().map(of).filter(|(.., rows)| !rows.is_empty())
    }

    /// Verdicts by scheme with its choices, all values of a factor that is swept in one line, and by criterion; then every
    /// row that misses its range, if there are any.
    fn tables(&self) -> Vec<Table> {
        let verdicts = Verdict::ALL.map(Verdict::name).join(",");
        let of_scheme = |series: String| {
            let rows: Vec<_> = self.rows.iter().filter(|row| row.series() == series).collect();
            [Cell::Words(series)].into_iter().chain(counts(&rows)).collect()
        };
        let schemes = distinct(self.rows.iter().map(StabilityRow::series)).into_iter();
        let of_criterion = |(case, criterion, rows): (&str, &Criterion, Vec<&StabilityRow>)| {
            let missed = rows.iter().filter(|row| row.verdict == Verdict::Missed);
            let missed = distinct(missed.map(|row| &row.label[..])).join("; ");
            let names = [case, criterion.name].map(|name| Cell::Words(name.to_owned()));
            names.into_iter().chain(counts(&rows)).chain([Cell::Words(missed)]).collect()
        };
        let missed = self.rows.iter().filter(|row| row.verdict == Verdict::Missed);
        let mut tables = vec![
            Table::new(
                "Verdicts by scheme",
                &format!("scheme,{verdicts}"),
                schemes.map(of_scheme).collect(),
            ),
            Table::new(
                "Verdicts by criterion",
                &format!("case,criterion,{verdicts},missed by"),
                self.asked().map(of_criterion).collect(),
            ),
            Table::new(
                "What was missed",
                "criterion,scheme,problem,n,at,quantity,expected,measured,further figures",
                missed.map(StabilityRow::cells).collect(),
            ),
        ];
        tables.retain(|table| !table.rows.is_empty());
        tables
    }

    /// Verdicts and what was missed, for a terminal: the report without its rows.
    pub fn summary(&self) -> String {
        let opening = [self.heading()].into_iter().chain(self.findings()).collect();
        let tables = self.tables();
        Document { title: "Stability", opening, tables, closing: Vec::new() }.to_text(WIDTH)
    }

    /// The report as JSON: `program`, `complete`, `criteria`, `rows` and `failures`. What does not apply is null.
    pub fn to_json(&self) -> String {
        let criterion = |(case, c): (_, &Criterion)| json!({ "name": c.name, "case": case, "sentence": c.sentence });
        let value = json!({
            "program": self.program,
            "complete": self.complete,
            "criteria": criteria().map(criterion).collect::<Vec<_>>(),
            "rows": self.rows,
            "failures": self.failures,
        });
        format!("{value:#}\n")
    }

    /// Provenance, notes, verdicts, what was missed, and the criteria in words.
    fn to_markdown(&self) -> String {
        let command = self.program.command.iter().map(|command| format!("Made by {command}."));
        let opening = [self.heading()].into_iter().chain(command);
        let opening = opening.chain(READING.map(str::to_owned)).chain(self.findings()).collect();
        let words = |(_, c, _): (_, &Criterion, _)| {
            [c.name, c.sentence].map(|text| Cell::Words(text.to_owned())).to_vec()
        };
        let criteria = self.asked().map(words).collect();
        let criteria = Table::new("The criteria", "criterion,condition", criteria);
        let tables = self.tables().into_iter().chain([criteria]).collect();
        Document { title: "Stability", opening, tables, closing: Vec::new() }.to_markdown()
    }

    /// The runs that ended in an error.
    fn findings(&self) -> impl Iterator<Item = String> {
        self.failures.iter().map(|failure| format!("Not run to the end: {failure}."))
    }

    /// Program, provenance and the count of verdicts in one line.
    fn heading(&self) -> String {
        let effort = self.effort.pick("quick", "full");
        let end = if self.complete { "" } else { " (interrupted or still running)" };
        let count = |verdict: Verdict| format!("{} {}", self.count(verdict), verdict.name());
        let (program, rows) = (self.program.words(), self.rows.len());
        format!(
            "{program}; {effort} run{end}; {rows} rows: {}.",
            Verdict::ALL.map(count).join(", ")
        )
    }

    /// Writes `stability.json` and `stability.csv` with all rows, and `stability.md` with the verdicts, into a directory,
    /// which is made if need be. Each file takes the place of an earlier one only when it is whole.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        let files =
            [("json", self.to_json()), ("csv", csv::lines(&self.rows)), ("md", self.to_markdown())];
        let path = |end| directory.join(format!("stability.{end}"));
        files.iter().map(|(end, text)| replace_text(&path(end), text)).collect()
    }
}

/// The number of rows for each verdict.
fn counts(rows: &[&StabilityRow]) -> [Cell; 5] {
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    Verdict::ALL.map(|verdict| Cell::whole(Some(count(verdict))))
}
