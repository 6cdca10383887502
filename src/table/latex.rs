//! Tables in LaTeX, as a paper prints them.

use super::{Cell, Table};

/// The lines that a document with tables needs in its preamble.
///
/// Numbers of `siunitx` are bold where the text around them is.
pub const LATEX_PACKAGES: &str = "\\usepackage{booktabs,siunitx}\\sisetup{detect-weight=true}";

impl Table {
    /// A `table` with a `tabular` of all columns, the remarks below it, the caption and the label `tab:` with the title. See
    /// [`LATEX_PACKAGES`].
    pub fn to_latex(&self) -> String {
        let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
        let kind = |k| if self.is_left(k) { 'l' } else { 'r' };
        let mut text = format!(
            "\\begin{{table}}\n\\centering\n\\caption{{{}}}\\label{{tab:{}}}\n\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\midrule\n",
            latex(&self.caption()),
            self.slug(),
            (0..self.columns.len()).map(kind).collect::<String>(),
            line(self.columns.iter().map(|name| latex(name)).collect()),
        );
        let cell = |cell: &Cell| match cell {
            Cell::Words(words) => latex(words),
            Cell::Number(..) => latex_number(&cell.plain()),
            Cell::Best(..) => format!("\\textbf{{{}}}", latex_number(&cell.plain())),
            Cell::Nothing => "--".to_owned(),
        };
        for row in &self.rows {
            text += &line(row.iter().map(cell).collect());
        }
        text += "\\bottomrule\n\\end{tabular}\n";
        for remark in &self.remarks {
            text += &format!("\\par\\smallskip{{\\footnotesize {}\\par}}\n", latex(remark));
        }
        text + "\\end{table}\n"
    }
}

/// Paragraphs and tables as one file.
pub(crate) fn latex_document(paragraphs: &[String], tables: &[Table]) -> String {
    let mut text = format!("% needs {LATEX_PACKAGES}\n");
    for paragraph in paragraphs {
        text += &format!("{}\n\n", latex(paragraph));
    }
    tables.iter().for_each(|table| text += &table.to_latex());
    text
}

/// A text in which every word that is a number is written by `\num` of the package `siunitx`.
fn latex_number(text: &str) -> String {
    let word = |word: &str| {
        let number = word.trim_start_matches('(').trim_end_matches(')');
        let is_number = number.ends_with(|c: char| c.is_ascii_digit());
        match is_number && number.parse::<f64>().is_ok() {
            true => latex(word).replacen(number, &format!("\\num{{{number}}}"), 1),
            false => latex(word),
        }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A text with the special characters of LaTeX escaped.
fn latex(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '\\' => escaped += "\\textbackslash{}",
            '~' => escaped += "\\textasciitilde{}",
            '^' => escaped += "\\textasciicircum{}",
            '<' => escaped += "\\textless{}",
            '>' => escaped += "\\textgreater{}",
            '|' => escaped += "\\textbar{}",
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(c);
            }
            _ => escaped.push(c),
        }
    }
    escaped
}
