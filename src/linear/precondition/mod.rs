//! Preconditioners for Krylov methods.

pub(crate) mod aggregation;
pub(crate) mod auxiliary_space;
pub(crate) mod choice;
pub(crate) mod coarse_level;
pub(crate) mod coarse_spaces;
pub(crate) mod facet_pairs;
pub(crate) mod gauss_seidel;
pub(crate) mod mean_jump_split;
pub(crate) mod multigrid;
pub(crate) mod prolongation;
