//! Observed orders: of the rows of a report, and fitted over levels.

mod check;
mod fill;

pub use check::{ObservedOrder, OrderVerdict, OrdersMissed};
pub use fill::fill_orders;
