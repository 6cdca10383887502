//! The work of a report: times to reach errors, verdicts, and their tables.

use super::tables::{costs_and_times, phases};
use super::verdict::verdict;
use super::work_at_error::{WorkAtError, work_at_errors};
use crate::study::Report;
use crate::study::row::distinct;
use crate::study::series::by_scene;
use crate::table::{Table, wrapped};

impl Report {
    /// Whether cases ran in rounds ([`Rounds`](super::Rounds)): the files of such a report say what it takes to reach an
    /// error.
    pub fn has_rounds(&self) -> bool {
        self.rows.iter().any(|row| row.runs.is_some())
    }

    /// Time, unknowns and entries at given errors.
    pub fn work_at_errors(&self) -> Vec<WorkAtError> {
        work_at_errors(&self.rows)
    }

    /// One sentence for every scene whose errors are known, about the [subject](crate::study::Program::subject).
    pub fn verdicts(&self) -> Vec<String> {
        let (work, subject) = (self.work_at_errors(), self.program.subject.as_deref());
        let scenes = distinct(self.rows.iter().map(|row| row.scene.as_str()));
        scenes.into_iter().filter_map(|scene| verdict(&work, scene, subject)).collect()
    }

    /// Costs and times to reach errors, scene by scene.
    pub fn work_tables(&self) -> Vec<Table> {
        costs_and_times(&self.rows, &self.work_at_errors())
    }

    /// Where the time went, scene by scene.
    pub fn phase_tables(&self) -> Vec<Table> {
        let series = self.series();
        let by_scene = by_scene(&series).into_iter();
        let tables = by_scene.map(|(scene, series)| phases(scene, &series));
        tables.filter(|table| !table.rows.is_empty()).collect()
    }

    /// Phases, costs, times and verdicts in lines of this many characters.
    pub fn work_to_text(&self, width: usize) -> String {
        let tables = [self.phase_tables(), self.work_tables()].concat().into_iter();
        let verdicts = self.verdicts().into_iter().map(|verdict| wrapped(&verdict, width, 0));
        let parts = tables.map(|table| table.to_text(width)).chain([verdicts.collect()]);
        parts.collect::<Vec<_>>().join("\n")
    }
}
