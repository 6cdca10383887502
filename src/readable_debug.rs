//! `Debug` of the error types: the sentence of `Display`, followed by the causes it leaves out.
//!
//! A program whose `main` returns an error prints it by `Debug`.

use std::error::Error;
use std::fmt;

/// Writes an error and the chain of its sources, separated by colons; a source whose message is part
/// of what stands before is left out.
pub(crate) fn write_chain(error: &dyn Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let mut message = error.to_string();
    f.write_str(&message)?;
    let mut source = error.source();
    while let Some(cause) = source {
        let text = cause.to_string();
        if !message.contains(&text) {
            write!(f, ": {text}")?;
            message = text;
        }
        source = cause.source();
    }
    Ok(())
}

/// Implements `Debug` of error types by [`write_chain`].
macro_rules! debug_by_display {
    ($($error:ty),+ $(,)?) => {$(
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                $crate::readable_debug::write_chain(self, f)
            }
        }
    )+};
}
pub(crate) use debug_by_display;
