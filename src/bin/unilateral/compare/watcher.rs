//! The progress that is shown while schemes run.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressState};
use unilateral::inequality::StepCounter;
use unilateral::study::{Progress, Row};

use super::options::Options;
use crate::shared::{bar, tick, warn};

/// Shows progress: one line on a terminal, elsewhere a line for each finished row. Warnings of runs stand
/// under the tables.
pub struct Watcher {
    bar: ProgressBar,
    quiet: bool,
    warned: RefCell<Vec<String>>,
    /// The outer step of the solve that runs.
    steps: StepCounter,
    /// The scene, scheme and level that run.
    run: RefCell<String>,
    /// Numbers of cells, up to a factor, of the runs that are expected, and of those that are finished.
    expected: Cell<f64>,
    finished: Cell<f64>,
    /// Whether levels are refinements of a mesh, not subdivisions of a side.
    levels_are_refinements: Cell<bool>,
    begin: Instant,
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
        let template = "{spinner} {pos} of {len} done, {elapsed}: {msg}{step}";
        let bar = bar(options.asked.quiet, template);
        bar.set_style(bar.style().with_key("step", step));
        Self {
            bar,
            quiet: options.asked.quiet,
            warned: RefCell::default(),
            steps,
            run: RefCell::default(),
            expected: Cell::default(),
            finished: Cell::default(),
            levels_are_refinements: Cell::default(),
            begin: Instant::now(),
        }
    }
    /// Announces the runs of a scene, by their levels, which are refinements of a mesh or subdivisions of a
    /// side.
    pub fn expect(&self, dimension: usize, has_mesh: bool, levels: impl Iterator<Item = usize>) {
        self.levels_are_refinements.set(has_mesh);
        for level in levels {
            self.bar.inc_length(1);
            self.expected.set(self.expected.get() + self.size(dimension, level));
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
                let left = self.estimate().map(|left| format!("{left} left"));
                let parts =
                    [Some(run).filter(|run| !run.is_empty()), left, Some(phase.to_string())];
                self.steps.set(0);
                self.bar.set_message(parts.into_iter().flatten().collect::<Vec<_>>().join(", "));
            }
            Progress::Finished(row) => {
                self.finished.set(self.finished.get() + self.size(row.dimension, row.level));
                self.bar.inc(1);
                if !self.quiet && self.bar.is_hidden() {
                    let _ = writeln!(std::io::stderr(), "{}", line(row));
                }
            }
            Progress::Kept(row) => {
                self.expected.set(self.expected.get() - self.size(row.dimension, row.level));
                self.bar.inc(1);
            }
            _ => {}
        }
    }
    /// The number of cells of a level, up to a factor.
    fn size(&self, dimension: usize, level: usize) -> f64 {
        match self.levels_are_refinements.get() {
            true => 2_f64.powf((dimension * level) as f64),
            false => (level as f64).powf(dimension as f64),
        }
    }
    /// The time that the other runs will take if a cell takes as long in them as before.
    fn estimate(&self) -> Option<HumanDuration> {
        let share = self.finished.get() / self.expected.get();
        if !share.is_finite() {
            return None;
        }
        let left = self.begin.elapsed().as_secs_f64() * (1.0 / share - 1.0);
        let left = (share > 0.02).then(|| Duration::try_from_secs_f64(left.max(0.0)).ok())?;
        left.map(HumanDuration)
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
