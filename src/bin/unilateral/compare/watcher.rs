//! What is shown while schemes run.

use std::cell::{Cell, RefCell};
use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar};
use unilateral::study::{Progress, Row};

use super::options::Options;
use crate::shared::{bar, tick};

/// Shows progress: one line on a terminal, elsewhere a line for each finished row. Warnings of runs stand
/// under the tables.
pub struct Watcher {
    bar: ProgressBar,
    quiet: bool,
    warned: RefCell<Vec<String>>,
    /// The scene, scheme and level that run.
    run: RefCell<String>,
    /// Sizes of the runs that are expected, and of those that are finished.
    expected: Cell<f64>,
    finished: Cell<f64>,
    /// The size of a run by dimension and level.
    size: fn(usize, usize) -> f64,
    begin: Instant,
}

impl Watcher {
    pub fn new(options: &Options) -> Self {
        let bar = bar(options.quiet, 0, "{spinner} {pos} of {len} done, {elapsed}: {msg}");
        let size: fn(usize, usize) -> f64 = match options.mesh.path {
            Some(_) => |dimension, level| 2_f64.powf((dimension * level) as f64),
            None => |dimension: usize, level: usize| (level as f64).powf(dimension as f64),
        };
        Self {
            bar,
            quiet: options.quiet,
            warned: RefCell::default(),
            run: RefCell::default(),
            expected: Cell::default(),
            finished: Cell::default(),
            size,
            begin: Instant::now(),
        }
    }
    /// Announces the runs of a scene, by their levels.
    pub fn expect(&self, dimension: usize, levels: impl Iterator<Item = usize>) {
        for level in levels {
            self.bar.inc_length(1);
            self.expected.set(self.expected.get() + (self.size)(dimension, level));
        }
    }
    pub fn tell(&self, progress: &Progress<'_>) {
        match progress {
            Progress::Started(scene, label, level) => {
                *self.run.borrow_mut() = format!("{scene}, {label}, level {level}");
                tick(&self.bar);
            }
            Progress::Entered(phase) => {
                let left =
                    self.estimate().map_or_else(String::new, |left| format!(", {left} left"));
                self.bar.set_message(format!("{}, {phase}{left}", self.run.borrow()));
            }
            Progress::Finished(row) => {
                self.finished.set(self.finished.get() + self.size_of(row));
                self.bar.inc(1);
                if !self.quiet && self.bar.is_hidden() {
                    let _ = writeln!(std::io::stderr(), "{}", line(row));
                }
            }
            Progress::Kept(row) => {
                self.expected.set(self.expected.get() - self.size_of(row));
                self.bar.inc(1);
            }
            _ => {}
        }
    }
    fn size_of(&self, row: &Row) -> f64 {
        (self.size)(row.dimension, row.level)
    }
    /// The time that the other runs will take if a cell takes as long in them as before.
    fn estimate(&self) -> Option<HumanDuration> {
        let share = self.finished.get() / self.expected.get();
        let left = self.begin.elapsed().as_secs_f64() * (1.0 / share - 1.0);
        let left = (share > 0.02).then(|| Duration::try_from_secs_f64(left.max(0.0)).ok())?;
        left.map(HumanDuration)
    }
    pub fn warn_once(&self, warning: String) {
        if !self.quiet && !self.warned.borrow().contains(&warning) {
            let _ = writeln!(std::io::stderr(), "{warning}");
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
