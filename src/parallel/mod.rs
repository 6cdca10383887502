//! Parallel loops over chunks of fixed length, for the same bits with any number of threads.
//!
//! `cells`: loops of the assembly over cells, rows or patches. `vectors`: loops of solvers over the
//! entries of vectors, with inner products and pseudorandom signs.

pub(crate) mod cells;
pub(crate) mod vectors;
