//! The C functions of `shim.c`, and their errors.

use std::ffi::{CStr, CString, c_char, c_int, c_void};

unsafe extern "C" {
    pub(super) fn ul_start() -> c_int;
    pub(super) fn ul_end() -> c_int;
    pub(super) fn ul_abort(code: c_int);
    pub(super) fn ul_rank() -> c_int;
    pub(super) fn ul_size() -> c_int;
    pub(super) fn ul_version(numbers: *mut c_int);
    pub(super) fn ul_error_text(code: c_int) -> *const c_char;
    pub(super) fn ul_sum(numbers: *mut f64, count: c_int) -> c_int;
    pub(super) fn ul_largest(numbers: *mut f64, count: c_int) -> c_int;
    pub(super) fn ul_counts(sent: *const c_int, received: *mut c_int) -> c_int;
    pub(super) fn ul_exchange(
        sent: *const u64,
        to: *const c_int,
        received: *mut u64,
        from: *const c_int,
    ) -> c_int;
    pub(super) fn ul_any(failed: c_int, why: *const c_char) -> c_int;
    pub(super) fn ul_abort_with(why: *const c_char);
    pub(super) fn ul_matrix_new(
        first: i64,
        rows: i64,
        in_own_columns: *const c_int,
        in_other_columns: *const c_int,
        out: *mut *mut c_void,
    ) -> c_int;
    pub(super) fn ul_matrix_row(
        matrix: *mut c_void,
        row: i64,
        count: c_int,
        columns: *const i64,
        values: *const f64,
    ) -> c_int;
    pub(super) fn ul_matrix_assemble(matrix: *mut c_void) -> c_int;
    pub(super) fn ul_matrix_destroy(matrix: *mut *mut c_void) -> c_int;
    pub(super) fn ul_solver_new(matrix: *mut c_void, method: c_int, out: *mut *mut c_void)
    -> c_int;
    pub(super) fn ul_solver_fix(solver: *mut c_void, rows: *const i64, count: i64) -> c_int;
    pub(super) fn ul_solver_apply(
        solver: *mut c_void,
        residual: *const f64,
        correction: *mut f64,
    ) -> c_int;
    pub(super) fn ul_solver_destroy(solver: *mut c_void) -> c_int;
}

/// What the C functions return for a matrix that is not positive definite, and PETSc for lack of memory.
pub(super) const NOT_POSITIVE: c_int = 10001;
pub(super) const OUT_OF_MEMORY: c_int = 55;

/// The text of an error of the C functions.
pub(super) fn check(code: c_int, what: &str) -> Result<(), String> {
    if code == 0 {
        return Ok(());
    }
    // SAFETY: the function returns a string constant
    let text = unsafe { CStr::from_ptr(ul_error_text(code)) };
    Err(format!("{what} failed: {}", text.to_string_lossy()))
}

/// The result of a step that all processes have done: an error if it failed in any of them. A process whose step
/// failed alone, inside a function in which the others wait for it, ends the job after some seconds.
pub(super) fn agreed(code: c_int, what: &str) -> Result<(), String> {
    let own = check(code, what);
    let why = own.as_ref().err().map_or("", String::as_str);
    let text = CString::new(why).unwrap_or_default();
    // SAFETY: the text ends with a zero
    match unsafe { ul_any(c_int::from(own.is_err()), text.as_ptr()) } {
        0 => Ok(()),
        _ => own.and(Err(format!("{what} failed in another process"))),
    }
}
