//! Measures of a discrete solution: error norms, multiplier, contact set, free boundary, fields.

mod contact;
mod energy;
mod error_norm;
mod errors;
mod evaluation;
mod fields;
mod norms;
mod order;

pub use contact::DiscreteContact;
pub(crate) use contact::contact_difference;
pub use error_norm::ErrorNorm;
pub use errors::{ContactErrors, Errors};
pub use fields::Fields;
pub(crate) use norms::error_degree;
pub use order::{FittedOrder, fit_order, observed_order};
