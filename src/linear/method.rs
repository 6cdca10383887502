//! The choice between direct and iterative linear solvers.

/// The linear solver inside a solver of the inequality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinearMethod {
    /// Sparse Cholesky or LU factors.
    Direct,
    /// Conjugate gradients for symmetric matrices, GMRES for others, with a preconditioner for the
    /// symmetric part. The outcome is
    /// [`Outcome::NotCoercive`](crate::inequality::Outcome::NotCoercive) if that part is not positive
    /// definite.
    Iterative,
    /// [`LinearMethod::Iterative`] for at least 10 000 unknowns if coarse spaces are known, else
    /// [`LinearMethod::Direct`].
    #[default]
    BySize,
}

impl LinearMethod {
    /// The methods with the names that users type.
    pub const NAMES: [(&'static str, LinearMethod); 3] = [
        ("direct", LinearMethod::Direct),
        ("iterative", LinearMethod::Iterative),
        ("by-size", LinearMethod::BySize),
    ];
}
