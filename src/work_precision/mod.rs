//! Work against precision: what schemes take to reach a given error. [`Rounds`] measures the times,
//! [`Report::work_at_errors`](crate::study::Report::work_at_errors) reads them off a report.

mod report;
mod rounds;
mod runs;
mod tables;
mod verdict;
mod work_at_error;

pub use rounds::Rounds;
pub use work_at_error::{Standing, WorkAtError};
