//! Tables in LaTeX, no wider than the text of a page.

use super::table::{Cell, Table};

impl Table {
    /// A `longtable` with the label `tab:` and the [slug](Self::slug), not wider than the text: long words
    /// are broken, and a table with too many columns for the width of a page is turned. See
    /// [`LATEX_PACKAGES`].
    pub fn to_latex(&self) -> String {
        let layout = LatexLayout::new(self);
        let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
        let head =
            line((0..self.columns.len()).map(|k| layout.words(k, &self.columns[k])).collect());
        let mut text = format!(
            "{{\\scriptsize\\setlength{{\\tabcolsep}}{{2pt}}\\sisetup{{{SISETUP}}}\n\
             \\begin{{longtable}}{{{}}}\n\\caption{{{}}}\\label{{tab:{}}}\\\\\n\
             \\toprule\n{head}\\midrule\n\\endfirsthead\n\
             \\toprule\n{head}\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n",
            layout.columns,
            latex(&self.title),
            self.slug(),
        );
        for row in &self.rows {
            let cell = |(k, cell): (usize, &Cell)| match cell {
                Cell::Words(words) => layout.words(k, words),
                Cell::Number(..) => latex_number(&cell.plain()),
                Cell::Nothing => "--".to_owned(),
            };
            text += &line(row.iter().enumerate().map(cell).collect());
        }
        text += "\\end{longtable}\n";
        for remark in &self.remarks {
            text += &format!("{{\\raggedright\\noindent {}\\par}}\n", latex(remark));
        }
        text += "}\n";
        match layout.is_turned {
            true => format!("\\begin{{landscape}}\n{text}\\end{{landscape}}\n"),
            false => text,
        }
    }
}

/// The files of tables in LaTeX: `NAME.tex` with paragraphs and the tables of the summary, and every table,
/// these and further ones, alone as `table-TITLE.tex`.
pub(crate) fn latex_files(
    name: &str,
    paragraphs: &[String],
    summary: &[Table],
    further: &[Table],
) -> Vec<(String, String)> {
    let needs = format!("% needs {LATEX_PACKAGES}\n");
    let mut text = needs.clone();
    for paragraph in paragraphs {
        text += &format!("{{\\raggedright\\noindent {}\\par}}\n", latex(paragraph));
    }
    summary.iter().for_each(|table| text += &table.to_latex());
    let alone = |t: &Table| (format!("table-{}.tex", t.slug()), format!("{needs}{}", t.to_latex()));
    let tables = summary.iter().chain(further).map(alone);
    [(format!("{name}.tex"), text)].into_iter().chain(tables).collect()
}

/// What a document with tables needs in its preamble.
pub const LATEX_PACKAGES: &str = "\\usepackage{array,booktabs,longtable,pdflscape,siunitx}";

/// Numbers take little room.
const SISETUP: &str = "output-exponent-marker=\\ensuremath{\\mathrm{e}},tight-spacing=true";

/// Widths of the columns of a table in LaTeX, in points of a font of seven points.
struct LatexLayout {
    /// The argument of `longtable`.
    columns: String,
    is_turned: bool,
    is_broken: Vec<bool>,
}

impl LatexLayout {
    /// Widths of the text and of a character, and what stands between columns.
    const TEXT: [f64; 2] = [340.0, 540.0];
    const CHARACTER: f64 = 4.1;
    const BETWEEN: f64 = 4.0;

