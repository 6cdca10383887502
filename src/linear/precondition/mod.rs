//! Symmetric positive definite preconditioners on the free unknowns.
//!
//! `preconditioner`: the traits. `multigrid`: conforming linear functions, and other elements with conforming linear
//! functions as auxiliary space; it uses `block_gauss_seidel`, `prolongation`, `aggregation` and `coarse_level`.
//! `mean_jump_splitting`, `mixed_block`, `facet_mean_form` and `crouzeix_raviart_space`: over-penalised discontinuous
//! linear elements. `coarse_spaces`: the spaces that are known for an inequality. `built_in`: the preconditioner that
//! fits an inequality.

mod aggregation;
mod block_gauss_seidel;
mod built_in;
mod coarse_level;
mod coarse_spaces;
mod crouzeix_raviart_space;
mod facet_mean_form;
mod in_precision;
mod mean_jump_splitting;
mod mixed_block;
mod multigrid;
mod preconditioner;
mod prolongation;

pub use built_in::BuiltInPreconditioners;
pub(crate) use built_in::unknowns_per_cell;
pub use coarse_level::{CoarseLevel, P1Level};
pub use coarse_spaces::CoarseSpaces;
pub(crate) use mean_jump_splitting::MeanJumpSplitting;
pub(crate) use mixed_block::BlockSolver;
pub(crate) use preconditioner::FacetMeansSolver;
pub use preconditioner::{PreconditionedSystem, Preconditioner, PreconditionerFamily};
pub use prolongation::Prolongation;
