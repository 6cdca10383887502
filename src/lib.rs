#![doc = include_str!("../README.md")]
#![deny(unsafe_code)]
#![deny(missing_docs)]

pub mod algebra;
pub mod assemble;
pub mod element;
pub mod error;
pub mod facet;
pub mod kit;
mod memory;
pub mod mesh;
pub mod prelude;
pub mod problem;
pub mod quadrature;
pub mod real;
pub mod scenes;
pub mod scheme;
pub mod solve;
pub mod study;
