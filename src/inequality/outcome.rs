//! How a solve ended.

/// How a solve ended. Only [`Outcome::Converged`] is a success; every other outcome comes with the
/// best iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outcome {
    /// The complementarity conditions hold to the tolerance.
    Converged,
    /// The iteration limit was reached while the active set still moved.
    IterationLimit,
    /// The active set returned to an earlier one and could not be resolved.
    Cycling,
    /// Steps no longer change the iterate, yet the conditions do not hold.
    Stalled,
    /// The matrix is not positive definite on the free unknowns (penalty too small).
    NotCoercive,
    /// The matrix is singular on the free unknowns.
    Singular,
    /// A number that is not finite appeared.
    NotFinite,
    /// Two bounds of one unknown leave no value between them.
    Infeasible,
    /// Sizes of matrix, load and bounds do not match, or the matrix is not what its type promises.
    Malformed,
    /// The factors do not fit into memory.
    OutOfMemory,
}

impl Outcome {
    /// The name in reports, in kebab-case.
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

#[cfg(feature = "report")]
impl serde::Serialize for Outcome {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
