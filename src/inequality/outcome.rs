//! The outcome of a solve.

use crate::linear::direct::FactorError;

/// The outcome of a solve. Only [`Outcome::Converged`] is a success; for the values that come with
/// any other outcome see [`Solution::values`](super::Solution::values).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outcome {
    /// The complementarity conditions hold to the tolerance.
    Converged,
    /// The iteration limit was reached while the active set still changed.
    IterationLimit,
    /// The active set returned to an earlier one, and no method resolved the cycle.
    Cycling,
    /// Rounding prevents the complementarity conditions from holding to the tolerance.
    Stalled,
    /// The matrix is not positive definite on the inactive unknowns (penalty too small).
    NotCoercive,
    /// The matrix is singular on the inactive unknowns.
    Singular,
    /// A number is not finite.
    NotFinite,
    /// The lower bound of an unknown exceeds its upper bound.
    Infeasible,
    /// Sizes of matrix, load, bounds and supports do not match, the matrix violates an invariant of its
    /// type, or a support names a vertex that cannot exist.
    Malformed,
    /// The factors do not fit into memory.
    OutOfMemory,
}

impl Outcome {
    /// The name in reports, in kebab-case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Converged => "converged",
            Outcome::IterationLimit => "iteration-limit",
            Outcome::Cycling => "cycling",
            Outcome::Stalled => "stalled",
            Outcome::NotCoercive => "not-coercive",
            Outcome::Singular => "singular",
            Outcome::NotFinite => "not-finite",
            Outcome::Infeasible => "infeasible",
            Outcome::Malformed => "malformed",
            Outcome::OutOfMemory => "out-of-memory",
        }
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl From<FactorError> for Outcome {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::NotPositive => Outcome::NotCoercive,
            FactorError::Singular => Outcome::Singular,
            FactorError::OutOfMemory => Outcome::OutOfMemory,
        }
    }
}

#[cfg(feature = "report")]
impl serde::Serialize for Outcome {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
