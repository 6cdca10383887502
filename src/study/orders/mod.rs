//! Observed orders: of the rows of a report, and fitted over levels.

mod check;
mod fill;
pub(crate) mod rates;

pub use check::{ObservedOrders, OrderMissed, OrderVerdict, OrdersMissed};
pub use fill::fill_orders;
