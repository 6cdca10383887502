//! What an interrupt leaves: the rows that are finished, as a report.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use unilateral::study::{Journal, Report};

use crate::shared::{INTERRUPTED, Request, complain};

/// Ends the process at an interrupt. The one that writes files, the run at its end or the interrupt, has
/// the lock.
#[derive(Clone, Default)]
pub struct Interrupt(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    /// The rows, once work has begun.
    journal: Option<&'static Journal>,
    /// Whether the run has written its report.
    is_written: bool,
}

impl Interrupt {
    /// Lets SIGINT and SIGTERM, and Ctrl-C elsewhere, write the report with this function and end the
    /// process, also while a solve runs. A second signal ends the process at once.
    pub fn install(
        write: impl Fn(&Report) -> Request<()> + Send + Sync + 'static,
    ) -> Request<Self> {
        let interrupt = Self::default();
        let (shared, write) = (interrupt.clone(), Arc::new(write));
        let is_second = AtomicBool::new(false);
        ctrlc::set_handler(move || {
            if is_second.swap(true, Ordering::SeqCst) {
                exit(INTERRUPTED);
            }
            let (shared, write) = (shared.clone(), write.clone());
            // in a thread of its own, so that the next signal is heard
            std::thread::spawn(move || shared.end(&*write));
        })
        .map_err(|e| format!("cannot handle interrupts: {e}"))?;
        Ok(interrupt)
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

    fn end(&self, write: &dyn Fn(&Report) -> Request<()>) -> ! {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(journal), false) = (state.journal, state.is_written) {
            // the run ends at its next row and waits for the lock
            let report = journal.close();
            if let Err(message) = write(&report) {
                complain(&message);
            }
            journal.remove_drafts();
            complain(&format!(
                "interrupted; {} finished rows are in the report, --resume goes on from them",
                report.rows.len()
            ));
        }
        exit(INTERRUPTED)
    }
}
