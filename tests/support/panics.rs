//! What a call says when it panics.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// The message of the panic of a call, which must panic.
pub fn message_of_panic(call: impl FnOnce()) -> String {
    let payload = catch_unwind(AssertUnwindSafe(call)).expect_err("no panic");
    let text = payload.downcast_ref::<String>().cloned();
    text.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap()
}
