//! Reports as files: JSON, comma-separated values, plots, tables.

pub(crate) mod csv;
mod provenance;
mod report;
pub(crate) mod table;

pub use csv::to_csv;
pub use provenance::Provenance;
pub use table::Table;
