//! Reports as tables: a summary at the finest level of every series, and all levels.

mod columns;
pub(crate) mod levels;
mod remarks;
pub(crate) mod summary;
pub(crate) mod values;

use std::fmt;

use crate::study::report::Report;
use crate::study::row::Row;
use crate::table::{Table, WIDTH, wrapped};
use levels::{scenes, tables_of};
use summary::{lead, summaries};
use values::values_of;

/// The tables of values of all scenes that have any.
pub(crate) fn values(rows: &[Row]) -> Vec<Table> {
    scenes(rows).iter().filter_map(|(title, rows)| values_of(title, rows)).collect()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.summary_to_text(WIDTH))
    }
}

impl Report {
    /// The summary in lines of this many characters: a sentence that says what was compared and how it ended, and for
    /// each scene a table at the finest level of every series; then the values by name.
    pub fn summary_to_text(&self, width: usize) -> String {
        if self.rows.is_empty() {
            return String::new();
        }
        let tables = summaries(&self.rows).into_iter().chain(values(&self.rows));
        let tables = tables.map(|table| table.to_text(width));
        let lead = wrapped(&lead(&self.rows), width, 0);
        [lead].into_iter().chain(tables).collect::<Vec<_>>().join("\n")
    }

    /// The tables of all levels of each scene: errors, orders, counts and times, then energy, contact measure,
    /// resultant, bound and stages.
    pub fn tables(&self) -> Vec<Table> {
        scenes(&self.rows).iter().flat_map(|(scene, rows)| tables_of(scene, rows)).collect()
    }

    /// The tables of all levels in lines of this many characters.
    pub fn details_to_text(&self, width: usize) -> String {
        let tables = self.tables().into_iter().map(|table| table.to_text(width));
        tables.collect::<Vec<_>>().join("\n")
    }
}
