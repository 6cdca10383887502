//! Studies: schemes side by side on a scene, their rows, tables, files and plots.

mod row;

pub use row::{
    Certificate, Errors, ExpectedOrders, Iterations, PenaltyParameters, Row, Seconds,
};
