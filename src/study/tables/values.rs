//! The values by name for which a problem asks, with their limits.

use crate::study::extrapolate::extrapolate;
use crate::study::row::Row;
use crate::study::series::series_of;
use crate::table::{Cell, Table};

/// The table of the rows of a scene whose problem asks for values: each value at the finest level of each series.
pub(crate) fn values_of(title: &str, rows: &[&Row]) -> Option<Table> {
    let any = |has: fn(&Row) -> bool| rows.iter().any(|row| has(row));
    if !any(|row| !row.values.is_empty()) {
        return None;
    }
    let (has_errors, has_places) =
        (any(|row| !row.error.values.is_empty()), any(|row| !row.values_at.is_empty()));
    let mut table = Table { title: format!("{title}: values"), ..Table::default() };
    table.detail =
        ", at the finest level of each scheme, and the limits of three levels".to_owned();
    let mut columns = vec!["value", "scheme", "n", "found"];
    columns.extend(has_errors.then_some("error"));
    columns.extend(["limit", "order"]);
    columns.extend(has_places.then_some("place"));
    table.columns = columns.into_iter().map(str::to_owned).collect();
    let series: Vec<_> = series_of(rows)
        .into_iter()
        .map(|series| (extrapolate(&series.rows).pop(), series))
        .collect();
    let mut names: Vec<&String> = rows.iter().flat_map(|row| row.values.keys()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        for (limits, series) in &series {
            let Some(row) = series.rows.last() else { continue };
            let limit = limits.as_ref().and_then(|found| *found.values.get(name)?);
            let words = |text: &str| Cell::Words(text.to_owned());
            let mut cells = vec![words(name), words(&series.name), Cell::whole(Some(row.level))];
            cells.push(Cell::digits(row.values.get(name).copied().flatten(), 6));
            if has_errors {
                cells.push(Cell::digits(row.error.values.get(name).copied().flatten(), 1));
            }
            cells.push(Cell::digits(limit.map(|limit| limit.value), 6));
            cells.push(Cell::fixed(limit.and_then(|limit| limit.order)));
            if has_places {
                let place = row.values_at.get(name);
                let place = place.map(|x| x.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>());
                cells.push(Cell::number(place.map(|x| format!("({})", x.join(", ")))));
            }
            table.rows.push(cells);
        }
    }
    Some(table)
}
