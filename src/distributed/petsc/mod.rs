//! Processes by MPI, and PETSc as the engine.
//!
//! `shim.c` alone sees MPI and PETSc. This file alone calls it, and has the only `unsafe` code of the room: every
//! block is a call of a C function with pointers that are valid for as many numbers as it is told.

#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::engine::{Engine, EngineMethod, EngineSolver, OwnData, OwnRows};
use super::error::ExchangeError;
use super::exchange::Exchange;
use super::process::Process;
use crate::linear::FactorError;

unsafe extern "C" {
    fn ul_start() -> c_int;
    fn ul_end() -> c_int;
    fn ul_abort(code: c_int);
    fn ul_rank() -> c_int;
    fn ul_size() -> c_int;
    fn ul_version(numbers: *mut c_int);
    fn ul_error_text(code: c_int) -> *const c_char;
    fn ul_sum(numbers: *mut f64, count: c_int) -> c_int;
    fn ul_largest(numbers: *mut f64, count: c_int) -> c_int;
    fn ul_counts(sent: *const c_int, received: *mut c_int) -> c_int;
    fn ul_exchange(
        sent: *const u64,
        to: *const c_int,
        received: *mut u64,
        from: *const c_int,
    ) -> c_int;
    fn ul_any(failed: c_int, why: *const c_char) -> c_int;
    fn ul_abort_with(why: *const c_char);
    fn ul_matrix_new(
        first: i64,
        rows: i64,
        in_own_columns: *const c_int,
        in_other_columns: *const c_int,
        out: *mut *mut c_void,
    ) -> c_int;
    fn ul_matrix_row(
        matrix: *mut c_void,
        row: i64,
        count: c_int,
        columns: *const i64,
        values: *const f64,
    ) -> c_int;
    fn ul_matrix_assemble(matrix: *mut c_void) -> c_int;
    fn ul_matrix_destroy(matrix: *mut *mut c_void) -> c_int;
    fn ul_solver_new(matrix: *mut c_void, method: c_int, out: *mut *mut c_void) -> c_int;
    fn ul_solver_fix(solver: *mut c_void, rows: *const i64, count: i64) -> c_int;
    fn ul_solver_apply(solver: *mut c_void, residual: *const f64, correction: *mut f64) -> c_int;
    fn ul_solver_destroy(solver: *mut c_void) -> c_int;
    fn ul_newton(
        matrix: *mut c_void,
        load: *const f64,
        lower: *mut f64,
        upper: *mut f64,
        values: *mut f64,
        steps: *mut c_int,
        converged: *mut c_int,
    ) -> c_int;
}

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
            return Err(ExchangeError::Transport { why: "MPI was started before".to_owned() });
        }
        // SAFETY: the first call
        check(unsafe { ul_start() }, "the start of MPI and PETSc")
            .map_err(|why| ExchangeError::Transport { why })?;
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
        let exchange = MpiExchange { parts: self.count(), sent: AtomicU64::new(0) };
        Process::new(self.rank(), exchange, Petsc { failure: Arc::default() })
    }
    /// Leaves the job; all processes call it, after everything that holds a matrix is gone.
    ///
    /// # Errors
    /// [`ExchangeError::Transport`].
    pub fn end(self) -> Result<(), ExchangeError> {
        // SAFETY: the last call
        check(unsafe { ul_end() }, "the end of MPI and PETSc")
            .map_err(|why| ExchangeError::Transport { why })
    }
}

/// Ends all processes of the job at once, with this exit code.
pub fn abort_all(code: i32) {
    // SAFETY: no pointers
    unsafe { ul_abort(code) }
}

/// The text of an error of the C functions.
fn check(code: c_int, what: &str) -> Result<(), String> {
    if code == 0 {
        return Ok(());
    }
    // SAFETY: the function returns a string constant
    let text = unsafe { CStr::from_ptr(ul_error_text(code)) };
    Err(format!("{what} failed: {}", text.to_string_lossy()))
}

#[derive(Debug)]
struct MpiExchange {
    parts: usize,
    /// Bytes sent so far.
    sent: AtomicU64,
}

impl MpiExchange {
    fn transport(code: c_int) -> Result<(), ExchangeError> {
        check(code, "a message of MPI").map_err(|why| ExchangeError::Transport { why })
    }
}

/// The length of a list as MPI counts.
fn length(list: usize) -> Result<c_int, ExchangeError> {
    let why = || format!("{list} numbers in one message: at most {} are possible", c_int::MAX);
    c_int::try_from(list).map_err(|_| ExchangeError::Transport { why: why() })
}

