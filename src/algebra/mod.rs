//! Algebraic data: sparse and dense matrices, and the variational inequality that every solver and
//! exporter takes. Independent of mesh, dimension and scheme.
//!
//! `matrix`: compressed sparse rows. `galerkin_product`: `P^T A P`. `penalised_matrix`: `K + M^T S M`; `jumps`: the matrix
//! `M`; `mean_jumps`: the facets of `M` for discontinuous linear functions. `side_penalties`: `M^T S M` of these.
//! `dense`: small dense matrices.
//! `dirichlet_energy`: the terms of an energy that weak Dirichlet data determine.
//! `distribution`: unknowns in several processes. `free_body`: bodies that bounds alone hold. `bound`: bounds of an
//! unknown. `kink`: kinks of the convex functions of unknowns. `inequality`: locations of unknowns and the inequality.
//! `in_precision`: matrices, bounds and inequalities rounded.

mod bound;
pub(crate) mod dense;
mod dirichlet_energy;
mod distribution;
mod free_body;
mod galerkin_product;
mod in_precision;
mod inequality;
mod jumps;
mod kink;
mod matrix;
mod mean_jumps;
mod penalised_matrix;
mod side_penalties;

pub use bound::{Bound, Contact};
pub use dirichlet_energy::{DirichletEnergy, DirichletTerm};
pub use distribution::Distribution;
pub(crate) use distribution::{OnePart, any_part, sum_over_parts};
pub use free_body::FreeBody;
pub(crate) use free_body::{RESULTANT_ROUNDING, Sum};
pub(crate) use galerkin_product::{SparseSum, galerkin_product};
pub(crate) use in_precision::rounded;
pub use inequality::{DofLocation, Inequality, Start};
pub use jumps::{JumpSide, JumpTerm, Jumps};
pub use kink::Kink;
pub use matrix::SparseMatrix;
pub(crate) use matrix::{product_of_row, sort_by_column};
pub use mean_jumps::MeanJumps;
pub use penalised_matrix::PenalisedMatrix;
pub(crate) use side_penalties::SidePenalties;

/// Marks the absence of an index in arrays of `u32` indices.
pub(crate) const NO_INDEX: u32 = u32::MAX;
