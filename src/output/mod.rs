//! Reports as files: JSON, comma-separated values, plots, tables.

pub(crate) mod csv;
pub(crate) mod document;
pub(crate) mod html;
mod pages;
mod report;

pub use crate::table::{LATEX_PACKAGES, Table};
