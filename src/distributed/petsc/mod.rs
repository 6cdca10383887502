//! Processes by MPI, and PETSc as the engine.
//!
//! `shim.c` alone sees MPI and PETSc. This folder alone calls it, and has the only `unsafe` code of the room: every
//! block is a call of a C function with pointers that are valid for as many numbers as it is told.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`Processes`]: the begin and the end of a job |
//! | `mpi_exchange` | messages between processes |
//! | `engine` | matrices and preconditioners of PETSc |
//! | `shim` | the C functions and their errors |

#![allow(unsafe_code)]

mod engine;
mod mpi_exchange;
mod shim;

use std::sync::atomic::{AtomicBool, Ordering};

use super::process::Process;
use crate::processes::ExchangeError;
use engine::Petsc;
use mpi_exchange::MpiExchange;
use shim::{check, ul_abort, ul_end, ul_rank, ul_size, ul_start};

/// Whether a process has started MPI; it can do so once.
static IS_STARTED: AtomicBool = AtomicBool::new(false);

/// The processes of an MPI job, with PETSc in each. One thread of a process may use them.
#[derive(Debug)]
pub struct Processes(());

impl Processes {
    /// Joins the job in which `mpirun` has started this process, or begins one of a single process. A panic of
    /// one process ends all, and so does an error inside a function of PETSc that one process alone meets: it is the
    /// one thing that this library prints. Options in the variable `PETSC_OPTIONS` count, files of options do not.
    ///
    /// # Errors
    /// [`ExchangeError::Transport`] if MPI or PETSc does not start, or was started before.
    pub fn start() -> Result<Self, ExchangeError> {
        if IS_STARTED.swap(true, Ordering::SeqCst) {
            return Err(ExchangeError::Transport("MPI was started before".to_owned()));
        }
        // SAFETY: the first call
        check(unsafe { ul_start() }, "the start of MPI and PETSc")
            .map_err(ExchangeError::Transport)?;
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            report(panic);
            abort_all(101);
        }));
        Ok(Self(()))
    }
    /// The number of this process.
    pub fn rank(&self) -> u32 {
        // SAFETY: no pointers
        unsafe { ul_rank() as u32 }
    }
    /// How many processes there are.
    pub fn count(&self) -> usize {
        // SAFETY: no pointers
        unsafe { ul_size() as usize }
    }
    /// This process, with PETSc as its engine.
    #[must_use]
    pub fn own(&self) -> Process {
        Process::new(self.rank(), MpiExchange::new(self.count()), Petsc::default())
    }
    /// Leaves the job; all processes call it, after everything that holds a matrix is gone.
    ///
    /// # Errors
    /// [`ExchangeError::Transport`].
    pub fn end(self) -> Result<(), ExchangeError> {
        // SAFETY: the last call
        check(unsafe { ul_end() }, "the end of MPI and PETSc").map_err(ExchangeError::Transport)
    }
}

/// Ends all processes of the job at once, with this exit code.
pub fn abort_all(code: i32) {
    // SAFETY: no pointers
    unsafe { ul_abort(code) }
}
