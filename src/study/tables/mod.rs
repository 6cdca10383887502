//! Reports as tables: a summary at the finest level of every series, and all levels.

pub(crate) mod levels;
pub(crate) mod remarks;
pub(crate) mod summary;

use std::fmt;

use crate::study::report::Report;
use crate::table::{WIDTH, wrapped};
use levels::write_tables;
use summary::{lead, summaries};

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.summary_to_text(WIDTH))
    }
}

impl Report {
    /// What was compared and how it ended, and for each scene one table at the finest level of every series, in
    /// lines of this many characters.
    pub fn summary_to_text(&self, width: usize) -> String {
        if self.rows.is_empty() {
            return String::new();
        }
        let tables = summaries(&self.rows).into_iter().map(|table| table.to_text(width));
        let lead = wrapped(&lead(&self.rows), width, 0);
        [lead].into_iter().chain(tables).collect::<Vec<_>>().join("\n")
    }

    /// The tables of all levels: errors, orders, counts and times, then energy, contact measure, resultant, bound
    /// and stages.
    pub fn details_to_text(&self) -> String {
        let mut text = String::new();
        write_tables(&mut text, &self.rows).expect("writing to a text does not fail");
        text
    }
}
