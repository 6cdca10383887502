//! The value that stands for a missing index.

/// Marks the absence of an index in arrays of `u32` indices.
pub(crate) const NO_INDEX: u32 = u32::MAX;
