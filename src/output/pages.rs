//! The tables and the page of a report.

use std::path::Path;

use super::document::Document;
use super::html::{HtmlPage, Section};
#[cfg(feature = "plot")]
use crate::plot::{overview, shows_all};
use crate::study::row::distinct;
use crate::study::tables::levels::{scenes, tables_of};
use crate::study::tables::summary::{lead, summaries};
use crate::study::{Report, Row, file_name};

/// The file of the histories of a scene.
pub(super) fn history_file(scene: &str) -> String {
    file_name(&format!("{scene}-history")) + ".svg"
}

impl Report {
    /// Program, machine and settings in one line.
    pub(crate) fn heading(&self) -> String {
        let mut text = self.program.words() + "; ";
        text += &match self.program.repeat {
            1 => "times in seconds".to_owned(),
            runs => format!("every time is the least of {runs} runs, in seconds"),
        };
        for (name, value) in &self.program.request {
            text += &format!("; {name} {value}");
        }
        let references = distinct(self.rows.iter().filter_map(Row::reference));
        if !references.is_empty() {
            text += &format!("; errors against {}", references.join(", "));
        }
        text += if self.complete { "" } else { "; not complete: the run was interrupted" };
        text
    }
    /// The heading, and the command that makes the report again.
    pub(crate) fn provenance(&self) -> Vec<String> {
        [self.heading()].into_iter().chain(self.program.command.clone()).collect()
    }

    /// The tables in Markdown.
    pub fn to_markdown(&self) -> String {
        let (opening, tables) = (vec![self.heading()], self.tables());
        Document { title: "Comparison", opening, tables, closing: Vec::new() }.to_markdown()
    }

    /// The report as a page, which links the pictures `SCENE-LABEL.svg` that are in the directory.
    pub(super) fn page(&self, directory: &Path) -> HtmlPage {
        let parts = scenes(&self.rows);
        let scenes = distinct(self.rows.iter().map(|row| row.scene.as_str()));
        // the first picture of a solution stands on the first screen
        let mut first = Vec::new();
        let mut pictures: Vec<_> =
            scenes.iter().map(|scene| self.pictures(scene, directory)).collect();
        if let Some(of_scene) = pictures.iter_mut().find(|of_scene| !of_scene.is_empty()) {
            first.push(of_scene.remove(0));
        }
        let of_scene = |(scene, pictures): (&str, _)| Section {
            title: scene.to_owned(),
            tables: parts
                .iter()
                .filter(|(_, rows)| rows[0].scene == scene)
                .flat_map(|(title, rows)| tables_of(title, rows))
                .collect(),
            pictures,
            ..Section::default()
        };
        HtmlPage {
            title: match scenes[..] {
                [scene] => scene.to_owned(),
                _ => "Comparison of schemes".to_owned(),
            },
            lead: lead(&self.rows),
            summary: summaries(&self.rows),
            plots: self.overview(),
            pictures: first,
            sections: [self.plots()]
                .into_iter()
                .flatten()
                .chain(scenes.iter().copied().zip(pictures).map(of_scene))
                .collect(),
            provenance: self.provenance(),
        }
    }

    /// The plots of the first screen.
    #[cfg(feature = "plot")]
    pub(crate) fn overview(&self) -> Vec<(String, String)> {
        overview(&self.rows).map(|(caption, figure)| (caption, figure.to_svg())).into()
    }
    #[cfg(not(feature = "plot"))]
    pub(crate) fn overview(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// The section of the plots beside the page that have more than the first screen.
    #[cfg(feature = "plot")]
    fn plots(&self) -> Option<Section> {
        let [time, size] = shows_all(&self.rows);
        let plots = [
            (time, "work_precision.svg", "Error against time"),
            (size, "convergence.svg", "Errors against mesh size"),
        ];
        let more = plots.into_iter().filter(|(is_shown, ..)| !is_shown);
        let pictures: Vec<_> =
            more.map(|(_, file, title)| (title.to_owned(), file.to_owned())).collect();
        let title = "All scenes".to_owned();
        (!pictures.is_empty()).then(|| Section { title, pictures, ..Section::default() })
    }
    #[cfg(not(feature = "plot"))]
    fn plots(&self) -> Option<Section> {
        None
    }

    /// The pictures of a scene: titles and files, solutions first. The plot of histories is there if it has been written.
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
        let history = history_file(scene);
        if directory.join(&history).exists() {
            pictures.push((format!("Certificates of the solves on {scene}"), history));
        }
        pictures
    }
}
