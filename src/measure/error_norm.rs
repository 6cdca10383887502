//! Norms of the error.

/// A norm in which errors are measured.
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
}

impl ErrorNorm {
    /// All norms.
    pub const ALL: [Self; 3] = [Self::L2, Self::H1, Self::Energy];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::L2 => "L2",
            Self::H1 => "H1",
            Self::Energy => "energy",
        }
    }
}

impl std::fmt::Display for ErrorNorm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
