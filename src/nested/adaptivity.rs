//! The settings of adaptive refinement, and why it ends.

use std::fmt;

use crate::error::Error;

/// How far meshes follow an error bound.
///
/// ```
/// use unilateral::prelude::*;
/// let to_one_percent = Adaptivity::to_bound(1e-2).unknowns(100_000);
/// assert_eq!(to_one_percent.theta, 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Adaptivity {
    /// The share of the square of the bound that the marked cells have, above zero and at most one.
    pub theta: f64,
    /// The bound, absolute and in the energy norm, that ends the refinement.
    pub goal: Option<f64>,
    /// Most refinements.
    pub steps: usize,
    /// Most unknowns; the first mesh may have more.
    pub unknowns: usize,
}

impl Default for Adaptivity {
    /// A share of a half, no goal, at most 20 refinements and a million unknowns.
    fn default() -> Self {
        Self { theta: 0.5, goal: None, steps: 20, unknowns: 1_000_000 }
    }
}

impl Adaptivity {
    /// Refinement until the bound is at most `goal`.
    #[must_use]
    pub fn to_bound(goal: f64) -> Self {
        Self::default().goal(goal)
    }
    /// Sets the bound that ends the refinement.
    #[must_use]
    pub fn goal(self, goal: f64) -> Self {
        Self { goal: Some(goal), ..self }
    }
    /// Sets the share of the marked cells.
    #[must_use]
    pub fn theta(self, theta: f64) -> Self {
        Self { theta, ..self }
    }
    /// Sets the largest number of refinements.
    #[must_use]
    pub fn steps(self, steps: usize) -> Self {
        Self { steps, ..self }
    }
    /// Sets the largest number of unknowns.
    #[must_use]
    pub fn unknowns(self, unknowns: usize) -> Self {
        Self { unknowns, ..self }
    }
    /// Checks share and goal.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        if !(self.theta > 0.0 && self.theta <= 1.0) {
            let allowed = "the share of marked cells is in (0, 1]";
            return Err(Error::parameter("theta", format!("{:?}", self.theta), allowed));
        }
        match self.goal {
            Some(goal) if !(goal > 0.0 && goal.is_finite()) => {
                let allowed = "a bound is positive and finite";
                Err(Error::parameter("goal", format!("{goal:?}"), allowed))
            }
            _ => Ok(()),
        }
    }
}

/// Why no finer mesh follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// The bound is at most the goal.
    Goal,
    /// As many refinements as allowed.
    Steps,
    /// The next mesh would have more unknowns than allowed.
    Unknowns,
    /// No cell has a share of the bound: it is zero, or what the solver left.
    Exact,
    /// The solve did not converge.
    NotConverged,
    /// The solution has no bound.
    NoBound,
    /// Marked cells are at the size of rounding, or more than can be numbered.
    Rounding,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Goal => "the bound is at most the goal",
            Self::Steps => "the number of refinements is the largest allowed",
            Self::Unknowns => "the next mesh has more unknowns than allowed",
            Self::Exact => "no cell has a share of the bound",
            Self::NotConverged => "the solve did not converge",
            Self::NoBound => "there is no bound",
            Self::Rounding => "marked cells are at the size of rounding",
        })
    }
}
