//! The settings of truncated nonsmooth Newton multigrid.

/// The truncated nonsmooth Newton multigrid method (Graeser, Kornhuber, J. Comput. Math. 27 (2009)
/// 1-44; Graeser, Sack, Sander, Domain Decomposition Methods XVIII (2009) 129-136) for matrices
/// that are symmetric and positive definite.
///
/// One cycle consists of sweeps of projected Gauss-Seidel, a V-cycle for a correction of the inactive unknowns, and an
/// exact line search along the correction projected onto the bounds. In exact arithmetic the energy never rises, and
/// the method converges from any start because the sweeps alone do (Glowinski 1984). Coarse functions are truncated at
/// the active unknowns. Neither sweeps nor corrections depend on strict complementarity, and from a close start the
/// number of cycles hardly depends on the mesh.
///
/// The V-cycle is the preconditioner of [`BuiltInPreconditioners`](crate::linear::BuiltInPreconditioners) for the
/// coarse spaces of the [`InitialGuess`](crate::inequality::InitialGuess); without coarse spaces it is constructed from
/// the matrix by aggregation, which suits conforming P1 only. The method converges slowly for other matrices without
/// coarse spaces, and for over-penalty with bounds at vertices: if a large penalty couples means of several unknowns, a
/// sweep hardly changes any single unknown. Matrices that are not symmetric
/// have the outcome [`Outcome::Unsuitable`](crate::inequality::Outcome::Unsuitable); those of one part of a mesh are
/// solved by [`ActiveSet`](crate::inequality::ActiveSet).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MonotoneMultigrid {
    /// Largest number of cycles.
    pub max_cycles: usize,
    /// Number of consecutive cycles that may leave the change of a cycle above half of its least value; the method ends
    /// at the next such cycle.
    pub stagnation_cycles: usize,
}

impl Default for MonotoneMultigrid {
    fn default() -> Self {
        Self { max_cycles: 200, stagnation_cycles: 200 }
    }
}

/// Setters, one for each field.
impl MonotoneMultigrid {
    /// Sets the largest number of cycles.
    #[must_use]
    pub fn max_cycles(mut self, max_cycles: usize) -> Self {
        self.max_cycles = max_cycles;
        self
    }
    /// Sets the number of cycles that may pass without halving the change of a cycle.
    #[must_use]
    pub fn stagnation_cycles(mut self, stagnation_cycles: usize) -> Self {
        self.stagnation_cycles = stagnation_cycles;
        self
    }
}
