//! Paragraphs and tables as text and in Markdown.

use crate::table::{Table, markdown, wrapped};

/// The text of a report: paragraphs, tables, and paragraphs after them.
#[derive(Default)]
pub(crate) struct Document {
    pub title: &'static str,
    pub opening: Vec<String>,
    pub tables: Vec<Table>,
    pub closing: Vec<String>,
}

impl Document {
    /// For a terminal, in lines of this many characters, without the title.
    pub fn to_text(&self, width: usize) -> String {
        let paragraphs = |of: &[String]| of.iter().map(|p| wrapped(p, width, 0)).collect();
        let tables = self.tables.iter().map(|table| table.to_text(width));
        let parts = [paragraphs(&self.opening)].into_iter().chain(tables);
        let parts =
            parts.chain([paragraphs(&self.closing)]).filter(|part: &String| !part.is_empty());
        parts.collect::<Vec<_>>().join("\n")
    }
    /// In Markdown.
    pub fn to_markdown(&self) -> String {
        let paragraphs = |of: &[String]| of.iter().map(|p| markdown(p) + "\n").collect::<Vec<_>>();
        let tables = self.tables.iter().map(Table::to_markdown);
        let parts = [format!("# {}\n", self.title)].into_iter().chain(paragraphs(&self.opening));
        parts.chain(tables).chain(paragraphs(&self.closing)).collect::<Vec<_>>().join("\n")
    }
}
