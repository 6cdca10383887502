//! Rows of a report: the figures of one scene, scheme and level each.

use std::collections::BTreeMap;

use super::part_figures::PartFigures;
use crate::error::Error;
use crate::error_bound::BoundFigures;
use crate::facet::PenaltyParameters;
use crate::inequality::{Certificate, Outcome, StageRun};
use crate::measure::{ContactErrors, Errors, Rounding};
use crate::scheme::ExpectedOrders;

/// Observed orders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Orders {
    /// Of the error in the L2 norm.
    pub l2: Option<f64>,
    /// In the broken H1 seminorm.
    pub h1: Option<f64>,
    /// In the scheme's own norm.
    pub energy: Option<f64>,
    /// In the maximum over nodes.
    pub max: Option<f64>,
    /// Of the error bound.
    pub bound: Option<f64>,
    /// Of the multiplier in L1.
    pub multiplier_l1: Option<f64>,
    /// Of the multiplier in L2.
    pub multiplier_l2: Option<f64>,
}

/// Iteration counts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Iterations {
    /// Number of active sets on this level; none without an iterate.
    pub outer: Option<usize>,
    /// Inner iterations on this level, zero for direct solvers.
    pub linear: usize,
    /// Number of coarser levels of the initial guess.
    pub levels: usize,
    /// Linear systems solved on this level ([`Solution::systems`](crate::inequality::Solution::systems)); none without an
    /// iterate, and where the solver does not say.
    pub systems: Option<usize>,
    /// Cycles of monotone multigrid for the initial guess on a large mesh without coarser ones.
    pub start_cycles: usize,
    /// The stages of the solver that ran on this level, in their order.
    pub stages: Vec<StageRun>,
}

/// Wall times in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Seconds {
    /// Making the mesh.
    pub mesh: f64,
    /// Assembly of matrix, load and bounds.
    pub assemble: f64,
    /// Solve, with the start from coarser levels.
    pub solve: f64,
    /// The part of the solve that was the start: conforming P1 on coarser levels and, for other schemes, on this
    /// one. None on adaptive meshes.
    pub start: Option<f64>,
    /// The error bound. On adaptive meshes with marking and a part of the sum, on uniform ones beside it; none
    /// where there is no bound.
    pub bound: Option<f64>,
    /// The sum.
    pub total: f64,
}

impl Seconds {
    /// Times of mesh, assembly and solve, with their sum.
    #[must_use]
    pub fn new(mesh: f64, assemble: f64, solve: f64) -> Self {
        Self { mesh, assemble, solve, start: None, bound: None, total: mesh + assemble + solve }
    }
}

/// The key of a row, by which the rows of a report differ.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RowKey {
    /// Name of the scene.
    pub scene: String,
    /// Scheme, constraint set and choices.
    pub label: String,
    /// Name of the solver.
    pub solver: String,
    /// Subdivisions, or number of refinements.
    pub level: usize,
}

