//! The names that a program needs to compare schemes, in one import.

pub use crate::assemble::Discretisation;
pub use crate::constraint::{Bernstein, BoundBy, ConstraintSet, FacetMeans, Midpoints, Nodes};
pub use crate::element::{Broken, CrouzeixRaviart, Element, Entity, Node, P1, P2};
pub use crate::error::Error;
pub use crate::facet::{
    DirichletBy, FacetForm, FacetView, Lifts, NoFacets, PenaltyRule, Trace, WeightRule,
    proven_bound,
};
pub use crate::mesh::{BoundaryCondition, BoxDomain, Mesh};
pub use crate::nested::{AdaptiveMeshes, Adaptivity, Stop, adapt};
pub use crate::nested::{Hierarchy, NestedIteration, Solved, solve};
pub use crate::problem::{DiscreteFunction, Problem, ValueOf};
pub use crate::real::Point;
pub use crate::scenes::{self, Scene};
pub use crate::scheme::*;
#[cfg(feature = "report")]
pub use crate::study::Journal;
pub use crate::study::{Report, Study};
