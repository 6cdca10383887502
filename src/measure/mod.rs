//! Measures of a discrete solution: error norms, multiplier, contact set, free boundary, penetration,
//! fields, values by name.

mod admissible;
mod cell_errors;
mod contact;
mod energy;
mod errors;
mod evaluation;
mod fields;
mod norms;
mod order;
mod penetration;
mod recovered_gradient;
mod rounding;
mod squared_errors;
mod values;

pub(crate) use admissible::Admissible;
pub(crate) use cell_errors::Counts;
pub use contact::DiscreteContact;
pub(crate) use contact::contact_difference;
pub use errors::{ContactErrors, ErrorNorm, Errors};
pub use fields::Fields;
pub use order::{FittedOrder, fit_order, observed_order};
pub use penetration::Penetration;
pub use rounding::Rounding;
pub use squared_errors::SquaredErrors;
pub use values::FoundValue;
