//! Symmetric positive definite preconditioners on the free unknowns.
//!
//! `preconditioner`: the trait. `multigrid`: conforming linear functions, with `gauss_seidel`,
//! `prolongation`, `aggregation` and `coarse_level`. `auxiliary_space`: other finite elements.
//! `mean_jump_splitting` and `facet_mean_form`: over-penalised discontinuous elements.
//! `coarse_spaces`: the spaces that are known for an inequality. `built_in`: the preconditioner that
//! fits an inequality.

mod aggregation;
mod auxiliary_space;
mod built_in;
mod coarse_level;
mod coarse_spaces;
mod facet_mean_form;
mod gauss_seidel;
mod mean_jump_splitting;
mod multigrid;
mod preconditioner;
mod prolongation;

pub use built_in::BuiltInPreconditioners;
pub use coarse_level::{CoarseLevel, P1Level};
pub use coarse_spaces::CoarseSpaces;
pub(crate) use multigrid::Multigrid;
pub use preconditioner::{PreconditionedSystem, Preconditioner, PreconditionerFamily};
pub use prolongation::Prolongation;
