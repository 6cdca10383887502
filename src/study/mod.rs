//! Studies: schemes side by side on a scene, their rows, tables, files and plots.

mod csv;
mod memory;
mod orders;
mod plot;
mod report;
mod row;
mod table;
mod vtu;

pub use csv::to_csv;
pub use memory::peak_memory_bytes;
pub use orders::{fill_orders, observed_order};
pub use plot::{Figure, convergence, work_precision};
pub use report::{Program, Report, target_cpu};
pub use row::{
    Certificate, Errors, ExpectedOrders, Iterations, PenaltyParameters, Row, Seconds,
};
pub use table::write_tables;
pub use vtu::{CellFields, write_vtu};
