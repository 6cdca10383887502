//! PETSc as the engine: its matrices, preconditioners and solver of inequalities.

use std::ffi::{CString, c_int, c_void};
use std::ptr::null_mut;
use std::sync::{Arc, Mutex, PoisonError};

use super::shim::{
    NOT_POSITIVE, OUT_OF_MEMORY, agreed, check, ul_abort_with, ul_matrix_assemble,
    ul_matrix_destroy, ul_matrix_new, ul_matrix_row, ul_solver_apply, ul_solver_destroy,
    ul_solver_fix, ul_solver_new, ul_version,
};
use crate::distributed::engine::{Engine, EngineMethod, EngineSolver, OwnRows};
use crate::linear::FactorError;

/// The first failure of this process that nobody has taken.
type Failure = Arc<Mutex<Option<String>>>;

/// PETSc, with multigrid of hypre and factors of MUMPS.
#[derive(Debug, Default)]
pub(super) struct Petsc {
    failure: Failure,
}

/// Keeps the reason of a failure, if it is the first.
fn keep<T>(failure: &Failure, result: Result<T, String>) -> Option<T> {
    let keep_first = |why| {
        failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    };
    result.map_err(keep_first).ok()
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
