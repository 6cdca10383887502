//! Reports as tables: a summary at the finest level of every series, and all levels.

pub(crate) mod levels;
pub(crate) mod remarks;
pub(crate) mod summary;
