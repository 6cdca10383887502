//! The outcome of a solve.

use crate::error::Error;
use crate::linear::direct::FactorError;

/// The outcome of a solve. Only [`Outcome::Converged`] is a success; for the values that come with
/// any other outcome see [`Solution::values`](super::Solution::values).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Outcome {
    /// The complementarity conditions hold to the tolerance.
    Converged,
    /// The iteration limit was reached while the active set still changed.
    IterationLimit,
    /// The active set did not settle, and no later method found a solution.
    Cycling,
    /// Rounding prevents the complementarity conditions from holding to the tolerance.
    Stalled,
    /// Values that no solver of this library computed do not satisfy the inequality to the tolerance.
    NotASolution,
    /// The solver does not take such an inequality.
    Unsuitable,
    /// The matrix is not positive definite on the inactive unknowns (penalty too small).
    NotCoercive,
    /// The matrix is singular on the inactive unknowns.
    Singular,
    /// The load pulls a body, which only bounds hold, away from them: the energy has no minimum.
    NoSolution,
    /// The load on a part of the domain that only bounds hold is balanced: the values are one of many
    /// solutions, which differ by a constant there.
    NotUnique,
    /// A number is not finite.
    NotFinite,
    /// The squares of the data underflow or overflow, or single precision does not hold the data.
    OutOfRange,
    /// The lower bound of an unknown exceeds its upper bound.
    Infeasible,
    /// Sizes of matrix, load, bounds and locations do not match, the matrix violates an invariant of its
    /// type, or a location names a vertex that cannot exist.
    Malformed,
    /// The factors do not fit into memory.
    OutOfMemory,
    /// The solve was not begun: that on the next coarser level took longer than was allowed.
    TimeLimit,
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
            Outcome::NotASolution => "not-a-solution",
            Outcome::Unsuitable => "unsuitable",
            Outcome::NotCoercive => "not-coercive",
            Outcome::Singular => "singular",
            Outcome::NoSolution => "no-solution",
            Outcome::NotUnique => "not-unique",
            Outcome::NotFinite => "not-finite",
            Outcome::OutOfRange => "out-of-range",
            Outcome::Infeasible => "infeasible",
            Outcome::Malformed => "malformed",
            Outcome::OutOfMemory => "out-of-memory",
            Outcome::TimeLimit => "time-limit",
        }
    }
    /// Whether the values of a solution with this outcome are an iterate; otherwise they have no meaning.
    pub(crate) fn has_iterate(self) -> bool {
        use Outcome::{Converged, Cycling, IterationLimit, NotASolution, NotUnique, Stalled};
        matches!(self, Converged | IterationLimit | Cycling | Stalled | NotASolution | NotUnique)
    }
    /// The outcome of a solve that corresponds to an error of the data; `None` for errors of another kind.
    pub(crate) fn of_error(error: &Error) -> Option<Self> {
        match error {
            Error::CoefficientNotPositive(_) => Some(Outcome::NotCoercive),
            Error::DataNotFinite(_) => Some(Outcome::NotFinite),
            Error::EmptyConstraint { .. } => Some(Outcome::Infeasible),
            Error::Parameter(_) => Some(Outcome::OutOfRange),
            Error::NotEnoughMemory(_) => Some(Outcome::OutOfMemory),
            _ => None,
        }
    }
    /// An explanation of the outcome, in one sentence.
    #[must_use]
    pub fn message(self) -> &'static str {
        match self {
            Outcome::Converged => {
                "the complementarity conditions hold to the limits of the certificate"
            }
            Outcome::IterationLimit => {
                "the limit of iterations was reached while the active set still changed; raise it, or use another solver"
            }
            Outcome::Cycling => {
                "the active set did not settle, and no later method found a solution"
            }
            Outcome::Stalled => {
                "rounding, or the tolerance of the solver, keeps the certificate above its limit; where the row is in f32 use f64, of a penalty method a smaller penalty, of a solver with a tolerance a tighter one"
            }
            Outcome::NotASolution => {
                "the values do not satisfy the inequality to the limits of the certificate"
            }
            Outcome::Unsuitable => {
                "the solver does not take this matrix: monotone multigrid needs a symmetric one, the proximal method all of it in one process; use the active set method"
            }
            Outcome::NotCoercive => {
                "the matrix is not positive definite: a penalty is too small, or a reaction too negative"
            }
            Outcome::Singular => {
                "the matrix is singular to working precision on the inactive unknowns"
            }
            Outcome::NoSolution => {
                "no solution: the load pulls a body, which only its bounds or friction hold, away from them"
            }
            Outcome::NotUnique => {
                "the load on a body that only its bounds or friction hold is balanced; the values are one of the solutions, which differ there by a constant"
            }
            Outcome::NotFinite => "a number of the data or of an iterate is not finite",
            Outcome::OutOfRange => {
                "the data are so small or so large that their squares underflow or overflow; scale them"
            }
            Outcome::Infeasible => {
                "the lower bound of an unknown exceeds its upper bound: no function is admissible"
            }
            Outcome::Malformed => {
                "sizes of matrix, load, bounds and locations do not match, an entry of the matrix is out of place, or a matrix declared symmetric is not"
            }
            Outcome::OutOfMemory => "the factors of the matrix do not fit into memory",
            Outcome::TimeLimit => "not run: the next coarser level took longer than the limit",
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
