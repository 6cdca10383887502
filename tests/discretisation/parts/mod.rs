//! Schemes on parts of meshes against the same schemes on the whole.

mod bounds;
mod compare;
mod failures;
mod fields;
mod gathered;
mod meshes;
mod numbers;
mod problems;
mod refined;
mod rows;
mod solves;
mod sums;
