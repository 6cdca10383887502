//! A report as one page, without scripts and without a network: the comparison on the first screen, the rest below.

use crate::input::escaped;
use crate::table::{Cell, Table};

/// A page.
#[derive(Default)]
pub(crate) struct HtmlPage {
    pub title: String,
    /// The sentence that says what was compared and how it ended.
    pub lead: String,
    /// Titles and texts of SVG files that stand side by side on the first screen.
    pub plots: Vec<(String, String)>,
    /// Titles of pictures and their files, beside the plots.
    pub pictures: Vec<(String, String)>,
    /// The tables of the first screen.
    pub summary: Vec<Table>,
    pub sections: Vec<Section>,
    /// Program and machine, and how to make the page again.
    pub provenance: Vec<String>,
}

/// A heading with what stands below it.
#[derive(Default)]
pub(crate) struct Section {
    pub title: String,
    pub tables: Vec<Table>,
    /// Titles of pictures and their files beside the page.
    pub pictures: Vec<(String, String)>,
}

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1e1e1e;--soft:#5c5c5c;--ground:#fff;--line:#d0d0d0;--best:#dff0d8}
@media(prefers-color-scheme:dark){:root{--ink:#e6e6e6;--soft:#a8a8a8;--ground:#161616;--line:#444;--best:#1f4a2b}
.plot svg{filter:invert(.91) hue-rotate(180deg)}.picture img{background:#fff;border-radius:4px}}
body{font:14px/1.4 system-ui,sans-serif;color:var(--ink);background:var(--ground);margin:.8em auto;max-width:88em;padding:0 1em}
h1{font-size:1.3em;margin:0}h2{font-size:1.15em;margin:2em 0 .4em;border-bottom:1px solid var(--line)}
p{margin:.3em 0;max-width:70em}.lead{font-size:1.1em}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(26em,100%),1fr));gap:.5em}
figure{margin:.4em 0}figcaption{color:var(--soft);text-align:center}
.plot svg{display:block;margin:auto;max-width:100%;height:auto}
.first .plot svg,.first .picture img{display:block;margin:auto;max-height:21em}.first .picture img{width:auto;max-width:100%}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(24em,100%),1fr));gap:.8em}
.picture img{width:100%;height:auto}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums;margin:.3em 0}
caption{text-align:left;font-weight:600;padding:.2em 0}
th{font-weight:600;text-align:left}thead th{border-bottom:1px solid var(--ink)}tbody th{font-weight:400}
th,td{padding:.1em .7em;white-space:nowrap}.n{text-align:right}td.w{max-width:34em;white-space:normal}
tbody tr:nth-child(even){background:color-mix(in srgb,var(--line) 30%,transparent)}
.best{background:var(--best);font-weight:600}.remark,.provenance{color:var(--soft)}code{overflow-wrap:anywhere}
@media print{body{max-width:none;font-size:9pt}figure,tr{break-inside:avoid}.scroll{overflow:visible}}
";

impl HtmlPage {
    /// The text of the page.
    pub fn to_html(&self) -> String {
        let title = escaped(&self.title);
        let mut text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<section class=\"first\">\n<h1>{title}</h1>\n\
             <p class=\"lead\">{}</p>\n",
            escaped(&self.lead)
        );
        text += &figures("plots", &self.plots, &self.pictures);
        self.summary.iter().for_each(|of| text += &table(of));
        text += "</section>\n";
        for section in &self.sections {
            text += &format!("<section>\n<h2>{}</h2>\n", escaped(&section.title));
            section.tables.iter().for_each(|of| text += &table(of));
            text += &figures("pictures", &[], &section.pictures);
            text += "</section>\n";
        }
        if !self.provenance.is_empty() {
            text += "<section>\n<h2>How this page was made</h2>\n";
            self.provenance.iter().for_each(|of| text += &paragraph(" class=\"provenance\"", of));
            text += "</section>\n";
        }
        text + "</body>\n</html>\n"
    }
}

fn paragraph(class: &str, text: &str) -> String {
    format!("<p{class}>{}</p>\n", escaped(text))
}

/// Drawings, and pictures in files, side by side.
fn figures(class: &str, plots: &[(String, String)], pictures: &[(String, String)]) -> String {
    if plots.is_empty() && pictures.is_empty() {
        return String::new();
    }
    let mut text = format!("<div class=\"{class}\">\n");
    for (title, svg) in plots {
        let svg = svg[svg.find("<svg").expect("a drawing is an SVG file")..].trim_end();
        let title = escaped(title);
        text += &format!(
            "<figure class=\"plot\" role=\"img\" aria-label=\"{title}\">{svg}<figcaption>{title}</figcaption></figure>\n"
        );
    }
    for (title, file) in pictures {
        let (title, file) = (escaped(title), escaped(file));
        text += &format!(
            "<figure class=\"picture\"><img src=\"{file}\" alt=\"{title}\" loading=\"lazy\">\
             <figcaption>{title}</figcaption></figure>\n"
        );
    }
    text + "</div>\n"
}

/// A table that scrolls by itself where it is wider than the page, by the keyboard too.
fn table(table: &Table) -> String {
    let class = |k: usize| if table.is_left(k) { "w" } else { "n" };
    let mut text = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table>\n<caption>{}</caption>\n<thead><tr>",
        escaped(&table.caption())
    );
    for (k, name) in table.columns.iter().enumerate() {
        text += &format!("<th scope=\"col\" class=\"{}\">{}</th>", class(k), escaped(name));
    }
    text += "</tr></thead>\n<tbody>\n";
    for row in &table.rows {
        text += "<tr>";
        for (k, cell) in row.iter().enumerate() {
            let words = escaped(&cell.plain());
            text += &match cell {
                Cell::Words(_) if k == 0 => format!("<th scope=\"row\">{words}</th>"),
                Cell::Best(..) => format!("<td class=\"n best\">{words}</td>"),
                _ => format!("<td class=\"{}\">{words}</td>", class(k)),
            };
        }
        text += "</tr>\n";
    }
    text += "</tbody>\n</table></div>\n";
    table.remarks.iter().for_each(|remark| text += &paragraph(" class=\"remark\"", remark));
    text
}
