//! Reports as files: JSON, comma-separated values, plots, tables.

pub(crate) mod csv;
pub(crate) mod html;
pub(crate) mod latex;
mod pages;
mod provenance;
mod report;
pub(crate) mod table;

pub use latex::LATEX_PACKAGES;
pub use provenance::Provenance;
pub use table::Table;
