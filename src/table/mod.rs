//! Tables, as text for a terminal, in Markdown and in LaTeX.

#[cfg(feature = "report")]
mod latex;
mod number;
mod text;

#[cfg(feature = "report")]
pub use latex::LATEX_PACKAGES;
#[cfg(feature = "report")]
pub(crate) use latex::latex_document;
pub(crate) use number::{digits, fixed, seconds};
pub(crate) use text::wrapped;

/// Characters in a line where the width of the terminal is not known.
pub(crate) const WIDTH: usize = 100;

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Words.
    Words(String),
    /// A number, perhaps with a power of ten as in `1.37e-2`, and a remark in parentheses.
    Number(String, Option<String>),
    /// The best number of its column, which each format marks in its way.
    Best(String, Option<String>),
    /// A value that does not apply.
    Nothing,
}

/// A table with a title, and with remarks below. Words are aligned to the left, numbers to the
/// right.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The name of the table, also in labels.
    pub(crate) title: String,
    /// The text after the title, which may change from run to run: levels, errors, settings.
    pub(crate) detail: String,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
    pub(crate) remarks: Vec<String>,
}

impl Cell {
    /// A number that is written already.
    pub(crate) fn number(text: Option<String>) -> Self {
        text.map_or(Cell::Nothing, |text| Cell::Number(text, None))
    }
    /// A number of things.
    pub(crate) fn whole(x: Option<usize>) -> Self {
        Self::number(x.map(|x| x.to_string()))
    }
    /// So many digits after the point, and the power of ten.
    pub(crate) fn digits(x: Option<f64>, places: usize) -> Self {
        Self::number(x.map(|x| digits(x, places)))
    }
    /// Two digits after the point.
    pub(crate) fn fixed(x: Option<f64>) -> Self {
        Self::number(x.map(fixed))
    }

    /// The text of the cell, without a mark.
    pub(crate) fn plain(&self) -> String {
        match self {
            Cell::Words(text) | Cell::Number(text, None) | Cell::Best(text, None) => text.clone(),
            Cell::Number(text, Some(remark)) | Cell::Best(text, Some(remark)) => {
                format!("{text} ({remark})")
            }
            Cell::Nothing => "-".to_owned(),
        }
    }
}

impl Table {
    /// A table with these heads, separated by commas.
    #[cfg(feature = "report")]
    pub(crate) fn new(title: impl Into<String>, heads: &str, rows: Vec<Vec<Cell>>) -> Self {
        let columns = heads.split(',').map(str::to_owned).collect();
        Self { title: title.into(), columns, rows, ..Self::default() }
    }

    /// The title with its detail.
    pub(crate) fn caption(&self) -> String {
        format!("{}{}", self.title, self.detail)
    }

    /// Whether a column is one of words.
    pub(crate) fn is_left(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Cell::Words(_)))
    }

    /// The title as a label: letters and digits, and `-` for all else.
    #[cfg(feature = "report")]
    fn slug(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { ' ' };
        let text: String = self.title.chars().map(plain).collect();
        text.split_whitespace().collect::<Vec<_>>().join("-")
    }

    /// A heading, a table with bars, and a list of remarks; the best number of a column is bold.
    pub fn to_markdown(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = String>| {
            format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
        };
        let mut text = format!("### {}\n\n", markdown(&self.caption()));
        text += &line(&mut self.columns.iter().map(|c| markdown(c)));
        let rule = |k| if self.is_left(k) { ":--" } else { "--:" }.to_owned();
        text += &line(&mut (0..self.columns.len()).map(rule));
        let cell = |cell: &Cell| match cell {
            Cell::Best(..) => format!("**{}**", markdown(&cell.plain())),
            _ => markdown(&cell.plain()),
        };
        for row in &self.rows {
            text += &line(&mut row.iter().map(cell));
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
