//! Tables in the lines of a terminal.

use super::{Cell, Table};

/// The mark before the best number of a column.
const BEST: &str = "\u{2022} ";

/// Longer words of a last column stand below their line where lines are too long.
const LONGEST_STATUS: usize = 16;

impl Table {
    /// Aligned columns in lines of this many characters. Heads are broken where their columns are narrower. Where lines
    /// are too long, names in the first column are broken after their signs. Words of the last column that do not
    /// fit go on lines of their own. Where most rows have the name of the one before
    /// them, blank lines stand between names.
    pub fn to_text(&self, width: usize) -> String {
        let cell = |cell: &Cell| match cell {
            Cell::Best(..) => format!("{BEST}{}", cell.plain()),
            _ => cell.plain(),
        };
        let cells: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
        let (widths, gap) = self.widths(&cells, width);
        let mut text = wrapped(&self.caption(), width, 4);
        text += &self.line(&self.columns, &widths, gap);
        let last = self.columns.len() - 1;
        let is_new = |k: usize| k > 0 && self.rows[k][0] != self.rows[k - 1][0];
        let has_groups = 2 * (0..self.rows.len()).filter(|&k| is_new(k)).count() < self.rows.len();
        for (k, mut row) in cells.into_iter().enumerate() {
            let mut below = String::new();
            text += if has_groups && is_new(k) { "\n" } else { "" };
            if row[last].chars().count() > widths[last] {
                below = wrapped(&format!("    {}", std::mem::take(&mut row[last])), width, 4);
            }
            text += &self.line(&row, &widths, gap);
            text += &below;
        }
        for remark in &self.remarks {
            text += &wrapped(&format!("  {remark}"), width, 4);
        }
        text
    }

    /// One row, or the heads.
    fn line(&self, row: &[String], widths: &[usize], gap: usize) -> String {
        let columns: Vec<Vec<String>> =
            row.iter().zip(widths).map(|(cell, &width)| lines(cell, width)).collect();
        let height = columns.iter().map(Vec::len).max().unwrap_or(1);
        let mut text = String::new();
        for line in 0..height {
            let mut whole = String::new();
            for (k, (column, &width)) in columns.iter().zip(widths).enumerate() {
                let cell = column.get(line).map_or("", String::as_str);
                whole += &match self.is_left(k) {
                    true => format!("{cell:<width$}"),
                    false => format!("{cell:>width$}"),
                };
                whole += &" ".repeat(gap);
            }
            text += whole.trim_end();
            text.push('\n');
        }
        text
    }

    /// The widths of the columns, and how many blanks stand between two: two where lines are short enough.
    fn widths(&self, cells: &[Vec<String>], width: usize) -> (Vec<usize>, usize) {
        let last = self.columns.len() - 1;
        let of = |longest: usize| -> Vec<usize> {
            let is_short = |k: usize, n: usize| k < last || !self.is_left(k) || n <= longest;
            let of_column = |k: usize| {
                let lengths = cells.iter().map(|row| row[k].chars().count());
                let words = self.columns[k].split_inclusive(is_break).map(length);
                lengths.filter(|&n| is_short(k, n)).chain(words).max().unwrap_or(0)
            };
            (0..=last).map(of_column).collect()
        };
        let with_all = of(usize::MAX);
        let fits = with_all.iter().sum::<usize>() + 2 * last <= width;
        let mut widths = if fits { with_all } else { of(LONGEST_STATUS) };
        let whole: usize = widths.iter().sum();
        let gap = if whole + 2 * last > width { 1 } else { 2 };
        let excess = (whole + gap * last).saturating_sub(width);
        if excess > 0 && self.is_left(0) {
            let piece = |text: &str| text.split_inclusive(is_break).map(length).max().unwrap_or(0);
            let first = cells.iter().map(|row| &row[0]).chain([&self.columns[0]]);
            let least = first.map(|text| piece(text)).max().unwrap_or(0);
            widths[0] = widths[0].saturating_sub(excess).max(least);
        }
        (widths, gap)
    }
}

/// A text broken at blanks into lines of at most `width` characters; all lines but the first begin with `indent` blanks.
pub(crate) fn wrapped(text: &str, width: usize, indent: usize) -> String {
    let mut out = String::new();
    let mut line = String::new();
    for word in text.split(' ') {
        if !line.trim().is_empty() && line.chars().count() + word.chars().count() > width {
            out += line.trim_end();
            out.push('\n');
            line = " ".repeat(indent);
        }
        line += word;
        line.push(' ');
    }
    out + line.trim_end() + "\n"
}

/// The lines of a cell.
fn lines(text: &str, width: usize) -> Vec<String> {
    if text.chars().count() <= width {
        return vec![text.to_owned()];
    }
    let mut lines = vec![String::new()];
    for piece in text.split_inclusive(is_break) {
        let line = lines.last_mut().expect("there is a first line");
        if !line.is_empty() && line.chars().count() + length(piece) > width {
            lines.push(piece.to_owned());
        } else {
            line.push_str(piece);
        }
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// The length of a piece at the end of a line, where a blank takes no room.
fn length(piece: &str) -> usize {
    piece.trim_end().chars().count()
}

/// Whether a line may break after a character.
fn is_break(c: char) -> bool {
    matches!(c, ' ' | '-' | ':' | '@' | '=' | ',' | '/' | '_')
}
