//! Norms of the error, and the bound beside them.

/// A norm in which errors are measured, or the bound in place of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum ErrorNorm {
    /// The L2 norm.
    L2,
    /// The broken H1 seminorm.
    H1,
    /// The broken energy norm, the same for all schemes: `broken_energy` of
    /// [`Errors`](super::Errors).
    Energy,
    /// The bound on the error in the broken energy norm, known without the solution: `discrete` of
    /// [`ErrorBound`](crate::error_bound::ErrorBound).
    Bound,
}

impl ErrorNorm {
    /// All norms, and the bound last.
    pub const ALL: [Self; 4] = [Self::L2, Self::H1, Self::Energy, Self::Bound];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::L2 => "L2",
            Self::H1 => "H1",
            Self::Energy => "energy",
            Self::Bound => "bound",
        }
    }
}

impl std::fmt::Display for ErrorNorm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