/// One row of a report. Keys are binding for scripts; a number that does not apply is null.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Dimension of space.
    pub dimension: usize,
    /// The constants of the file of the problem, by name; rows of problems without constants do not have the key.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub constants: BTreeMap<String, f64>,
    /// Name of the scheme.
    pub scheme: String,
    /// Where the inequality is imposed: `vertices`, `facet-means`, `nodes`, `midpoints`,
    /// `bernstein`, or the name of a constraint set of one's own.
    pub constraint: String,
    /// Scheme, constraint set and choices without what is default, as
    /// [`NamedScheme`](crate::scheme::NamedScheme) reads it: what distinguishes the schemes of a report.
    pub label: String,
    /// Subdivisions of the shortest side, or number of refinements of a mesh file or of adaptive refinement.
    pub level: usize,
    /// The unit of levels: `subdivisions`, `refinements`, or `steps` of adaptive refinement.
    pub level_kind: Option<String>,
    /// Share of the error bound that each adaptive refinement marks; null for uniform meshes. Times of
    /// such a row are those of all its steps so far.
    pub theta: Option<f64>,
    /// Penalty factors in force.
    pub parameters: PenaltyParameters,
    /// Name of the solver of the inequality.
    pub solver: String,
    /// Linear solver inside it.
    pub linear: String,
    /// Number of cells.
    pub cells: usize,
    /// Number of unknowns before Dirichlet values are eliminated; none if the data ended the assembly
    /// before.
    pub unknowns: Option<usize>,
    /// Entries stored in the matrix of all unknowns; none where none was assembled.
    pub nonzeros: Option<usize>,
    /// Largest cell diameter.
    #[cfg_attr(feature = "report", serde(deserialize_with = "crate::input::number_or_nan"))]
    pub mesh_size: f64,
    /// How the solve ended; its name in files.
    pub status: Outcome,
    /// The status in one sentence; none if the solve converged.
    pub message: Option<String>,
    /// Against what the errors are: `exact`, or scheme and level of a reference; none without errors.
    pub against: Option<String>,
    /// Errors against the exact solution, or against a reference.
    pub error: Errors,
    /// Distances of multiplier and contact set, keys of the row itself.
    #[cfg_attr(feature = "report", serde(flatten))]
    pub contact: ContactErrors,
    /// Rounding errors in the figures of the row: figures that are no larger have no orders.
    pub rounding: Option<Rounding>,
    /// Observed order against the previous level of the same scene and label; none where an error is rounding.
    pub order: Orders,
    /// Orders that theory promises.
    pub expected_order: ExpectedOrders,
    /// `a(u,u)/2 - l(u)` with all terms of the scheme, which no other scheme has; null for non-symmetric
    /// schemes.
    pub objective: Option<f64>,
    /// The energy by one formula for every scheme: [`Discretisation::energy`](crate::assemble::Discretisation::energy).
    pub energy: Option<f64>,
    /// A bound on the error from the solution and the data alone; old reports have none.
    #[cfg_attr(feature = "report", serde(default))]
    pub bound: BoundFigures,
    /// Constrained unknowns in contact, Dirichlet ones not counted; none where there is no iterate.
    pub active: Option<usize>,
    /// Measure of the contact set: a volume with obstacles, else an area of the boundary; null without an
    /// inequality.
    pub contact_measure: Option<f64>,
    /// Total contact force, positive where a lower bound pushes upward; null without an inequality.
    pub resultant: Option<f64>,
    /// The same for each obstacle (`lower`, `upper`) and each contact group by its name.
    pub resultants: Option<BTreeMap<String, f64>>,
    /// How far the solution lies beyond an obstacle or a gap, the largest value over cells and contact facets, negative
    /// where it reaches none: [`Discretisation::penetration`](crate::assemble::Discretisation::penetration). Null
    /// without an inequality.
    pub penetration: Option<f64>,
    /// The values by name that the problem asks for; rows of problems that ask for none do not have the key.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub values: BTreeMap<String, Option<f64>>,
    /// Where the solution has largest and smallest values, by name; rows without such values do not have the key.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub values_at: BTreeMap<String, Vec<f64>>,
    /// The share of the error bound at which the solve might end; rows of solves to rounding do not have the key.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "Option::is_none"))]
    pub tolerance: Option<f64>,
    /// Iteration counts.
    pub iterations: Iterations,
    /// The certificate.
    pub certificate: Certificate,
    /// Wall times; of several runs those of the fastest.
    pub seconds: Seconds,
    /// The total seconds of all runs, ascending, where the case ran in several rounds; other rows do not have the key.
    #[cfg_attr(feature = "report", serde(skip_serializing_if = "Option::is_none"))]
    pub runs: Option<Vec<f64>>,
    /// After every outer step of one more solve, on this level alone: linear systems so far, seconds so far, and the
    /// largest part of the certificate, null where it is not finite. In reports that ask for it; other rows do not have
    /// the key.
    #[cfg_attr(feature = "report", serde(skip_serializing_if = "Option::is_none"))]
    pub history: Option<Vec<(usize, f64, Option<f64>)>>,
    /// Largest resident set of the process so far, if the system reports it.
    pub peak_memory_bytes: Option<u64>,
    /// Warnings by type, as text: a penalty below its proven bound, say.
    pub warnings: Vec<String>,
    /// Figures of a run over several processes; rows of a run in one do not have the key.
    #[cfg_attr(feature = "report", serde(skip_serializing_if = "Option::is_none"))]
    pub ranks: Option<PartFigures>,
}

