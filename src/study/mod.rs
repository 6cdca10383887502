//! Studies: schemes side by side on a scene, their rows, tables, files and plots.

mod any_scheme;
mod csv;
mod fit;
mod levels;
mod memory;
mod orders;
mod orders_table;
mod picture;
mod plot;
mod promises;
mod pvd;
mod registry;
mod report;
mod row;
mod run;
mod stability;
mod table;
mod vtu;
mod work_precision;

pub use crate::solve::Certificate;
pub use any_scheme::{AnyScheme, Fields, Solved, Task};
pub use csv::to_csv;
pub use fit::check_fit;
pub use levels::{Levels, VertexContact};
pub use memory::{MemoryEstimate, available_memory_bytes, peak_memory_bytes};
pub use orders::{fill_orders, observed_order};
pub use orders_table::orders_table;
pub use picture::{FoundContact, Picture, Slice, solve_level};
pub use plot::{Figure, convergence, work_precision};
pub use promises::{Norm, ObservedOrders, OrderMissed, OrdersMissed};
pub use pvd::write_pvd;
pub use registry::{Placement, RegisteredSchemes, SCHEMES, SchemeOptions, scheme_by_name};
pub use report::{Program, Report, target_cpu};
pub use row::{
    ContactErrors, Errors, ExpectedOrders, Iterations, Orders, PenaltyParameters, Row, Seconds,
};
pub use run::{Progress, Study};
pub use stability::{
    CRITERIA, Criterion, Effort, Expected, STABILITY_CASES, Stability, StabilityProgress,
    StabilityReport, StabilityRow, Verdict,
};
pub use table::write_tables;
pub use vtu::{CellFields, write_vtu};
pub use work_precision::{
    Candidate, Case, Changes, ErrorNorm, Failure, Measured, Named, Phases, Precision, Provenance,
    Reach, Table, Variant, WorkPoint, WorkPrecision, WorkProgress, WorkReport, changes, work_at,
};
