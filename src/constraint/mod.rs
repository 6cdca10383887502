//! Constraint sets: the convex set of discrete functions among which an inequality looks for its
//! solution.
//!
//! A set says which unknowns of a cell are bound and by what. It belongs to the problem
//! ([`Problem::on`](crate::problem::Problem::on)) or to an entry of a study
//! ([`Study::scheme_on`](crate::study::Study::scheme_on)), never to a scheme; where nothing is said,
//! [`Nodes`] holds. Bounds bind single unknowns, so the element must have the functionals of the set
//! among its nodes, or know a basis of the same space that has.

mod bernstein;
mod by_name;
mod constraint_set;
mod facet_means;
mod midpoints;
mod nodes;
mod on_element;

pub use bernstein::Bernstein;
pub use by_name::{CONSTRAINT_SETS, constraint_set_by_name};
pub use constraint_set::{BoundBy, ConstraintSet};
pub use facet_means::FacetMeans;
pub use midpoints::Midpoints;
pub use nodes::Nodes;
pub(crate) use on_element::{in_basis_of, offered};
