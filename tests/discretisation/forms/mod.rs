//! Matrices and loads: against slow assemblers, their condition, their rounding.

mod assembly;
mod condition;
mod lifting;
mod rounding;
mod shared_unknowns;
