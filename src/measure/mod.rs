//! What a solution is worth: error norms, multiplier, contact set, free boundary, fields.

mod contact;
mod errors;
mod fields;
mod norms;
mod order;

pub use contact::FoundContact;
pub use errors::{ContactErrors, Errors};
pub use fields::Fields;
pub use order::observed_order;
