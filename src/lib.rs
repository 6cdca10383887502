// links of README as modules, see `docs`
#![cfg_attr(doc, doc = include_str!("docs/labels.md"))]
#![doc = include_str!("../README.md")]
#![deny(unsafe_code)]
#![deny(missing_docs)]

/// The linear algebra library in whose terms [`real::Point`] is an `SVector`: its version is part of
/// the public interface of this crate.
pub use nalgebra;

pub mod algebra;
mod arrays;
pub mod assemble;
pub mod constraint;
pub mod distributed;
#[cfg(doc)]
pub mod docs;
pub mod element;
pub mod error;
pub mod error_bound;
#[cfg(feature = "report")]
pub mod exchange;
pub mod facet;
#[cfg(feature = "report")]
mod files;
pub mod inequality;
#[cfg(not(feature = "cli"))]
mod input;
#[cfg(feature = "cli")]
pub mod input;
mod instances;
#[cfg(feature = "kit")]
pub mod kit;
pub mod linear;
pub mod measure;
mod memory;
pub mod mesh;
pub mod nested;
#[cfg(feature = "report")]
pub mod output;
mod parallel;
#[cfg(feature = "report")]
pub mod paraview;
#[cfg(feature = "plot")]
pub mod plot;
pub mod prelude;
pub mod problem;
#[cfg(feature = "problem-files")]
pub mod problem_file;
pub mod processes;
pub mod quadrature;
mod readable_debug;
pub mod real;
pub mod scenes;
pub mod scheme;
#[cfg(feature = "report")]
pub mod stability;
pub mod study;
mod table;
mod theory;
#[cfg(feature = "report")]
pub mod work_precision;
