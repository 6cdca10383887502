//! What is shown while schemes run.

use std::cell::RefCell;
use std::io::{IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use unilateral::study::Progress;

use super::options::Options;

/// Shows progress on a terminal. Warnings of runs stand under the tables.
pub struct Watcher {
    bar: Option<ProgressBar>,
    quiet: bool,
    warned: RefCell<Vec<String>>,
}

impl Watcher {
    pub fn new(options: &Options) -> Self {
        let show = !options.quiet && std::io::stderr().is_terminal();
        let style = ProgressStyle::with_template("{spinner} {pos} of {len} done, {elapsed}: {msg}");
        let bar = style.ok().filter(|_| show).map(|style| ProgressBar::new(0).with_style(style));
        Self { bar, quiet: options.quiet, warned: RefCell::default() }
    }
    pub fn expect(&self, n_runs: usize) {
        self.bar.iter().for_each(|bar| bar.inc_length(n_runs as u64));
    }
    pub fn tell(&self, progress: &Progress<'_>) {
        let Some(bar) = &self.bar else { return };
        match progress {
            Progress::Started(scene, scheme, level) => {
                bar.set_message(format!("{scene}, {scheme}, level {level}"));
                bar.enable_steady_tick(Duration::from_millis(100));
            }
            Progress::Finished(_) => bar.inc(1),
        }
    }
    pub fn warn_once(&self, warning: String) {
        if !self.quiet && !self.warned.borrow().contains(&warning) {
            let _ = writeln!(std::io::stderr(), "{warning}");
            self.warned.borrow_mut().push(warning);
        }
    }
    pub fn clear(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}
