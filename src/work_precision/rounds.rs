//! Running all cases of a study, round by round.

use std::time::{Duration, Instant};

use super::case::run_alone;
use super::measured::{Case, Failure, Measured};
use super::report::WorkReport;
use super::slots::Slot;
use super::{WorkPrecision, WorkProgress};
use crate::error::Error;
use crate::study::{Row, fill_orders};

/// The least time between two writes of finished rows within a round.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

impl<const D: usize> WorkPrecision<'_, D> {
    pub(super) fn run_cases(&self, report: &mut WorkReport) -> Result<(), Error> {
        let mut slots = self.slots()?;
        report.subject.clone_from(&self.subject);
        report.program.precision = self.precision.name().to_owned();
        let measured = match self.study_against_reference()? {
            Some(study) => study.run()?.rows,
            None => Vec::new(),
        };
        let before = (report.rows.len(), report.refused.len());
        (self.observer)(WorkProgress::Planned(slots.len() * self.rounds));
        // threads, pages and instructions are there when the clock starts
        let is_coarsest = |s: &&Slot<'_, D>| s.coarser.is_none() && !s.case.is_adaptive();
        for slot in slots.iter().filter(is_coarsest) {
            drop(run_alone(&slot.study));
        }
        let mut written = Instant::now();
        for round in 0..self.rounds {
            // by level, so that a level that takes too long is known before the next
            let mut order: Vec<usize> = (0..slots.len()).collect();
            sort_by(&mut order, &|k| (slots[k].case.is_adaptive(), slots[k].case.level));
            if round % 2 == 1 {
                order.reverse();
            }
            for k in order {
                (self.observer)(WorkProgress::Started(&slots[k].case, round));
                self.run_slot(&mut slots, k, round, &measured);
                (self.observer)(WorkProgress::Finished);
                if written.elapsed() > WRITE_INTERVAL {
                    self.save(report, before, &slots)?;
                    written = Instant::now();
                }
            }
            self.save(report, before, &slots)?;
        }
        match (&self.directory, slots.first()) {
            (Some(directory), Some(slot)) => {
                report.write_figures(directory, &slot.case.variant.scene).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// Runs a case, unless it has failed, takes too long or would not fit.
    fn run_slot(
        &self,
        slots: &mut [Slot<'_, D>],
        k: usize,
        round: usize,
        against_reference: &[Row],
    ) {
        if let Some(measured) = slots[k].measured.last() {
            let is_slow = measured.smallest.total > self.limit;
            if is_slow || !measured.row.converged() {
                return;
            }
        } else if round > 0 {
            return;
        }
        if round == 0
            && let Some(why) = self.obstacle_to(slots, k)
        {
            slots[k].failure = Some(Failure::new(slots[k].case.clone(), &why));
            return;
        }
        let slot = &mut slots[k];
        match run_alone(&slot.study) {
            Err(e) => {
                slot.failure = Some(Failure::new(slot.case.clone(), &e.to_string()));
            }
            Ok(rows) => {
                for (step, (row, phases)) in rows.into_iter().enumerate() {
                    let row = completed(row, &slot.case, against_reference);
                    match slot.measured.get_mut(step) {
                        Some(measured) => measured.add(&row, phases),
                        None => slot.measured.push(Measured::new(row, phases)),
                    }
                }
            }
        }
    }

    /// Puts the results so far into the report, after the rows of other scenes, and writes it.
    fn save(
        &self,
        report: &mut WorkReport,
        (rows, refused): (usize, usize),
        slots: &[Slot<'_, D>],
    ) -> Result<(), Error> {
        report.rows.truncate(rows);
        report.rows.extend(slots.iter().flat_map(|s| s.measured.iter().cloned()));
        report.refused.truncate(refused);
        report.refused.extend(slots.iter().filter_map(|s| s.failure.clone()));
        fill_orders(&mut report.rows[rows..]);
        match &self.directory {
            Some(directory) => report.write_data(directory).map(|_| ()),
            None => Ok(()),
        }
    }
}

/// The row of a run with the linear solver asked for, and with its errors where they are against a reference. An adaptive
/// step has no peak of its own.
fn completed(mut row: Row, case: &Case, against_reference: &[Row]) -> Row {
    row.linear_asked.clone_from(&case.variant.linear_asked);
    if case.is_adaptive() {
        row.peak_memory_bytes = None;
        return row;
    }
    let is_same = |other: &&Row| other.label == row.label && other.level == row.level;
    if let Some(known) = against_reference.iter().find(is_same) {
        row.against.clone_from(&known.against);
        if known.against.is_none() {
            row.warnings.clone_from(&known.warnings);
        }
        (row.error, row.contact) = (known.error, known.contact);
    }
    row
}

/// Sorts indices by their keys; not generic, so that the sorting code is compiled once.
fn sort_by(order: &mut [usize], key: &dyn Fn(usize) -> (bool, usize)) {
    order.sort_by_key(|&k| key(k));
}
