//! Counts of verdicts, and robust choices of penalties.

use super::criteria::{CRITERIA, Criterion};
use super::row::{StabilityRow, Verdict, factor_in_words, short};
use crate::study::row::distinct;
use crate::table::{Cell, Table};

fn count<'r>(rows: impl Iterator<Item = &'r StabilityRow>, verdict: Verdict) -> usize {
    rows.filter(|row| row.verdict == verdict).count()
}

/// A choice without the power of ten of a factor that is swept.
fn kind(choice: &str) -> String {
    match choice.split_once("/h_F^3") {
        Some((factor, rest)) if factor != "1" && factor.parse::<f64>().is_ok() => {
            format!("other factors/h_F^3{rest}")
        }
        _ => choice.to_owned(),
    }
}

/// Verdicts of every scheme and choice.
pub(crate) fn by_scheme(rows: &[StabilityRow]) -> Table {
    let choices = distinct(rows.iter().map(|r| (r.scheme.clone(), kind(&r.choice))));
    let line = |(scheme, choice): (String, String)| {
        let mine = || rows.iter().filter(|r| r.scheme == scheme && kind(&r.choice) == choice);
        let counts = Verdict::ALL.map(|verdict| Cell::whole(Some(count(mine(), verdict))));
        let mut cells = vec![Cell::Words(scheme.clone()), Cell::Words(choice.clone())];
        cells.extend(counts);
        cells
    };
    let heads = format!("scheme,penalty,{}", Verdict::ALL.map(Verdict::name).join(","));
    let rows = choices.into_iter().map(line).collect();
    Table::new("Verdicts by scheme and penalty", &heads, rows)
}

/// Verdicts of every criterion.
pub(crate) fn by_criterion(rows: &[StabilityRow]) -> Table {
    let asked = CRITERIA.iter().filter(|c| rows.iter().any(|r| r.criterion == c.name));
    let line = |c: &Criterion| {
        let mine = || rows.iter().filter(|r| r.criterion == c.name);
        let mut cells = vec![Cell::Words(c.case.to_owned()), Cell::Words(c.name.to_owned())];
        cells.extend(Verdict::ALL.map(|verdict| Cell::whole(Some(count(mine(), verdict)))));
        let failing = distinct(
            mine()
                .filter(|r| r.verdict == Verdict::Missed)
                .map(|r| format!("{} {}", r.scheme, r.choice).trim().to_owned()),
        );
        cells.push(Cell::Words(failing.join("; ")));
        cells
    };
    let heads = format!("case,criterion,{},missed by", Verdict::ALL.map(Verdict::name).join(","));
    Table::new("Verdicts by criterion", &heads, asked.map(line).collect())
}

/// Every row that misses its range, with the factor; no table without such rows.
pub(crate) fn missed(rows: &[StabilityRow]) -> Option<Table> {
    let line = |row: &StabilityRow| {
        let sweep =
            row.value.map_or(String::new(), |value| format!("{} {}", row.parameter, short(value)));
        vec![
            Cell::Words(row.criterion.clone()),
            Cell::Words(format!("{} {}", row.scheme, row.choice).trim().to_owned()),
            Cell::Words(format!("{} {}", row.problem, row.precision)),
            Cell::whole(row.level),
            Cell::Words(sweep),
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
pub(crate) fn criteria(rows: &[StabilityRow]) -> Table {
    let asked = CRITERIA.iter().filter(|c| rows.iter().any(|r| r.criterion == c.name));
    let words = |text: &str| Cell::Words(text.to_owned());
    let rows = asked.map(|c| vec![words(c.name), words(c.sentence)]).collect();
    Table::new("The criteria", "criterion,condition", rows)
}

/// The criteria of errors, of forces and of definiteness over sweeps of a penalty factor.
const OVER_FACTORS: [&str; 6] = [
    "definite-for-every-factor",
    "error-of-large-factors",
    "multiplier-of-large-factors",
    "equilibrium",
    "inertia",
    "error-of-interior-penalty",
];
/// The cases of these sweeps.
const SWEEPS: [&str; 2] = ["penalty-factor", "coercivity"];

/// For every scheme whose penalty factor is swept, the longest part of the sweep in which each factor
/// keeps the limits, and what the factors next to it miss.
pub(crate) fn safe_ranges(rows: &[StabilityRow]) -> Vec<String> {
    let swept = || {
        let of_factor = |r: &&StabilityRow| r.parameter == "eta" || r.parameter == "sigma";
        rows.iter().filter(|r| OVER_FACTORS.contains(&&r.criterion[..])).filter(of_factor)
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
    let mut sentences = Vec::new();
    let compared = rows.iter().filter(|r| !SWEEPS.contains(&&r.case[..]));
    for key in distinct(compared.map(|r| (r.case.clone(), r.scheme.clone()))) {
        let mine = || rows.iter().filter(|r| (&r.case, &r.scheme) == (&key.0, &key.1));
        let choices = distinct(mine().map(|r| r.choice.clone()));
        let judged = |choice: &str| {
            let of = |v: Verdict| count(mine().filter(|r| r.choice == choice), v);
            let kept = of(Verdict::Met) + of(Verdict::BetterThanExpected);
            let failed = |r: &&StabilityRow| {
                r.choice == choice && r.verdict == Verdict::Reported && r.measured.is_none()
            };
            let other = of(Verdict::Missed) + of(Verdict::FailsAsExpected);
            (kept, kept + other + mine().filter(failed).count())
        };
        let counts: Vec<(String, usize, usize)> = choices
            .into_iter()
            .map(|c| {
                let (kept, all) = judged(&c);
                (c, kept, all)
            })
            .filter(|c| c.2 > 0)
            .collect();
        if counts.len() < 2 {
            continue;
        }
        let list = |wanted: bool| {
            let chosen = counts.iter().filter(|(_, kept, all)| (kept == all) == wanted);
            let words = |(c, kept, all): &(String, usize, usize)| {
                let name = if c.is_empty() { "default" } else { c };
                if wanted {
                    format!("\"{name}\"")
                } else {
                    format!("\"{name}\" ({kept} of {all} rows)")
                }
            };
            chosen.map(words).collect::<Vec<_>>()
        };
        let (robust, others) = (list(true), list(false));
        let text = match (robust.is_empty(), others.is_empty()) {
            (false, true) => format!("every penalty shown is robust: {}", robust.join(", ")),
            (false, false) => {
                format!("robust: {}; not robust: {}", robust.join(", "), others.join(", "))
            }
            _ => format!("no penalty shown is robust: {}", others.join(", ")),
        };
        sentences.push(format!("{}, {}: {text}.", key.0, key.1));
    }
    sentences
}
