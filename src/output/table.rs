//! Tables, as text and in Markdown.

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Words.
    Words(String),
    /// A number, perhaps with a power of ten as in `1.37e-2`, and a remark in parentheses.
    Number(String, Option<String>),
    /// A value that does not apply.
    Nothing,
}

/// A table with a title, and with remarks below. Words are aligned to the left, numbers to the
/// right.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub(crate) title: String,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
    pub(crate) remarks: Vec<String>,
}

impl Cell {
    pub(crate) fn whole(x: Option<usize>) -> Self {
        x.map_or(Cell::Nothing, |x| Cell::Number(x.to_string(), None))
    }
    /// Three digits.
    pub(crate) fn scientific(x: Option<f64>) -> Self {
        x.map_or(Cell::Nothing, |x| Cell::Number(format!("{x:.2e}"), None))
    }

    pub(super) fn plain(&self) -> String {
        match self {
            Cell::Words(text) | Cell::Number(text, None) => text.clone(),
            Cell::Number(text, Some(remark)) => format!("{text} ({remark})"),
            Cell::Nothing => "-".to_owned(),
        }
    }
}

impl Table {
    pub(super) fn is_left(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Cell::Words(_)))
    }

    /// The title as a name of files and labels: letters and digits, and `-` for all else.
    pub fn slug(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { ' ' };
        let text: String = self.title.chars().map(plain).collect();
        text.split_whitespace().collect::<Vec<_>>().join("-")
    }

    /// Aligned columns for a terminal.
    pub fn to_text(&self) -> String {
        let cells: Vec<Vec<String>> = std::iter::once(self.columns.clone())
            .chain(self.rows.iter().map(|row| row.iter().map(Cell::plain).collect()))
            .collect();
        let width = |k: usize| cells.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let mut text = format!("{}\n", self.title);
        for row in &cells {
            let mut line = String::new();
            for (k, (cell, width)) in row.iter().zip(&widths).enumerate() {
                line += &match self.is_left(k) {
                    true => format!("{cell:<width$}  "),
                    false => format!("{cell:>width$}  "),
                };
            }
            text += line.trim_end();
            text.push('\n');
        }
        for remark in &self.remarks {
            text += &format!("  {remark}\n");
        }
        text
    }

    /// A heading, a table with bars, and a list of remarks.
    pub fn to_markdown(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = String>| {
            format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
        };
        let mut text = format!("### {}\n\n", markdown(&self.title));
        text += &line(&mut self.columns.iter().map(|c| markdown(c)));
        let rule = |k| if self.is_left(k) { ":--" } else { "--:" }.to_owned();
        text += &line(&mut (0..self.columns.len()).map(rule));
        for row in &self.rows {
            text += &line(&mut row.iter().map(|cell| markdown(&cell.plain())));
        }
        for (k, remark) in self.remarks.iter().enumerate() {
            text += if k == 0 { "\n" } else { "" };
            text += &format!("- {}\n", markdown(remark));
        }
        text
    }
}

/// A text with the markup characters of Markdown escaped.
pub(crate) fn markdown(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        if matches!(c, '|' | '*' | '_' | '`' | '\\' | '<' | '[' | ']') {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::{Cell, Table, markdown};

    #[test]
    fn words_stand_left_and_numbers_right() {
        let table = Table {
            title: "t".into(),
            columns: vec!["scheme".into(), "n".into()],
            rows: vec![
                vec![Cell::Words("p1".into()), Cell::whole(Some(8))],
                vec![Cell::Words("wopsip".into()), Cell::Nothing],
                vec![Cell::Words("cr".into()), Cell::Number("1e-3".into(), Some("1.5".into()))],
            ],
            remarks: vec!["100% of _all_".into()],
        };
        let text = "t\nscheme           n\np1               8\nwopsip           -\n\
                    cr      1e-3 (1.5)\n  100% of _all_\n";
        assert_eq!(table.to_text(), text);
        assert!(table.to_markdown().contains("| :-- | --: |\n| p1 | 8 |\n| wopsip | - |\n"));
        assert_eq!(markdown("a|b_c*d"), "a\\|b\\_c\\*d");
    }
}
