//! Studies: schemes side by side on a scene, their rows, tables, files and plots.
//!
//! The feature `report` has what writes files, `plot` plots and pictures.

mod any_scheme;
#[cfg(feature = "report")]
mod csv;
mod fit;
mod levels;
mod memory;
mod orders;
mod orders_table;
#[cfg(feature = "plot")]
mod picture;
#[cfg(feature = "plot")]
mod plot;
mod promises;
#[cfg(feature = "report")]
mod pvd;
mod registry;
mod report;
mod row;
mod run;
#[cfg(feature = "report")]
mod stability;
mod table;
#[cfg(feature = "report")]
mod vtu;
#[cfg(feature = "report")]
mod work_precision;

pub use crate::solve::Certificate;
pub use any_scheme::{AnyScheme, Fields, FoundContact, Solved, Task};
#[cfg(feature = "report")]
pub use csv::to_csv;
pub use fit::check_fit;
pub use levels::{Levels, VertexContact};
pub use memory::{MemoryEstimate, available_memory_bytes, peak_memory_bytes};
pub use orders::{fill_orders, observed_order};
pub use orders_table::orders_table;
#[cfg(feature = "plot")]
pub use picture::{Picture, Slice, solve_level};
#[cfg(feature = "plot")]
pub use plot::{Figure, convergence, work_precision};
pub use promises::{Norm, ObservedOrders, OrderMissed, OrdersMissed};
#[cfg(feature = "report")]
pub use pvd::write_pvd;
pub use registry::{Placement, RegisteredSchemes, SCHEMES, SchemeOptions, scheme_by_name};
pub use report::{Program, Report, target_cpu};
pub use row::{
    ContactErrors, Errors, ExpectedOrders, Iterations, Orders, PenaltyParameters, Row, Seconds,
};
pub use run::{Progress, Study};
#[cfg(feature = "report")]
pub use stability::{
    CRITERIA, Criterion, Effort, Expected, STABILITY_CASES, Stability, StabilityProgress,
    StabilityReport, StabilityRow, Verdict,
};
pub use table::write_tables;
#[cfg(feature = "report")]
pub use vtu::{CellFields, write_vtu};
#[cfg(feature = "report")]
pub use work_precision::{
    Candidate, Case, Changes, ErrorNorm, Failure, Measured, Named, Phases, Precision, Provenance,
    Reach, Table, Variant, WorkPoint, WorkPrecision, WorkProgress, WorkReport, changes, work_at,
};
