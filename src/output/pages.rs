//! The tables and the page of a report.

use std::path::Path;

use super::html::{HtmlPage, Section};
#[cfg(feature = "plot")]
use crate::plot::overview;
use crate::study::row::distinct;
use crate::study::tables::levels::{scenes, tables_of};
use crate::study::tables::summary::{lead, summaries};
use crate::study::{Program, Report, Row, file_name};
use crate::table::Table;

impl Report {
    /// Program and settings in one line.
    fn heading(&self) -> String {
        let Program { name, version, threads, precision, repeat, target_cpu, .. } = &self.program;
        let times = match repeat {
            1 => "times in seconds".to_owned(),
            _ => format!("every time is the least of {repeat} runs, in seconds"),
        };
        let end = if self.complete { "" } else { "; not complete: the run was interrupted" };
        format!("{name} {version}, {target_cpu}; {threads} threads; {precision}; {times}{end}")
    }

    /// The tables in Markdown.
    pub fn to_markdown(&self) -> String {
        let tables: Vec<String> = self.tables().iter().map(Table::to_markdown).collect();
        format!("# Comparison\n\n{}\n\n{}", self.heading(), tables.join("\n"))
    }

    /// The report as a page, which links the pictures `SCENE-LABEL.svg` that are in the directory.
    pub(super) fn page(&self, directory: &Path) -> HtmlPage {
        let of_scene = |(scene, rows): (String, Vec<&Row>)| Section {
            tables: tables_of(&scene, &rows),
            pictures: self.pictures(&rows[0].scene, directory),
            title: scene,
            ..Section::default()
        };
        HtmlPage {
            title: "Comparison of schemes".to_owned(),
            lead: lead(&self.rows),
            summary: summaries(&self.rows),
            plots: self.overview(),
            sections: [self.plots()]
                .into_iter()
                .flatten()
                .chain(scenes(&self.rows).into_iter().map(of_scene))
                .collect(),
            provenance: [self.heading()].into_iter().chain(self.program.command.clone()).collect(),
        }
    }

    /// The plots of the first screen.
    #[cfg(feature = "plot")]
    fn overview(&self) -> Vec<(String, String)> {
        let titles = ["Error against time", "Error against mesh size"].map(str::to_owned);
        let figures = overview(&self.rows).map(|figure| figure.to_svg());
        titles.into_iter().zip(figures).collect()
    }
    #[cfg(not(feature = "plot"))]
    fn overview(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// The section of the plots with all errors, which stand beside the page.
    fn plots(&self) -> Option<Section> {
        let plot = |file: &str, title: &str| (title.to_owned(), file.to_owned());
        cfg!(feature = "plot").then(|| Section {
            title: "All scenes".to_owned(),
            pictures: vec![
                plot("convergence.svg", "Errors against mesh size"),
                plot("work_precision.svg", "Error against time"),
            ],
            ..Section::default()
        })
    }

    /// The pictures of a scene: titles and files.
    fn pictures(&self, scene: &str, directory: &Path) -> Vec<(String, String)> {
        let mut pictures = Vec::new();
        let of_scene = self.rows.iter().filter(|r| r.scene == scene);
        for (label, solver) in distinct(of_scene.map(|r| (&r.label, &r.solver))) {
            let is_alone = self.rows.iter().all(|r| r.solver == *solver);
            let of = if is_alone { label.clone() } else { format!("{label}-{solver}") };
            let file = file_name(&format!("{scene}-{of}")) + ".svg";
            if directory.join(&file).exists() {
                pictures.push((format!("{of} on {scene}"), file));
            }
        }
        pictures
    }
}
