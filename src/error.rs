//! Errors of input data, of files and of parameters.
//!
//! A numerical outcome (iteration limit, cycling) is not an error: see [`crate::inequality::Outcome`].
//!
//! A function that returns a [`Result`] returns an error for bad input. Another one panics, as its documentation or that
//! of its type says: for the number of a cell that the mesh does not have, say.

use std::fmt::Display;

use crate::mesh::gmsh::GmshError;
use crate::mesh::{MeshError, describe_point};
use crate::quadrature::QuadratureError;
use crate::readable_debug::debug_by_display;
use crate::real::Point;

/// An error of input data, of a file or of a parameter. The message says what is wrong, where, and
/// what to do; `Debug` prints the message and its causes.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh does not carry a finite element space.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A mesh file could not be read.
    #[error(transparent)]
    Gmsh(#[from] GmshError),
    /// A family of quadrature rules has no rule that is needed.
    #[error(transparent)]
    Quadrature(#[from] QuadratureError),
    /// A datum is not a finite number at a point where it is evaluated.
    #[error("{0}")]
    DataNotFinite(InCell),
    /// A diffusion coefficient is not positive, or the coefficient of a Robin side is negative.
    #[error("{0}")]
    CoefficientNotPositive(InCell),
    /// Two constraints leave no admissible value.
    #[error(
        "no admissible value in cell {cell} near {at}: the {}, {lower}, exceeds the {}, {upper}", of[0], of[1]
    )]
    EmptyConstraint {
        /// A cell of the unknown.
        cell: u64,
        /// A point of the location of the unknown, as coordinates in parentheses.
        at: String,
        /// The larger lower bound.
        lower: f64,
        /// The smaller upper bound.
        upper: f64,
        /// What the two are: "lower obstacle", "gap", "Dirichlet value on `wall`".
        of: Box<[String; 2]>,
    },
    /// No unknown of the constraint set can carry the bounds of an inequality.
    #[error("{0}")]
    NothingToBound(String),
    /// A facet form asks for what the assembler does not make for the element.
    #[error("{0}")]
    UnsupportedForm(String),
    /// The problem has data for a region or boundary group that the mesh does not have.
    #[error("{0}")]
    UnknownGroup(String),
    /// A datum is given twice for one name, or twice without a name.
    #[error("{0}")]
    GivenTwice(String),
    /// The data of a boundary group are of another kind than its facets.
    #[error("{0}")]
    UnboundBoundary(String),
    /// Meshes are to follow an error bound that the scheme does not have.
    #[error("{0}")]
    NotAdaptive(String),
    /// Mesh and scene disagree.
    #[error("{0}")]
    UnfitMesh(String),
    /// Two solutions are compared whose meshes do not belong to one hierarchy.
    #[error(
        "solutions are compared on one mesh or on meshes of one hierarchy: solve both on the same `Hierarchy`"
    )]
    NotNested,
    /// What one of the processes that share a mesh found, or why they do not reach one another: an
    /// [`ExchangeError`](crate::processes::ExchangeError).
    #[error(transparent)]
    Processes(Box<dyn std::error::Error + Send + Sync>),
    /// A parameter outside its range: "parameter = value: what is allowed".
    #[error("{0}")]
    Parameter(String),
    /// A run would need more memory than the process has and the machine has left.
    #[error("{0}")]
    NotEnoughMemory(String),
    /// Two schemes or two solvers of a study have one name, and so have their rows and files.
    #[error("{0}")]
    EqualNames(String),
    /// A file could not be written.
    #[error("cannot write {path}: {why}")]
    Write {
        /// The file.
        path: String,
        /// The cause: an [`std::io::Error`] where the operating system refuses, otherwise the message
        /// of the encoder.
        #[source]
        why: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A file could not be read.
    #[error("cannot read {path}: {why}")]
    Read {
        /// The file.
        path: String,
        /// The cause: an [`std::io::Error`] where the operating system refuses, otherwise what the
        /// parser says.
        #[source]
        why: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A report is taken up by a run that asks for something else.
    #[error("{0}")]
    OtherRequest(String),
}

debug_by_display!(Error);

/// A sentence about a cell: what is wrong, " in cell ", the number, and the rest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{wrong} in cell {cell}: {rest}")]
pub struct InCell {
    /// The cell.
    pub cell: u64,
    wrong: String,
    rest: &'static str,
}

impl InCell {
    /// A value of a datum that is not allowed, at a point of a cell.
    pub(crate) fn value<const D: usize>(
        (datum, value): (&str, impl Display),
        at: &Point<D>,
        cell: usize,
        rest: &'static str,
    ) -> Self {
        let wrong = format!("{datum} is {value} at {}", describe_point(at));
        Self { cell: cell as u64, wrong, rest }
    }
}

impl Error {
    /// A parameter outside its range.
    pub(crate) fn parameter(parameter: &str, value: impl Display, allowed: impl Display) -> Self {
        Self::Parameter(format!("{parameter} = {value}: {allowed}"))
    }
    /// Two items of a study have one name, for schemes the label with constraint set and choices; `by` names one of
    /// one's own.
    pub(crate) fn equal_names(items: &str, name: &str, by: &str) -> Self {
        Self::EqualNames(format!(
            "two {items} of the study are named {name:?}, and nothing would tell their rows apart: name each once, and give one of your own another name by {by}"
        ))
    }
    /// Two schemes of a study have one label.
    pub(crate) fn equal_schemes(label: &str) -> Self {
        Self::equal_names("schemes", label, "`Scheme::name` or `Scheme::choices`")
    }
    /// The mesh does not fit a scene: what does not fit, where, and what to do.
    pub(crate) fn unfit_mesh(scene: &str, why: impl Display) -> Self {
        Self::UnfitMesh(format!("the mesh does not fit {scene}: {why}"))
    }
    /// The error with the number of its cell in the whole mesh, given those of the cells of a
    /// [part](crate::mesh::Part::cells), on which it was found.
    #[must_use]
    pub fn in_whole_mesh(mut self, cells: &[u64]) -> Self {
        if let Self::DataNotFinite(InCell { cell, .. })
        | Self::CoefficientNotPositive(InCell { cell, .. })
        | Self::EmptyConstraint { cell, .. } = &mut self
            && let Some(&of_whole) = cells.get(*cell as usize)
        {
            *cell = of_whole;
        }
        self
    }
}

/// The error of a file that could not be written: from an [`std::io::Error`] or from a message.
#[cfg(feature = "report")]
pub(crate) fn write_error(
    path: &std::path::Path,
    why: impl Into<Box<dyn std::error::Error + Send + Sync>>,
) -> Error {
    Error::Write { path: path.display().to_string(), why: why.into() }
}

/// The error of a file that could not be read: from an [`std::io::Error`] or from a parser.
#[cfg(feature = "report")]
pub(crate) fn read_error(
    path: &std::path::Path,
    why: impl Into<Box<dyn std::error::Error + Send + Sync>>,
) -> Error {
    Error::Read { path: path.display().to_string(), why: why.into() }
}
