//! Which linear solver works inside a solver of the inequality.

/// Which linear solver works inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearMethod {
    /// Sparse factors, exact to rounding.
    Direct,
    /// Conjugate gradients with multigrid on conforming linear functions; for matrices that are not
    /// symmetric minimal residuals with the same for their symmetric part
    /// ([`Outcome::NotCoercive`](crate::inequality::Outcome::NotCoercive) if it is not positive definite).
    Iterative,
    /// Whichever is faster: iterative above a size measured, if nested meshes are known.
    #[default]
    BySize,
}

impl LinearMethod {
    /// All of them by the names users type.
    pub const NAMES: [(&'static str, LinearMethod); 3] = [
        ("direct", LinearMethod::Direct),
        ("iterative", LinearMethod::Iterative),
        ("by-size", LinearMethod::BySize),
    ];
}
