//! Errors of a discrete solution, as plain numbers, and the norms in which they are measured.

use std::collections::BTreeMap;

/// Errors against the exact solution.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Errors {
    /// L2 norm.
    pub l2: Option<f64>,
    /// Broken H1 seminorm.
    pub h1: Option<f64>,
    /// The scheme's own norm, penalty included.
    pub energy: Option<f64>,
    /// The broken energy norm, by one formula for every scheme: the root of the integral of
    /// `alpha |grad e|^2 + c e^2` over the cells.
    pub broken_energy: Option<f64>,
    /// Maximum over nodes.
    pub max: Option<f64>,
    /// Of the values by name that the problem asks for; rows of problems that ask for none do not have the key.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub values: BTreeMap<String, Option<f64>>,
}

impl Errors {
    /// Whether the broken energy norm is the broken H1 seminorm, as without coefficient and reaction.
    #[cfg(feature = "report")]
    pub(crate) fn is_energy_h1(&self) -> bool {
        match (self.h1, self.broken_energy) {
            (Some(h1), Some(energy)) => (h1 - energy).abs() <= 1e-12 * h1,
            (_, energy) => energy.is_none(),
        }
    }
}

/// Distances of multiplier and contact set from the exact ones, comparable across schemes; see
/// [`Discretisation::contact_errors`](crate::assemble::Discretisation::contact_errors).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactErrors {
    /// Error of the multiplier as a density at vertices, in L1.
    pub multiplier_l1: Option<f64>,
    /// Error of the multiplier as a density at vertices, in the lumped L2 norm.
    pub multiplier_l2: Option<f64>,
    /// Measure of the symmetric difference of the contact sets.
    pub contact_area_error: Option<f64>,
    /// Hausdorff distance of the free boundaries.
    pub free_boundary_distance: Option<f64>,
}

/// A norm in which errors are measured, or the bound in place of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum ErrorNorm {
    /// The L2 norm.
    L2,
    /// The broken H1 seminorm.
    H1,
    /// The broken energy norm, the same for all schemes: `broken_energy` of
    /// [`Errors`].
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