    fn new(table: &Table) -> Self {
        let n = table.columns.len();
        let widest = |k: usize, width: &dyn Fn(&str) -> usize| {
            let cells = table.rows.iter().map(|row| width(&row[k].plain()));
            cells.chain([width(&table.columns[k])]).max().unwrap_or(0) as f64 * Self::CHARACTER
        };
        // a minus sign and the groups of digits are wider than they look
        let natural: Vec<f64> = (0..n)
            .map(|k| match table.is_left(k) {
                true => widest(k, &|text| text.chars().count()),
                false => widest(k, &|text| text.chars().count() + usize::from(text.len() > 4)),
            })
            .collect();
        let piece = |text: &str| text.split(is_break).map(|p| p.chars().count() + 1).max();
        let least: Vec<f64> = (0..n)
            .map(|k| match table.is_left(k) {
                true => widest(k, &|text| piece(text).unwrap_or(0)).min(natural[k]),
                false => natural[k],
            })
            .collect();
        let room = |text: f64| text - n as f64 * Self::BETWEEN;
        let sum = |widths: &[f64]| widths.iter().sum::<f64>();
        let is_turned = sum(&least) > room(Self::TEXT[0]);
        let text = Self::TEXT[usize::from(is_turned)];
        let is_wide = sum(&natural) > room(text);
        // what is left goes to the columns that lack most
        let lack: Vec<f64> = natural.iter().zip(&least).map(|(n, l)| (n - l).sqrt()).collect();
        let share = (room(text) - sum(&least)) / sum(&lack).max(1.0);
        let is_broken: Vec<bool> = (0..n).map(|k| is_wide && table.is_left(k)).collect();
        let column = |k: usize| match (is_broken[k], table.is_left(k)) {
            (true, _) => {
                let width = (least[k] + share * lack[k]).min(natural[k]) / text;
                format!(">{{\\raggedright\\arraybackslash}}p{{{width:.3}\\linewidth}}")
            }
            (false, true) => "l".to_owned(),
            (false, false) => "r".to_owned(),
        };
        Self { columns: (0..n).map(column).collect(), is_turned, is_broken }
    }

    /// Words in a column, which may break after the signs of names where lines are broken.
    fn words(&self, column: usize, words: &str) -> String {
        if !self.is_broken[column] {
            return latex(words);
        }
        let pieces = words.split_inclusive(|c| is_break(c) && c != ' ' && c != '-');
        pieces.map(latex).collect::<Vec<_>>().join("\\allowbreak{}")
    }
}

/// Whether a line may break after a character.
fn is_break(c: char) -> bool {
    matches!(c, ' ' | '-' | ':' | '@' | '=' | ',' | '/' | '_')
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
pub(crate) fn latex(text: &str) -> String {
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

#[cfg(test)]
mod tests {
    use super::{LatexLayout, latex, latex_number};
    use crate::output::Table;
    use crate::output::table::Cell;

    #[test]
    fn special_characters_are_written_as_they_look() {
        assert_eq!(
            latex("a_b & 50% {x} \\ ~^"),
            "a\\_b \\& 50\\% \\{x\\} \\textbackslash{} \\textasciitilde{}\\textasciicircum{}"
        );
        assert_eq!(latex("$1 #2"), "\\$1 \\#2");
        assert_eq!(latex_number("> 1.8e-2 (1.5)"), "\\textgreater{} \\num{1.8e-2} (\\num{1.5})");
        assert_eq!(latex_number("not run"), "not run");
    }

    #[test]
    fn wide_tables_are_broken_and_wider_ones_turned() {
        let table = |columns: usize, words: &str| Table {
            title: "Case: one_two".into(),
            columns: vec!["head".into(); columns],
            rows: vec![vec![Cell::Words(words.into()); columns]],
            remarks: Vec::new(),
        };
        let text = table(3, "short").to_latex();
        assert!(text.contains("{lll}") && text.contains("\\label{tab:case-one-two}"), "{text}");
        let long = "words that do not fit into a third of the width of the text of a page at all";
        let text = table(3, long).to_latex();
        assert!(text.contains("p{0.3") && !text.contains("landscape"), "{text}");
        let text = table(9, "error-on-stretched-cells").to_latex();
        assert!(text.contains("\\begin{landscape}") && text.contains("linewidth"), "{text}");
        assert!(!LatexLayout::new(&table(2, "a")).is_turned);
    }
}
