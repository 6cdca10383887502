//! The phases of a run.

use std::fmt;

/// A phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// The meshes are made.
    Mesh,
    /// Conforming P1 is solved on this and coarser meshes, from which the scheme starts.
    Start,
    /// Matrix, load and bounds are assembled.
    Assembly,
    /// The inequality is solved.
    Solve,
    /// The error of the solution is bounded, by which the next mesh is refined.
    Bound,
    /// Energy and errors of the solution are computed.
    Measures,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mesh => "mesh",
            Self::Start => "start",
            Self::Assembly => "assembly",
            Self::Solve => "solve",
            Self::Bound => "bound",
            Self::Measures => "measures",
        })
    }
}
