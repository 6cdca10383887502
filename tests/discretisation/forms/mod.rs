//! Matrices and loads: against slow assemblers, their condition, their rounding.

mod assembly;
mod bounds;
mod condition;
mod dirichlet_energy;
mod lifting;
mod lumping;
mod own_forms;
mod penalty_factors;
mod rounding;
mod shared_unknowns;
mod weights;
