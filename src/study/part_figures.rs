//! The figures of a run over several parts of a mesh.

/// Figures of a run over several parts of a mesh, one in each process.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PartFigures {
    /// Number of processes.
    pub count: usize,
    /// The engine of linear solvers.
    pub engine: String,
    /// Unknowns that parts have of others, divided by all unknowns.
    pub ghosts: f64,
    /// The largest number of own unknowns of a part divided by the mean.
    pub imbalance: f64,
    /// Seconds by phase, the least and the most of all parts.
    pub seconds: PartSeconds,
}

/// Seconds by phase, each the least and the most of all parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PartSeconds {
    /// The part of the mesh and of all coarser ones.
    pub mesh: [f64; 2],
    /// Assembly.
    pub assemble: [f64; 2],
    /// The numbers of unknowns over all parts.
    pub number: [f64; 2],
    /// The start: conforming P1 on this and all coarser meshes.
    pub start: [f64; 2],
    /// The solve, with auxiliary matrices and their preconditioners.
    pub solve: [f64; 2],
}
