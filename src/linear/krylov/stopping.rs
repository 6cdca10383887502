//! The stopping rule of a Krylov method, and the result of a run.
//!
//! The norm of a residual `r` is the preconditioned one, `(r . B r)^(1/2)` with the preconditioner `B`.

/// When a Krylov method stops, unless it fails: as soon as one of the three conditions holds. GMRES stops earlier
/// where the observed rate of convergence does not reach the target within the limit of iterations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoppingRule {
    /// The norm of the residual is at most this.
    pub absolute_tolerance: f64,
    /// The norm of the residual is at most this times its initial value.
    pub relative_tolerance: f64,
    /// The number of iterations is this.
    pub max_iterations: usize,
}

impl StoppingRule {
    /// The norm of the residual at which a run with this initial norm stops.
    pub fn target(&self, initial_norm: f64) -> f64 {
        self.absolute_tolerance.max(self.relative_tolerance * initial_norm)
    }
}

/// Why a Krylov method stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StopReason {
    /// The norm of the residual reached the target.
    Converged,
    /// The limit of iterations is reached, or too small for the observed rate of convergence.
    IterationLimit,
    /// The matrix or the preconditioner is not positive definite.
    NotPositive,
    /// A number is not finite.
    NotFinite,
}

/// The result of a run of a Krylov method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KrylovRun {
    pub iterations: usize,
    pub reason: StopReason,
    /// The norm of the residual at the end. Divided by the square root of the smallest eigenvalue
    /// of `B A` (of `B` times the symmetric part of `A`), it bounds the energy norm of the error.
    pub residual_norm: f64,
    /// The smallest and the largest Ritz value of `B A` for conjugate gradients; the smallest and the largest
    /// eigenvalue of the symmetric part of the Hessenberg matrix for GMRES; `None` without an iteration. The
    /// smallest one is at least the smallest eigenvalue of `B` times the symmetric part of `A`; for conjugate
    /// gradients it converges to the smallest eigenvalue to whose eigenvector the initial residual has a component.
    pub ritz: Option<(f64, f64)>,
}

impl KrylovRun {
    /// The run before the first iteration, with a residual of zero until the method computes it.
    pub fn new() -> Self {
        Self { iterations: 0, reason: StopReason::Converged, residual_norm: 0.0, ritz: None }
    }
}
