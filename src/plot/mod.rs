//! Plots of a report: error against mesh size, and error against time; pictures of a solution.
//!
//! Data (`series`), positions (`axis`, `layout`) and appearance (`panel`, `style`) are separate from the format of
//! the file (`pen`).

mod axis;
mod cost;
mod figure;
mod layout;
mod panel;
mod pen;
mod picture;
mod series;
mod slopes;
mod style;
mod sweep;

pub(crate) use cost::{Cost, cost_figure};
pub(crate) use figure::overview;
pub use figure::{Figure, convergence, work_precision};
pub use picture::Picture;
pub(crate) use sweep::{SweepPoint, sweep_figure};
