//! The settings of the active set method.

use crate::linear::LinearMethod;

/// The primal-dual active set method, which is a semismooth Newton method (Hintermueller, Ito,
/// Kunisch, SIAM J. Optim. 13 (2002) 865-888).
///
/// Every step sets the active unknowns to their bounds and the fixed ones to their Dirichlet values,
/// solves the linear system on the inactive unknowns, and predicts a new active set: an active unknown
/// whose multiplier has the wrong sign becomes inactive, an inactive unknown that violates a bound
/// becomes active. Under a penalty on jumps of means the unknowns of a cell change their states together.
/// For M-matrices the method ends in the solution after finitely many steps. For other
/// matrices it may cycle or stagnate: other methods follow, described with the documentation of solvers, and in the end
/// an interior point method, which provides a new start. If none of them finds a solution, the outcome says why.
///
/// No difference within rounding changes a state, because ties would otherwise cycle. There are two tolerances, both
/// proportional to sixteen times machine epsilon:
///
/// * A bound counts as violated if the violation exceeds this product times the largest absolute
///   value of all unknowns, or of the admissible values nearest to them. An unknown wrongly left inactive changes the solution by its violation
///   at most, so that a global scale is safe.
/// * The sign of a multiplier counts as wrong if its size exceeds this product times the sum of the absolute values of
///   the terms of its residual (machine epsilon of the scalar for terms of inactive unknowns, of `f64` for terms of
///   fixed and active unknowns). On fine meshes each multiplier is proportional to the small volume of a patch, so that
///   all of them would be below a tolerance with a global scale.
///
/// The two tolerances are those of all linear solvers. The solution of a Krylov method is accepted if all violations
/// are within the tolerance of the linear systems, a tenth of the limit of the certificate, and in `f64` a hundredth
/// for broken quadratics in the plane and in space: unknowns whose gap or multiplier is below that tolerance may have
/// another state than with factors.
///
/// A cold start begins with the solution without inequalities. On a body that bounds alone hold (the kernel of the
/// inequality is known) a start without an active unknown makes all bounds of that body active.
///
/// The solve begins with the check that the matrix, or its symmetric part, has no negative direction on the unknowns that
/// are not fixed, unless this is known ([`Inequality::is_definite`](crate::algebra::Inequality::is_definite)).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ActiveSet {
    /// Largest number of linear systems with a new active set, those of the interior point method included;
    /// cycles of monotone multigrid do not count.
    pub max_outer: usize,
    /// The method for the linear systems.
    pub linear: LinearMethod,
}

impl Default for ActiveSet {
    fn default() -> Self {
        Self { max_outer: 200, linear: LinearMethod::default() }
    }
}

/// Setters, one for each field.
impl ActiveSet {
    /// Sets the largest number of linear systems with a new active set.
    #[must_use]
    pub fn max_outer(mut self, max_outer: usize) -> Self {
        self.max_outer = max_outer;
        self
    }
    /// Sets the method for the linear systems.
    #[must_use]
    pub fn linear(mut self, linear: LinearMethod) -> Self {
        self.linear = linear;
        self
    }
}
