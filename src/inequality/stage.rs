//! The stages of a solve.

use std::fmt;

/// A stage of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Stage {
    /// The active set method with a preconditioned Krylov method.
    PreconditionedActiveSet,
    /// [`MonotoneMultigrid`](super::MonotoneMultigrid).
    MonotoneMultigrid,
    /// The active set method with factors.
    DirectActiveSet,
    /// The interior point method, which provides an active set.
    InteriorPoint,
}

impl Stage {
    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PreconditionedActiveSet => "preconditioned-active-set",
            Self::MonotoneMultigrid => "monotone-multigrid",
            Self::DirectActiveSet => "direct-active-set",
            Self::InteriorPoint => "interior-point",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A stage that ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StageRun {
    /// The stage.
    pub stage: Stage,
    /// The number of its outer iterations; see [`Solution::outer`](super::Solution::outer).
    pub outer: usize,
    /// The number of iterations of its linear solver.
    pub linear: usize,
}