impl Row {
    /// A row without numbers, for a caller that fills them in; the label is the name of the scheme.
    #[must_use]
    pub fn new(scene: &str, dimension: usize, scheme: &str, level: usize, status: Outcome) -> Self {
        Self {
            scene: scene.to_owned(),
            dimension,
            constants: BTreeMap::new(),
            scheme: scheme.to_owned(),
            constraint: String::new(),
            label: scheme.to_owned(),
            level,
            level_kind: None,
            theta: None,
            parameters: PenaltyParameters::default(),
            solver: String::new(),
            linear: String::new(),
            cells: 0,
            unknowns: None,
            nonzeros: None,
            mesh_size: f64::NAN,
            status,
            message: (status != Outcome::Converged).then(|| status.message().to_owned()),
            against: None,
            error: Errors::default(),
            contact: ContactErrors::default(),
            rounding: None,
            order: Orders::default(),
            expected_order: ExpectedOrders::default(),
            objective: None,
            energy: None,
            bound: BoundFigures::default(),
            active: None,
            contact_measure: None,
            resultant: None,
            resultants: None,
            penetration: None,
            values: BTreeMap::new(),
            values_at: BTreeMap::new(),
            tolerance: None,
            iterations: Iterations::default(),
            certificate: Certificate::INVALID,
            seconds: Seconds::default(),
            runs: None,
            history: None,
            peak_memory_bytes: None,
            warnings: Vec::new(),
            ranks: None,
        }
    }

    /// The row with the outcome that an error of the data stands for, and the message of the error.
    ///
    /// # Errors
    /// The error itself if another run, with the same data on another mesh, would have it too.
    pub(super) fn with_error(mut self, error: Error) -> Result<Self, Error> {
        let Some(outcome) = Outcome::of_error(&error) else { return Err(error) };
        self.status = outcome;
        self.message = Some(error.to_string());
        Ok(self)
    }

    /// The key by which the row differs from the others of its report.
    pub fn key(&self) -> RowKey {
        let [scene, label, solver] = [&self.scene, &self.label, &self.solver].map(String::clone);
        RowKey { scene, label, solver, level: self.level }
    }

    /// The size in which orders are: the mesh size; on adaptive meshes the power `-1/D` of the number of
    /// unknowns, so that an order is `-D` times the slope in unknowns.
    pub(crate) fn size(&self) -> f64 {
        match (self.theta, self.unknowns) {
            (Some(_), Some(unknowns)) => (unknowns as f64).powf(-1.0 / self.dimension as f64),
            _ => self.mesh_size,
        }
    }
    /// The seconds of the row with those of its bound, which on adaptive meshes are a part of them.
    #[cfg(feature = "report")]
    pub(crate) fn seconds_with_bound(&self) -> f64 {
        let beside = self.seconds.bound.filter(|_| self.theta.is_none());
        self.seconds.total + beside.unwrap_or(0.0)
    }
    /// The errors of the row that are more than rounding, each under the name of its order.
    pub(crate) fn errors_above_rounding(&self) -> Orders {
        let Self { error, contact, bound, rounding, .. } = self;
        let of = rounding.as_ref().map_or_else(Errors::default, |rounding| rounding.error.clone());
        let force = rounding.as_ref().map(|rounding| rounding.force);
        let above = |error: Option<f64>, rounding: Option<f64>| {
            error.filter(|error| rounding.is_none_or(|rounding| *error > rounding))
        };
        // where the space contains the solution all errors are rounding, whatever their size
        let is_exact =
            error.broken_energy.is_some() && above(error.broken_energy, of.broken_energy).is_none();
        let errors = if is_exact { &Errors::default() } else { error };
        // of a function and of a flux
        let of_bound = of.broken_energy.map(|rounding| 2.0 * rounding);
        let multiplier_l1 = above(contact.multiplier_l1, force);
        Orders {
            l2: above(errors.l2, of.l2),
            h1: above(errors.h1, of.h1),
            energy: above(errors.energy, of.energy),
            max: above(errors.max, of.max),
            bound: above(bound.discrete, of_bound),
            multiplier_l1,
            multiplier_l2: contact.multiplier_l2.filter(|_| multiplier_l1.is_some()),
        }
    }
    /// The reference against which the errors are; none where they are against the exact solution.
    pub fn reference(&self) -> Option<&str> {
        self.against.as_deref().filter(|against| *against != "exact")
    }
    /// Whether the solve of this row converged.
    pub fn converged(&self) -> bool {
        self.status == Outcome::Converged
    }
}

/// Each item once, in order of first occurrence.
pub(crate) fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut once = Vec::new();
    for item in items {
        if !once.contains(&item) {
            once.push(item);
        }
    }
    once
}
