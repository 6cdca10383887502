//! What is shown while schemes run.

use std::cell::RefCell;
use std::io::Write;

use indicatif::ProgressBar;
use unilateral::study::Progress;

use super::options::Options;
use crate::shared::{bar, tick};

/// Shows progress on a terminal. Warnings of runs stand under the tables.
pub struct Watcher {
    bar: ProgressBar,
    quiet: bool,
    warned: RefCell<Vec<String>>,
}

impl Watcher {
    pub fn new(options: &Options) -> Self {
        let bar = bar(options.quiet, 0, "{spinner} {pos} of {len} done, {elapsed}: {msg}");
        Self { bar, quiet: options.quiet, warned: RefCell::default() }
    }
    pub fn expect(&self, n_runs: usize) {
        self.bar.inc_length(n_runs as u64);
    }
    pub fn tell(&self, progress: &Progress<'_>) {
        match progress {
            Progress::Started(scene, scheme, level) => {
                self.bar.set_message(format!("{scene}, {scheme}, level {level}"));
                tick(&self.bar);
            }
            Progress::Finished(_) => self.bar.inc(1),
            _ => {}
        }
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
