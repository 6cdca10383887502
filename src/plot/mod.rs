//! Plots of a report: error against mesh size and against time, certificates over the work; pictures of a solution.
//!
//! Data (`series`), positions (`axis`, `layout`) and appearance (`panel`, `style`) are separate from the format of
//! the file (`pen`).

mod axis;
mod cost;
mod figure;
mod history;
mod layout;
mod panel;
mod pen;
mod picture;
mod series;
mod slopes;
mod style;

pub(crate) use cost::cost_figure;
pub use figure::{Figure, convergence, work_precision};
pub(crate) use figure::{overview, shows_all};
pub(crate) use history::history_figure;
pub use picture::Picture;
pub(crate) use series::Quantity;
