//! The report of the finished rows that an interrupt or a panic leaves.

use std::panic::{set_hook, take_hook};
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use unilateral::study::{Journal, Report};

use crate::shared::{INTERRUPTED, Request, complain};

/// The time for the report after a panic. A thread that panics while it holds the lock of the report
/// leaves no report.
const TIME_AFTER_PANIC: Duration = Duration::from_secs(10);

/// Ends the process at an interrupt or a panic. The one that writes files, the run at its end or the interrupt, has
/// the lock.
#[derive(Clone, Default)]
pub struct Interrupt(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    /// The rows, once work has begun.
    journal: Option<&'static Journal>,
    /// Whether the run has written its report.
    is_written: bool,
    /// Whether `--resume` takes up such a run.
    resumes: bool,
}

impl Interrupt {
    /// Lets SIGINT and SIGTERM, and Ctrl-C elsewhere, write the report with this function and end the
    /// process, also while a solve runs. A second signal ends the process at once. A panic of any thread does so
    /// too, after its message, with exit code 1: the release build does not unwind.
    ///
    /// Only a run that `resumes` is told so.
    pub fn install(
        resumes: bool,
        write: impl Fn(&Report) -> Request<()> + Send + Sync + 'static,
    ) -> Request<Self> {
        let interrupt = Self(Arc::new(Mutex::new(State { resumes, ..State::default() })));
        let (shared, write) = (interrupt.clone(), Arc::new(write));
        interrupt.install_panic_hook(write.clone());
        let is_second = AtomicBool::new(false);
        ctrlc::set_handler(move || {
            if is_second.swap(true, Ordering::SeqCst) {
                exit(INTERRUPTED);
            }
            let (shared, write) = (shared.clone(), write.clone());
            // in a thread of its own, so that the next signal is heard
            std::thread::spawn(move || shared.end(&*write, "interrupted", INTERRUPTED));
        })
        .map_err(|e| format!("cannot handle interrupts: {e}"))?;
        Ok(interrupt)
    }

    fn install_panic_hook(
        &self,
        write: Arc<impl Fn(&Report) -> Request<()> + Send + Sync + 'static>,
    ) {
        let (shared, print_message) = (self.clone(), take_hook());
        let is_second = AtomicBool::new(false);
        set_hook(Box::new(move |panic| {
            print_message(panic);
            if !is_second.swap(true, Ordering::SeqCst) {
                let (shared, write) = (shared.clone(), write.clone());
                // in a thread of its own, because the one that panics may hold a lock
                std::thread::spawn(move || shared.end(&*write, "stopped by a panic", 1));
            }
            std::thread::sleep(TIME_AFTER_PANIC);
            exit(1)
        }));
    }

    /// The journal from which an interrupt takes the rows.
    pub fn watch(&self, journal: &'static Journal) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).journal = Some(journal);
    }

    /// Writes the report of the run, unless an interrupt does.
    pub fn at_end(&self, write: impl FnOnce() -> Request<()>) -> Request<()> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let outcome = write();
        state.is_written = true;
        outcome
    }

    fn end(&self, write: &dyn Fn(&Report) -> Request<()>, why: &str, code: i32) -> ! {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(journal), false) = (state.journal, state.is_written) {
            // the run ends at its next row and waits for the lock
            let report = journal.close();
            if let Err(message) = write(&report) {
                complain(&message);
            }
            journal.remove_drafts();
            let rows = match report.rows.len() {
                1 => "1 finished row is".to_owned(),
                n => format!("{n} finished rows are"),
            };
            let end = if state.resumes { ", --resume goes on from there" } else { "" };
            complain(&format!("{why}; {rows} in the report{end}"));
        }
        exit(code)
    }
}
