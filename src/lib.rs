//! One assembler, many schemes, the same inequality.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod algebra;
pub mod error;
pub mod mesh;
pub mod problem;
pub mod real;
pub mod scenes;
pub mod solve;
pub mod study;
