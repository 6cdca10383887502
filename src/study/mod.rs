//! Studies: schemes side by side on a scene, their rows and reports.

mod compatibility;
mod extrapolate;
#[cfg(feature = "report")]
mod fields;
#[cfg(feature = "report")]
mod file_name;
#[cfg(feature = "report")]
mod journal;
mod memory;
pub(crate) mod orders;
mod part_figures;
pub(crate) mod program;
mod reference;
pub(crate) mod report;
pub(crate) mod row;
mod runner;
pub(crate) mod series;
mod setting;
pub(crate) mod tables;

pub use crate::nested::Phase;
pub use compatibility::check_fit;
pub use extrapolate::{Extrapolated, Limit};
#[cfg(feature = "report")]
pub use file_name::file_name;
#[cfg(feature = "report")]
pub use journal::Journal;
pub use memory::peak_memory_bytes;
pub use orders::{ObservedOrder, OrderVerdict, OrdersMissed, fill_orders};
pub use part_figures::{PartFigures, PartSeconds};
pub use program::Program;
pub use report::Report;
pub use row::{Iterations, Orders, Row, RowKey, Seconds};
pub use runner::{Progress, Study};
pub use series::{Series, Variant};
