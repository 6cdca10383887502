//! Parallel loops with chunks of fixed length: the same bits for any number of threads.

pub(crate) mod cells;
pub(crate) mod vectors;
