//! What is known beside an inequality and helps to solve it fast.

use std::sync::Arc;

use super::hierarchy::{Coarser, VertexLevel};

/// Which linear solver works inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Linear {
    /// Sparse factors, exact to rounding.
    Direct,
    /// Conjugate gradients with multigrid on conforming linear functions; for matrices that are not
    /// symmetric minimal residuals with the same for their symmetric part
    /// ([`Outcome::NotCoercive`](super::Outcome::NotCoercive) if it is not positive definite).
    Iterative,
    /// Whichever is faster: iterative above a size measured, if nested meshes are known.
    #[default]
    BySize,
}

impl Linear {
    /// All of them by the names users type.
    pub const NAMES: [(&'static str, Linear); 3] =
        [("direct", Linear::Direct), ("iterative", Linear::Iterative), ("by-size", Linear::BySize)];
}

/// The conforming linear functions near an inequality.
#[derive(Clone, Debug, Default)]
pub enum Functions<T> {
    /// None known; they are then made from the matrix and the places of its unknowns alone.
    #[default]
    Unknown,
    /// The unknowns are themselves the vertex values; these are coarser ones.
    Coarser(Coarser<T>),
    /// Those on the same mesh.
    Same(Arc<VertexLevel<T>>),
}

/// Meshes and a solution nearby: numbers only.
#[derive(Clone, Debug)]
pub struct Nearby<T> {
    /// Conforming linear functions.
    pub functions: Functions<T>,
    /// Values of all unknowns to start from.
    pub values: Option<Vec<T>>,
    /// Relative size of the energy error that will do; `None` for as small as makes sense. A
    /// direct solver may do better.
    pub accuracy: Option<f64>,
}

impl<T> Default for Nearby<T> {
    fn default() -> Self {
        Self { functions: Functions::Unknown, values: None, accuracy: None }
    }
}
