//! A report as one page: tables and drawings, without scripts and without a network.
//!
//! Boxes switch columns and series on and off by rules of CSS alone; a browser that does not know these
//! rules (`:has`, in all large ones since 2023) shows everything.

use std::fmt::Write;

use super::table::{Cell, Table};

/// A cell: text, and whether it is a number. The full text of a shortened one is shown beside the pointer.
pub(crate) struct HtmlCell {
    pub text: String,
    pub full: Option<String>,
    pub is_number: bool,
}

/// A table with the columns and series to which its cells belong, by their places among those of the page.
pub(crate) struct HtmlTable {
    pub title: String,
    pub columns: Vec<usize>,
    pub rows: Vec<(Option<usize>, Vec<HtmlCell>)>,
    pub remarks: Vec<String>,
}

/// A page.
#[derive(Default)]
pub(crate) struct HtmlPage {
    pub title: String,
    pub paragraphs: Vec<String>,
    /// Names of the columns, and whether they are shown at first.
    pub columns: Vec<(String, bool)>,
    /// Names of the series: class `s` and a number in drawings.
    pub series: Vec<String>,
    pub tables: Vec<HtmlTable>,
    /// Titles and texts of SVG files: drawings with groups for series, and pictures.
    pub drawings: Vec<(String, String)>,
    pub pictures: Vec<(String, String)>,
}

const STYLE: &str = "\
body{font:15px/1.45 system-ui,sans-serif;color:#1e1e1e;background:#fff;margin:1.5em auto;max-width:76em;padding:0 1em}
h1{font-size:1.5em}h2{font-size:1.15em;margin:1.6em 0 .4em}
fieldset{border:1px solid #ccc;border-radius:4px;margin:.6em 0;padding:.3em .8em}legend{color:#555}
label{display:inline-block;margin-right:1em;white-space:nowrap}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}
th{text-align:left;border-bottom:1px solid #1e1e1e;vertical-align:bottom}
th,td{padding:.15em .6em;white-space:nowrap}td.n,th.n{text-align:right}
td.w{max-width:34em;white-space:normal}tbody tr:nth-child(even){background:#f5f5f5}
figure{margin:1em 0}svg{max-width:100%;height:auto}
@media print{fieldset{display:none}}
";

impl HtmlPage {
    /// A page of tables with all their columns.
    pub fn of_tables(
        title: &str,
        paragraphs: Vec<String>,
        series: &[String],
        of: &[Table],
    ) -> Self {
        let mut columns: Vec<(String, bool)> = Vec::new();
        let mut tables = Vec::new();
        for table in of {
            let places = table.columns.iter().map(|name| {
                columns.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                    columns.push((name.clone(), true));
                    columns.len() - 1
                })
            });
            let cell = |cell: &Cell| HtmlCell {
                text: cell.plain(),
                full: None,
                is_number: !matches!(cell, Cell::Words(_)),
            };
            let row = |row: &Vec<Cell>| {
                let name = row.first().map(Cell::plain);
                let place = series.iter().position(|known| Some(known) == name.as_ref());
                (place, row.iter().map(cell).collect())
            };
            tables.push(HtmlTable {
                title: table.title.clone(),
                columns: places.collect(),
                rows: table.rows.iter().map(row).collect(),
                remarks: table.remarks.clone(),
            });
        }
        let (title, series) = (title.to_owned(), series.to_vec());
        Self { title, paragraphs, columns, series, tables, ..Self::default() }
    }

    /// Adds a figure.
    #[cfg(feature = "plot")]
    pub fn draw(&mut self, title: &str, figure: &crate::plot::Figure) {
        self.drawings.push((title.to_owned(), figure.to_svg_in_groups(&self.series)));
    }

    /// The text of the page.
    pub fn to_html(&self) -> String {
        let mut text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n<style>\n{STYLE}",
            escape(&self.title)
        );
        let classes = (0..self.series.len()).map(|k| format!("s{k}"));
        for class in classes.chain((0..self.columns.len()).map(|k| format!("c{k}"))) {
            // writing to a text does not fail
            let _ =
                writeln!(text, "body:has(#show-{class}:not(:checked)) .{class}{{display:none}}");
        }
        text += &format!("</style>\n</head>\n<body>\n<h1>{}</h1>\n", escape(&self.title));
        for paragraph in &self.paragraphs {
            text += &format!("<p>{}</p>\n", escape(paragraph));
        }
        let series = self.series.iter().map(|name| (name, true));
        text += &boxes("Series", "s", series.collect());
        text += &boxes("Columns", "c", self.columns.iter().map(|(name, on)| (name, *on)).collect());
        for table in &self.tables {
            text += &self.table(table);
        }
        for (title, svg) in self.drawings.iter().chain(&self.pictures) {
            let start = svg.find("<svg").unwrap_or(0);
            let title = escape(title);
            text += &format!(
                "<figure>\n<h2>{title}</h2>\n<div class=\"scroll\" role=\"img\" aria-label=\"{title}\">\
                 {}</div>\n</figure>\n",
                svg[start..].trim_end()
            );
        }
        text + "</body>\n</html>\n"
    }

    fn table(&self, table: &HtmlTable) -> String {
        let mut text = format!(
            "<h2>{}</h2>\n<div class=\"scroll\"><table>\n<thead><tr>",
            escape(&table.title)
        );
        for (at, &k) in table.columns.iter().enumerate() {
            let is_number = |(_, row): &(Option<usize>, Vec<HtmlCell>)| row[at].is_number;
            let kind = if table.rows.iter().any(is_number) { " n" } else { "" };
            text += &format!("<th class=\"c{k}{kind}\">{}</th>", escape(&self.columns[k].0));
        }
        text += "</tr></thead>\n<tbody>\n";
        for (series, row) in &table.rows {
            text += &series.map_or("<tr>".to_owned(), |k| format!("<tr class=\"s{k}\">"));
            for (cell, k) in row.iter().zip(&table.columns) {
                let kind = if cell.is_number { "n" } else { "w" };
                let full = cell.full.as_ref();
                let full =
                    full.map_or(String::new(), |full| format!(" title=\"{}\"", escape(full)));
                text += &format!("<td class=\"c{k} {kind}\"{full}>{}</td>", escape(&cell.text));
            }
            text += "</tr>\n";
        }
        text += "</tbody>\n</table></div>\n";
        for remark in &table.remarks {
            text += &format!("<p>{}</p>\n", escape(remark));
        }
        text
    }
}

/// Boxes that show and hide what has the class of their number; none for a single one.
fn boxes(legend: &str, class: &str, names: Vec<(&String, bool)>) -> String {
    if names.len() < 2 {
        return String::new();
    }
    let mut text = format!("<fieldset><legend>{legend}</legend>\n");
    for (k, (name, on)) in names.into_iter().enumerate() {
        let checked = if on { " checked" } else { "" };
        text += &format!(
            "<label><input type=\"checkbox\" id=\"show-{class}{k}\" autocomplete=\"off\"{checked}> {}</label>\n",
            escape(name)
        );
    }
    text + "</fieldset>\n"
}

/// A text with the markup characters of HTML escaped.
fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
