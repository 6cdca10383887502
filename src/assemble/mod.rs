//! One assembler for every scheme.
//!
//! A [`Discretisation`] joins element, facet form, problem and mesh; the room
//! [`scheme`](crate::scheme) defines which elements and forms make a scheme. The layout of the
//! element and the form, not the name of the scheme, select one of two ways to compute the matrix.
//! Rows of a broken space with a form belong to one cell and are written in place (`owned_rows`); all
//! other rows are gathered from local matrices (`shared_rows`). Both ways are parallel, without locks,
//! but for forms on shared unknowns, and give the same bits for any number of threads.

mod bodies;
pub(crate) mod cut_simplices;
mod data_quadrature;
mod discretisation;
mod facet_coefficients;
mod facet_fluxes;
mod jump_products;
mod load;
mod nullspace;
mod owned_rows;
mod penalised_matrix;
mod penalty_below_bound;
mod penalty_factor;
pub(crate) mod shared_rows;
pub(crate) mod space;
pub(crate) mod stiffness;
mod trace;
mod weak_dirichlet;

pub use data_quadrature::DataQuadrature;
pub use discretisation::Discretisation;
pub use penalty_below_bound::PenaltyBelowBound;
