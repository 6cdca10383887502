//! One row of a report: plain numbers, one for every scene, scheme and level.

use super::Certificate;

/// Errors against the exact solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Errors {
    /// L2 norm.
    pub l2: Option<f64>,
    /// Broken H1 seminorm.
    pub h1: Option<f64>,
    /// The scheme's own norm, penalty included.
    pub energy: Option<f64>,
    /// Maximum over nodes.
    pub max: Option<f64>,
}

/// Distances of multiplier and contact set from the exact ones, comparable across schemes; see
/// [`Discretisation::contact_errors`](crate::assemble::Discretisation::contact_errors).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct ContactErrors {
    /// Error of the multiplier as a density at vertices, in L1.
    pub multiplier_l1: Option<f64>,
    /// The same in the lumped L2 norm.
    pub multiplier_l2: Option<f64>,
    /// Measure of the symmetric difference of the contact sets.
    pub contact_area_error: Option<f64>,
    /// Hausdorff distance of the free boundaries.
    pub free_boundary_distance: Option<f64>,
}

/// Observed orders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Orders {
    /// Of the error in the L2 norm.
    pub l2: Option<f64>,
    /// In the broken H1 seminorm.
    pub h1: Option<f64>,
    /// In the scheme's own norm.
    pub energy: Option<f64>,
    /// In the maximum over nodes.
    pub max: Option<f64>,
    /// Of the multiplier in L1.
    pub multiplier_l1: Option<f64>,
    /// Of the multiplier in L2.
    pub multiplier_l2: Option<f64>,
}

/// Orders that theory promises.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct ExpectedOrders {
    /// In L2.
    pub l2: Option<f64>,
    /// In the broken H1 seminorm.
    pub h1: Option<f64>,
}

/// Penalty factors in force.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct PenaltyParameters {
    /// Interior penalty factor.
    pub sigma: Option<f64>,
    /// WOPSIP factor.
    pub eta: Option<f64>,
    /// The rule that turns the factor into a weight.
    pub rule: Option<String>,
}

/// Iteration counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Iterations {
    /// Active sets tried on this level; none where there was nothing to iterate with.
    pub outer: Option<usize>,
    /// Inner iterations on this level, zero for direct solvers.
    pub linear: usize,
    /// How many coarser levels the start came from.
    pub levels: usize,
}

/// Wall times in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Seconds {
    /// Making the mesh.
    pub mesh: f64,
    /// Assembly of matrix, load and bounds.
    pub assemble: f64,
    /// Solve, with whatever the start from coarser levels cost.
    pub solve: f64,
    /// The sum.
    pub total: f64,
}

/// One row of a report. Keys are binding for scripts; a number that does not apply is null.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Dimension of space.
    pub dimension: usize,
    /// Name of the scheme.
    pub scheme: String,
    /// Where the inequality is imposed: `vertices`, `facet-means`, `nodes`, `midpoints` or
    /// `cell-means`.
    pub constraint: String,
    /// Subdivisions of the shortest side, or number of refinements of a mesh file.
    pub level: usize,
    /// Penalty factors in force.
    pub parameters: PenaltyParameters,
    /// Name of the solver of the inequality.
    pub solver: String,
    /// Linear solver inside it.
    pub linear: String,
    /// Number of cells.
    pub cells: usize,
    /// Number of unknowns before Dirichlet values are eliminated.
    pub unknowns: usize,
    /// Entries stored in the matrix of all unknowns.
    pub nonzeros: usize,
    /// Largest cell diameter.
    pub mesh_size: f64,
    /// `converged`, or the typed reason.
    pub status: String,
    /// Errors against the exact solution.
    pub error: Errors,
    /// Distances of multiplier and contact set, keys of the row itself.
    #[cfg_attr(feature = "report", serde(flatten))]
    pub contact: ContactErrors,
    /// Observed order against the previous level of the same scene and scheme.
    pub order: Orders,
    /// What theory promises.
    pub expected_order: ExpectedOrders,
    /// `a(u,u)/2 - l(u)`; null for non-symmetric schemes.
    pub objective: Option<f64>,
    /// Constrained unknowns in contact, Dirichlet ones not counted; none where there is no iterate.
    pub active: Option<usize>,
    /// Iteration counts.
    pub iterations: Iterations,
    /// The certificate.
    pub certificate: Certificate,
    /// Wall times.
    pub seconds: Seconds,
    /// Largest resident set of the process so far, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Warnings by type, as text: a penalty below its proven bound, say.
    pub warnings: Vec<String>,
}
