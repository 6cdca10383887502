//! The settings of the active set method.

use crate::linear::LinearMethod;

/// The primal-dual active set method, which is a semismooth Newton method (Hintermueller, Ito,
/// Kunisch, SIAM J. Optim. 13 (2002) 865-888).
///
/// Every step sets the active unknowns to their bounds and the fixed ones to their Dirichlet values,
/// solves the linear system on the inactive unknowns, and predicts a new active set: an active unknown
/// whose multiplier has the wrong sign becomes inactive, an inactive unknown that violates a bound
/// becomes active. For M-matrices the method ends in the solution after finitely many steps. For other
/// matrices it may cycle or stagnate:
///
/// * An active set that occurs again, a number of state changes that has not halved within `stagnation_steps` steps, or
///   `improvement_steps` steps without a better iterate, lead to the next stage, in the end to the interior point
///   method, which provides a new start ([`Globalisation`]).
/// * If no stage is left, the outcome is [`Outcome::Cycling`](super::super::Outcome::Cycling).
///
/// No difference within rounding changes a state, because ties would otherwise cycle. There are two tolerances, both
/// proportional to `rounding_band` times machine epsilon:
///
/// * A bound counts as violated if the violation exceeds this product times the largest absolute
///   value of all unknowns. An unknown wrongly left inactive changes the solution by its violation
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
/// A cold start begins with the solution without inequalities, or, if the matrix is singular on the free unknowns
/// because only the bounds prevent a rigid motion, with every bound active.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ActiveSet {
    /// Largest number of linear systems with a new active set.
    pub max_outer: usize,
    /// The multiple of machine epsilon within which no unknown changes its state.
    pub rounding_band: f64,
    /// Number of corrections of each linear solution by its residual in `f64`. Every step of the active set method is
    /// itself a correction of the preceding iterate; one more correction gains two digits and more in `f32` if a single
    /// step suffices (a warm start).
    pub refinements: usize,
    /// Number of linear systems within which the number of state changes must halve; otherwise the
    /// active set stagnates and the interior point method provides a new start.
    pub stagnation_steps: usize,
    /// Number of linear systems within which the best iterate must improve; otherwise the next stage follows. The last
    /// stage ends after this number if the best iterate is a solution.
    pub improvement_steps: usize,
    /// The use of the interior point method after an active set that stagnates or cycles.
    pub globalisation: Globalisation,
    /// Whether factors check first that the matrix, or its symmetric part if it is not symmetric, is positive definite
    /// on all unknowns that are not fixed, unless this is known
    /// ([`Inequality::is_definite`](crate::algebra::Inequality::is_definite)). Without the check an indefinite matrix
    /// may remain undetected. A symmetric matrix is always checked if the start has contact states and, without
    /// additional cost, if a cold start uses factors.
    pub check_definite: bool,
    /// The method for the linear systems.
    pub linear: LinearMethod,
}

/// The use of the interior point method (Mehrotra, SIAM J. Optim. 2 (1992) 575-601), which provides
/// starting active sets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Globalisation {
    /// No use: the active set method alone determines the outcome.
    Never,
    /// After an active set that stagnates or cycles.
    #[default]
    OnStagnation,
    /// For the first active set as well.
    InteriorPointFirst,
}

impl Default for ActiveSet {
    fn default() -> Self {
        Self {
            max_outer: 200,
            rounding_band: 16.0,
            refinements: 1,
            stagnation_steps: 3,
            improvement_steps: 20,
            globalisation: Globalisation::default(),
            check_definite: false,
            linear: LinearMethod::default(),
        }
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
    /// Sets the multiple of machine epsilon within which no unknown changes its state.
    #[must_use]
    pub fn rounding_band(mut self, rounding_band: f64) -> Self {
        self.rounding_band = rounding_band;
        self
    }
    /// Sets the number of corrections of each linear solution by its residual.
    #[must_use]
    pub fn refinements(mut self, refinements: usize) -> Self {
        self.refinements = refinements;
        self
    }
    /// Sets the number of linear systems within which the number of state changes must halve.
    #[must_use]
    pub fn stagnation_steps(mut self, stagnation_steps: usize) -> Self {
        self.stagnation_steps = stagnation_steps;
        self
    }
    /// Sets the number of linear systems within which the best iterate must improve.
    #[must_use]
    pub fn improvement_steps(mut self, improvement_steps: usize) -> Self {
        self.improvement_steps = improvement_steps;
        self
    }
    /// Sets the use of the interior point method.
    #[must_use]
    pub fn globalisation(mut self, globalisation: Globalisation) -> Self {
        self.globalisation = globalisation;
        self
    }
    /// Sets whether to check first that the matrix is positive definite.
    #[must_use]
    pub fn check_definite(mut self, check_definite: bool) -> Self {
        self.check_definite = check_definite;
        self
    }
    /// Sets the method for the linear systems.
    #[must_use]
    pub fn linear(mut self, linear: LinearMethod) -> Self {
        self.linear = linear;
        self
    }
}
