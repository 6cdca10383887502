//! Quadrature on simplices: any degree, any dimension, positive weights, points inside.
//!
//! Weights sum to one: multiply by the measure of the cell or facet. Points are barycentric, so one
//! rule serves cells of dimension `d` and facets of cells of dimension `d + 1`.

mod gauss;
mod orthonormal;
mod rule;

pub(crate) use orthonormal::OrthonormalPolynomials;
pub use rule::Rule;
pub(crate) use rule::facet_to_cell;
