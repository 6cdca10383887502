//! Studies: schemes side by side on a scene, their rows, tables, files and plots.

mod any_scheme;
mod csv;
mod fit;
mod levels;
mod memory;
mod orders;
mod plot;
mod registry;
mod report;
mod row;
mod run;
mod table;
mod vtu;

pub use row::{
    Certificate, Errors, ExpectedOrders, Iterations, PenaltyParameters, Row, Seconds,
};
