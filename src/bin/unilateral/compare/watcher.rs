//! The progress that is shown while schemes run.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::io::Write;

use indicatif::{ProgressBar, ProgressState};
use unilateral::inequality::StepCounter;
use unilateral::study::{Progress, Row};

use super::options::Options;
use crate::shared::{bar, tick, warn};

/// Shows progress: one line on a terminal, elsewhere a line for each finished row. Warnings of runs stand
/// under the tables.
pub struct Watcher {
    bar: ProgressBar,
    quiet: bool,
    /// Whether a line is printed for each finished row where there is no bar: rounds finish a row several times.
    lists_rows: bool,
    warned: RefCell<Vec<String>>,
    /// The outer step of the solve that runs.
    steps: StepCounter,
    /// The scene, scheme and level that run.
    run: RefCell<String>,
    /// Whether levels are refinements of a mesh, not subdivisions of a side.
    levels_are_refinements: Cell<bool>,
}

impl Watcher {
    pub fn new(options: &Options) -> Self {
        let steps = StepCounter::default();
        let shown = steps.clone();
        let step = move |_: &ProgressState, w: &mut dyn fmt::Write| {
            let _ = match shown.get() {
                0 => Ok(()),
                step => write!(w, ", step {step}"),
            };
        };
        // how many steps a bound takes is not known before
        let template = match options.asked.adaptive {
            Some(_) => "{spinner} {elapsed}: {msg}{step}",
            None => "{spinner} {percent} %, {elapsed}, {eta} left: {msg}{step}",
        };
        let bar = bar(options.asked.quiet, template);
        bar.set_style(bar.style().with_key("step", step));
        Self {
            bar,
            quiet: options.asked.quiet,
            lists_rows: !options.asked.quiet && options.rounds.is_none(),
            warned: RefCell::default(),
            steps,
            run: RefCell::default(),
            levels_are_refinements: Cell::default(),
        }
    }
    /// Announces the runs of a scene, by their levels, which are refinements of a mesh or subdivisions of a
    /// side.
    pub fn expect(&self, dimension: usize, has_mesh: bool, levels: impl Iterator<Item = usize>) {
        self.levels_are_refinements.set(has_mesh);
        for level in levels {
            self.bar.inc_length(self.size(dimension, level));
        }
    }
    pub fn tell(&self, progress: &Progress<'_>) {
        match progress {
            Progress::Started(scene, label, level) => {
                *self.run.borrow_mut() = format!("{scene}, {label}, level {level}");
                tick(&self.bar);
            }
            Progress::Entered(phase) => {
                let run = self.run.borrow().clone();
                let comma = if run.is_empty() { "" } else { ", " };
                self.steps.set(0);
                self.bar.set_message(format!("{run}{comma}{phase}"));
            }
            Progress::Finished(row) => {
                self.bar.inc(self.size(row.dimension, row.level));
                if self.lists_rows && self.bar.is_hidden() {
                    let _ = writeln!(std::io::stderr(), "{}", line(row));
                }
            }
            Progress::Kept(row) => {
                self.bar.dec_length(self.size(row.dimension, row.level));
            }
            _ => {}
        }
    }
    /// The number of cells of a level, up to a factor: what the bar counts.
    fn size(&self, dimension: usize, level: usize) -> u64 {
        let dimension = dimension as u32;
        match self.levels_are_refinements.get() {
            true => 2_u64.saturating_pow(dimension.saturating_mul(level as u32)),
            false => (level as u64).saturating_pow(dimension),
        }
    }
    /// The counter that receives the outer steps of solves.
    pub fn steps(&self) -> StepCounter {
        self.steps.clone()
    }
    pub fn warn_once(&self, warning: String) {
        if !self.quiet && !self.warned.borrow().contains(&warning) {
            warn(&warning);
            self.warned.borrow_mut().push(warning);
        }
    }
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// A finished row in one line.
fn line(row: &Row) -> String {
    let Row { scene, label, solver, level, status, .. } = row;
    format!("{scene}, {label}, {solver}, level {level}: {status}, {:.3} s", row.seconds.total)
}