impl Exchange for MpiExchange {
    fn parts(&self) -> usize {
        self.parts
    }
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
        if lists.len() != self.parts {
            return Err(ExchangeError::Lists { lists: lists.len(), parts: self.parts });
        }
        let to = lists.iter().map(|l| length(l.len())).collect::<Result<Vec<c_int>, _>>()?;
        let mut from = vec![0; self.parts];
        // SAFETY: both lists have a number for each process
        Self::transport(unsafe { ul_counts(to.as_ptr(), from.as_mut_ptr()) })?;
        let sent = lists.concat();
        self.sent.fetch_add(8 * sent.len() as u64, Ordering::Relaxed);
        let mut received = vec![0_u64; from.iter().map(|&n| n as usize).sum()];
        // SAFETY: the buffers have as many words as the counts state
        Self::transport(unsafe {
            ul_exchange(sent.as_ptr(), to.as_ptr(), received.as_mut_ptr(), from.as_ptr())
        })?;
        let mut rest = &received[..];
        let of_process = |&n: &c_int| {
            let (own, after) = rest.split_at(n as usize);
            rest = after;
            own.to_vec()
        };
        Ok(from.iter().map(of_process).collect())
    }
    fn sent_bytes(&self) -> u64 {
        self.sent.load(Ordering::Relaxed)
    }
    fn sum(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        let mut sums = values.to_vec();
        // SAFETY: the list has as many numbers as stated
        Self::transport(unsafe { ul_sum(sums.as_mut_ptr(), length(values.len())?) })?;
        Ok(sums)
    }
    fn largest(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        // MPI does not say what the largest of a number and no number is
        let numbers = values.iter().map(|&x| if x.is_nan() { f64::NEG_INFINITY } else { x });
        let are_none = values.iter().map(|x| f64::from(u8::from(x.is_nan())));
        let mut both: Vec<f64> = numbers.chain(are_none).collect();
        // SAFETY: the list has as many numbers as stated
        Self::transport(unsafe { ul_largest(both.as_mut_ptr(), length(both.len())?) })?;
        let (numbers, are_none) = both.split_at(values.len());
        let number = |(&x, &is_none): (&f64, &f64)| if is_none == 0.0 { x } else { f64::NAN };
        Ok(numbers.iter().zip(are_none).map(number).collect())
    }
}

/// What the C functions return for a matrix that is not positive definite, and PETSc for lack of memory.
const NOT_POSITIVE: c_int = 10001;
const OUT_OF_MEMORY: c_int = 55;

/// The first failure of this process that nobody has taken.
type Failure = Arc<Mutex<Option<String>>>;

/// PETSc, with multigrid of hypre and factors of MUMPS.
#[derive(Debug)]
struct Petsc {
    failure: Failure,
}

/// Keeps the reason of a failure, if it is the first.
fn keep<T>(failure: &Failure, result: Result<T, String>) -> Option<T> {
    let keep_first = |why| {
        failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    };
    result.map_err(keep_first).ok()
}

/// The result of a step that all processes have done: an error if it failed in any of them. A process whose step
/// failed alone, inside a function in which the others wait for it, ends the job after some seconds.
fn agreed(code: c_int, what: &str) -> Result<(), String> {
    let own = check(code, what);
    let why = own.as_ref().err().map_or("", String::as_str);
    let text = CString::new(why).unwrap_or_default();
    // SAFETY: the text ends with a zero
    match unsafe { ul_any(c_int::from(own.is_err()), text.as_ptr()) } {
        0 => Ok(()),
        _ => own.and(Err(format!("{what} failed in another process"))),
    }
}

