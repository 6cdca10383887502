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
    pub(super) fn heading(&self) -> String {
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
    fn provenance(&self) -> Vec<String> {
        [self.heading()].into_iter().chain(self.program.command.clone()).collect()
    }

    /// The tables in Markdown.
    pub fn to_markdown(&self) -> String {
        let (opening, mut closing) = (vec![self.heading()], Vec::new());
        let mut tables = self.tables();
        if self.has_rounds() {
            tables = [self.work_tables(), tables, self.phase_tables()].concat();
            closing = self.verdicts();
        }
        Document { title: "Comparison", opening, tables, closing }.to_markdown()
    }

    /// The report as a page, which links the pictures `SCENE-LABEL.svg` that are in the directory.
    pub(super) fn page(&self, directory: &Path) -> HtmlPage {
        let scenes = scenes(&self.rows);
        // the first picture of a solution stands on the first screen
        let mut first = Vec::new();
        let mut pictures: Vec<_> =
            scenes.iter().map(|(scene, _)| self.pictures(scene, directory)).collect();
        if let Some(of_scene) = pictures.iter_mut().find(|of_scene| !of_scene.is_empty()) {
            first.push(of_scene.remove(0));
        }
        let of_scene = |((scene, rows), pictures): (&(&str, Vec<&Row>), _)| Section {
            title: (*scene).to_owned(),
            tables: tables_of(scene, rows),
            pictures,
        };
        HtmlPage {
            title: match scenes[..] {
                [(scene, _)] => scene.to_owned(),
                _ => "Comparison of schemes".to_owned(),
            },
            lead: match self.has_rounds() {
                true => self.verdicts().join(" "),
                false => lead(&self.rows),
            },
            summary: match self.has_rounds() {
                true => self.work_tables(),
                false => summaries(&self.rows),
            },
            plots: self.overview(),
            pictures: first,
            sections: [self.plots(), self.work()]
                .into_iter()
                .flatten()
                .chain(scenes.iter().zip(pictures).map(of_scene))
                .collect(),
            provenance: self.provenance(),
        }
    }

    /// The plots of the first screen.
    #[cfg(feature = "plot")]
    fn overview(&self) -> Vec<(String, String)> {
        overview(&self.rows).map(|(caption, figure)| (caption, figure.to_svg())).into()
    }
    #[cfg(not(feature = "plot"))]
    fn overview(&self) -> Vec<(String, String)> {
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

    /// The section of the phases of the fastest runs, with the errors against time and unknowns.
    fn work(&self) -> Option<Section> {
        #[cfg(feature = "plot")]
        let names = self.work_figures().into_iter().map(|(name, _)| (name.clone(), name + ".svg"));
        #[cfg(not(feature = "plot"))]
        let names = std::iter::empty();
        let (tables, title) = (self.phase_tables(), "Work".to_owned());
        let section = Section { title, tables, pictures: names.collect() };
        self.has_rounds().then_some(section)
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
