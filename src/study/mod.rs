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
mod memory_limits;
mod order_check;
mod orders;
mod orders_table;
mod reference;
pub(crate) mod report;
pub(crate) mod row;
mod runner;
mod setting;
pub(crate) mod table;

pub use crate::nested::Phase;
pub use compatibility::check_fit;
pub use extrapolate::{Extrapolated, Limit, extrapolate, limit};
#[cfg(feature = "report")]
pub use file_name::file_name;
#[cfg(feature = "report")]
pub use journal::Journal;
pub use memory::{MemoryEstimate, available_memory_bytes, peak_memory_bytes};
pub use order_check::{ObservedOrders, OrderMissed, OrderVerdict, OrdersMissed};
pub use orders::fill_orders;
pub use orders_table::{orders_summary, orders_table};
pub use report::{Program, Report};
pub use row::{Iterations, Orders, Row, RowKey, Seconds};
pub use runner::{Progress, Study};
