//! Counts of verdicts, and robust choices of penalties.

use super::cases::{OVER_FACTORS, SWEEPS, criteria};
use super::criterion::Criterion;
use super::row::{StabilityRow, Verdict, factor_in_words, short};
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

/// For every scheme whose penalty factor is swept, the longest part of the sweep in which each factor
/// keeps the limits, and what the factors next to it miss.
pub(crate) fn safe_ranges(rows: &[StabilityRow]) -> Vec<String> {
    let swept = || {
        let is_judged = |r: &StabilityRow| OVER_FACTORS.iter().any(|c| c.name == r.criterion);
        rows.iter().filter(move |r| r.sweeps_factor() && is_judged(r))
    };
    let sentence = |(scheme, parameter): (&String, &String)| {
        let mine = || swept().filter(|r| (&r.scheme, &r.parameter) == (scheme, parameter));
        let mut factors = distinct(mine().filter_map(|r| r.value));
        factors.sort_by(f64::total_cmp);
        let misses = |factor: f64| {
            let keeps = |r: &StabilityRow| r.measured.is_some_and(|x| r.expected.holds(x));
            mine().find(|r| r.value == Some(factor) && !keeps(r))
        };
        let runs = factors.chunk_by(|a, b| misses(*a).is_none() == misses(*b).is_none());
        let safe = runs.filter(|run| misses(run[0]).is_none()).max_by_key(|run| run.len());
        let (first, last) = (factors.first()?, factors.last()?);
        let measured = format!(
            "{} factors measured from {} to {}",
            factors.len(),
            short(*first),
            short(*last)
        );
        let Some((from, to)) = safe.and_then(|run| run.first().zip(run.last())) else {
            return Some(format!("{scheme}: no safe {parameter}; {measured}."));
        };
        let mut text = format!(
            "{scheme}: safe range of {parameter}: {} to {}; {measured}",
            short(*from),
            short(*to)
        );
        let below = factors.iter().rfind(|f| *f < from);
        for factor in below.into_iter().chain(factors.iter().find(|f| *f > to)) {
            if let Some(row) = misses(*factor) {
                let figure = row.figure_in_words().unwrap_or_else(|| "no solution".to_owned());
                text += &format!(
                    "; at {} {} on {} is {figure}, {} allowed",
                    short(*factor),
                    row.quantity,
                    row.problem,
                    row.expected.words()
                );
            }
        }
        Some(text + ".")
    };
    let series = distinct(swept().map(|r| (&r.scheme, &r.parameter)));
    series.into_iter().filter_map(sentence).collect()
}

/// The penalties of a scheme that stay within all limits of a case, for schemes with several
/// penalties; sweeps of factors have their [`safe_ranges`].
pub(crate) fn robust(rows: &[StabilityRow]) -> Vec<String> {
    let sentence = |(case, scheme): (&String, &String)| {
        let mine = || rows.iter().filter(|r| (&r.case, &r.scheme) == (case, scheme));
        let judged = |label: &String| {
            let of_label = mine().filter(|r| r.label == *label);
            let verdicts = of_label.filter_map(|r| match r.verdict {
                // a solve that failed keeps nothing, whatever its limits
                Verdict::Reported => r.measured.is_none().then_some(false),
                Verdict::NotApplicable => None,
                verdict => Some(matches!(verdict, Verdict::Met | Verdict::BetterThanExpected)),
            });
            verdicts.collect::<Vec<bool>>()
        };
        let (mut robust, mut others) = (Vec::new(), Vec::new());
        for label in distinct(mine().map(|r| &r.label)) {
            let verdicts = judged(label);
            let (kept, all) = (verdicts.iter().filter(|kept| **kept).count(), verdicts.len());
            match kept == all {
                _ if all == 0 => {}
                true => robust.push(format!("\"{label}\"")),
                false => others.push(format!("\"{label}\" ({kept} of {all} rows)")),
            }
        }
        let text = match (robust.len(), others.len()) {
            (0, 0) | (1, 0) | (0, 1) => return None,
            (_, 0) => format!("every penalty shown is robust: {}", robust.join(", ")),
            (0, _) => format!("no penalty shown is robust: {}", others.join(", ")),
            _ => format!("robust: {}; not robust: {}", robust.join(", "), others.join(", ")),
        };
        Some(format!("{case}, {scheme}: {text}."))
    };
    let compared = rows.iter().filter(|r| !SWEEPS.contains(&&r.case[..]));
    distinct(compared.map(|r| (&r.case, &r.scheme))).into_iter().filter_map(sentence).collect()
}
