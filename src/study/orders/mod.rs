//! Observed orders: of the rows of a report, fitted over levels, and in tables.

mod check;
mod fill;
pub(crate) mod rates;
mod table;

pub use check::{ObservedOrders, OrderMissed, OrderVerdict, OrdersMissed};
pub use fill::fill_orders;
pub use table::{orders_summary, orders_table};
