//! Reports as files: JSON, comma-separated values, plots.

pub(crate) mod csv;
mod report;

pub use csv::to_csv;
