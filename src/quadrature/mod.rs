//! Quadrature on simplices: rules, and families of rules.
//!
//! Weights sum to one: multiply by the measure of the cell or facet. Points are barycentric, so one
//! rule serves cells of dimension `d` and facets of cells of dimension `d + 1`.

mod error;
mod exactness;
mod families;
mod gauss;
mod orthonormal;
mod rule;
mod symmetric;

pub use error::QuadratureError;
pub use families::{ConicalProduct, Quadrature, VertexRule};
pub(crate) use orthonormal::OrthonormalPolynomials;
pub use rule::Rule;
pub(crate) use rule::{facet_to_cell, vertex_point};
pub use symmetric::FullySymmetric;