impl Engine for Petsc {
    fn name(&self) -> String {
        let mut version = [0; 3];
        // SAFETY: three numbers
        unsafe { ul_version(version.as_mut_ptr()) };
        let [major, minor, patch] = version;
        format!("PETSc {major}.{minor}.{patch}")
    }
    fn solver(&self, rows: &dyn OwnRows, method: EngineMethod) -> Box<dyn EngineSolver> {
        let method = match method {
            EngineMethod::Multigrid => 0,
            EngineMethod::Factors => 1,
        };
        let mut solver = PetscSolver {
            raw: null_mut(),
            first: rows.first() as i64,
            failure: self.failure.clone(),
        };
        let made = matrix(rows).and_then(|matrix| {
            // SAFETY: the solver takes the matrix, and writes its own address
            let code = unsafe { ul_solver_new(matrix, method, &mut solver.raw) };
            agreed(code, "a solver of PETSc")
        });
        if keep(&self.failure, made).is_none() {
            solver.destroy();
        }
        Box::new(solver)
    }
    fn solve_inequality(
        &self,
        rows: &dyn OwnRows,
        data: &OwnData<'_>,
        values: &mut [f64],
    ) -> Option<usize> {
        let (mut lower, mut upper) = (data.lower.to_vec(), data.upper.to_vec());
        let (mut steps, mut converged) = (0, 0);
        let solved = matrix(rows).and_then(|mut matrix| {
            // SAFETY: all lists have a number for each own row
            let code = unsafe {
                ul_newton(
                    matrix,
                    data.load.as_ptr(),
                    lower.as_mut_ptr(),
                    upper.as_mut_ptr(),
                    values.as_mut_ptr(),
                    &mut steps,
                    &mut converged,
                )
            };
            let what = "the solver of inequalities of PETSc";
            let solved = agreed(code, what);
            // SAFETY: the matrix is not used any more
            unsafe { ul_matrix_destroy(&mut matrix) };
            match solved {
                Ok(()) if converged == 0 => Err(format!("{what} stopped after {steps} steps")),
                solved => solved,
            }
        });
        keep(&self.failure, solved);
        Some(steps as usize)
    }
    fn take_failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// A matrix of PETSc, filled row by row: there is no second copy.
fn matrix(rows: &dyn OwnRows) -> Result<*mut c_void, String> {
    let (first, count) = (rows.first(), rows.count());
    let own = first..first + count as u64;
    let mut lengths = [vec![0; count], vec![0; count]];
    let mut entries = Vec::new();
    for k in 0..count {
        rows.row(k, &mut entries);
        let in_own = entries.iter().filter(|(column, _)| own.contains(column)).count();
        (lengths[0][k], lengths[1][k]) = (in_own as c_int, (entries.len() - in_own) as c_int);
    }
    let mut raw = null_mut();
    let [in_own, in_other] = lengths;
    let what = "a matrix of PETSc";
    // SAFETY: both lists have a number for each row
    let made = unsafe {
        ul_matrix_new(first as i64, count as i64, in_own.as_ptr(), in_other.as_ptr(), &mut raw)
    };
    let filled = agreed(made, what).and_then(|()| {
        let mut code = 0;
        let (mut columns, mut values) = (Vec::new(), Vec::new());
        for (k, row) in (0..count).zip(first as i64..) {
            rows.row(k, &mut entries);
            columns.clear();
            columns.extend(entries.iter().map(|entry| entry.0 as i64));
            values.clear();
            values.extend(entries.iter().map(|entry| entry.1));
            let n = columns.len() as c_int;
            // SAFETY: both lists have as many numbers as stated
            code = unsafe { ul_matrix_row(raw, row, n, columns.as_ptr(), values.as_ptr()) };
            if code != 0 {
                break;
            }
        }
        agreed(code, what)
    });
    // SAFETY: the matrix exists in all processes
    let assembled = filled.and_then(|()| agreed(unsafe { ul_matrix_assemble(raw) }, what));
    if let Err(why) = assembled {
        // SAFETY: the matrix is not used any more; nothing is destroyed where there is none
        unsafe { ul_matrix_destroy(&mut raw) };
        return Err(why);
    }
    Ok(raw)
}

/// A preconditioner of PETSc; without address if it could not be made.
struct PetscSolver {
    raw: *mut c_void,
    first: i64,
    failure: Failure,
}

// SAFETY: the C object has no state of a thread, and its functions take `&mut self`, so that one thread at a time
// calls them
unsafe impl Send for PetscSolver {}
// SAFETY: there is no function that takes `&self`
unsafe impl Sync for PetscSolver {}

impl PetscSolver {
    fn destroy(&mut self) {
        if !self.raw.is_null() {
            // SAFETY: the last use
            unsafe { ul_solver_destroy(self.raw) };
            self.raw = null_mut();
        }
    }
}

impl EngineSolver for PetscSolver {
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        if self.raw.is_null() {
            return Err(FactorError::NotPositive);
        }
        let number = |(k, _): (usize, &bool)| self.first + k as i64;
        let rows: Vec<i64> =
            fixed.iter().enumerate().filter(|(_, fixed)| **fixed).map(number).collect();
        // SAFETY: the list has as many numbers as stated
        let code = unsafe { ul_solver_fix(self.raw, rows.as_ptr(), rows.len() as i64) };
        let set = agreed(code, "a preconditioner of PETSc");
        match (set, code) {
            (Ok(()), _) => Ok(()),
            (Err(_), NOT_POSITIVE) => Err(FactorError::NotPositive),
            (Err(_), OUT_OF_MEMORY) => Err(FactorError::OutOfMemory),
            (failed, _) => {
                keep(&self.failure, failed);
                Err(FactorError::NotPositive)
            }
        }
    }
    fn apply(&mut self, residual: &[f64], correction: &mut [f64]) {
        if self.raw.is_null() {
            correction.fill(f64::NAN);
            return;
        }
        // SAFETY: both lists have a number for each own row
        let code = unsafe { ul_solver_apply(self.raw, residual.as_ptr(), correction.as_mut_ptr()) };
        if let Err(why) = check(code, "a preconditioner of PETSc") {
            let why = CString::new(why).unwrap_or_default();
            // SAFETY: the text ends with a zero. The other processes may wait inside the function
            unsafe { ul_abort_with(why.as_ptr()) };
        }
    }
}

impl Drop for PetscSolver {
    fn drop(&mut self) {
        self.destroy();
    }
}
