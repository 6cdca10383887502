//! Counts of verdicts, and what was missed.

use super::cases::criteria;
use super::criterion::Criterion;
use super::row::{StabilityRow, Verdict, factor_in_words};
use crate::study::row::distinct;
use crate::table::{Cell, Table};

/// The heads of a table with a column for each verdict.
fn heads(before: &str, after: &str) -> String {
    format!("{before},{}{after}", Verdict::ALL.map(Verdict::name).join(","))
}

/// The number of rows for each verdict.
fn counts<'r>(rows: impl Iterator<Item = &'r StabilityRow> + Clone) -> [Cell; 6] {
    let count = |verdict| rows.clone().filter(|row| row.verdict == verdict).count();
    Verdict::ALL.map(|verdict| Cell::whole(Some(count(verdict))))
}

/// Verdicts of every scheme with its choices; all values of a factor that is swept are one line.
pub(crate) fn by_scheme(rows: &[StabilityRow]) -> Table {
    let line = |series: String| {
        let mine = counts(rows.iter().filter(|r| r.series() == series));
        [Cell::Words(series.clone())].into_iter().chain(mine).collect()
    };
    let lines = distinct(rows.iter().map(StabilityRow::series)).into_iter().map(line).collect();
    Table::new("Verdicts by scheme", &heads("scheme", ""), lines)
}

/// The criteria of these rows, with their cases.
fn asked(rows: &[StabilityRow]) -> impl Iterator<Item = (&'static str, &'static Criterion)> {
    criteria().filter(|of| rows.iter().any(|r| r.criterion == of.1.name))
}

/// Verdicts of every criterion.
pub(crate) fn by_criterion(rows: &[StabilityRow]) -> Table {
    let line = |(case, criterion): (&str, &Criterion)| {
        let mine = rows.iter().filter(|r| r.criterion == criterion.name);
        let mut cells = vec![Cell::Words(case.to_owned()), Cell::Words(criterion.name.to_owned())];
        cells.extend(counts(mine.clone()));
        let failing = mine.filter(|r| r.verdict == Verdict::Missed).map(|r| &r.label[..]);
        cells.push(Cell::Words(distinct(failing).join("; ")));
        cells
    };
    let lines = asked(rows).map(line).collect();
    Table::new("Verdicts by criterion", &heads("case,criterion", ",missed by"), lines)
}

/// Every row that misses its range, with the factor; no table without such rows.
pub(crate) fn missed(rows: &[StabilityRow]) -> Option<Table> {
    let line = |row: &StabilityRow| {
        vec![
            Cell::Words(row.criterion.clone()),
            Cell::Words(row.label.clone()),
            Cell::Words(format!("{} {}", row.problem, row.precision)),
            Cell::whole(row.level),
            Cell::Words(row.place()),
            Cell::Words(row.expected.words()),
            Cell::number(row.figure_in_words()),
            Cell::number(row.missed_by.map(factor_in_words)),
            Cell::Words(row.detail.clone()),
        ]
    };
    let rows: Vec<_> = rows.iter().filter(|r| r.verdict == Verdict::Missed).map(line).collect();
    let heads = "criterion,scheme,problem,n,at,expected,measured,factor,further figures";
    let title = "What was missed, and by what factor";
    (!rows.is_empty()).then(|| Table::new(title, heads, rows))
}

/// The criteria in words.
pub(crate) fn conditions(rows: &[StabilityRow]) -> Table {
    let line =
        |(_, c): (_, &Criterion)| vec![Cell::Words(c.name.to_owned()), Cell::Words(c.sentence())];
    Table::new("The criteria", "criterion,condition", asked(rows).map(line).collect())
}
