//! Errors of input data, of files and of parameters.
//!
//! A numerical outcome (iteration limit, cycling) is not an error: see [`crate::inequality::Outcome`].
//!
//! A function that returns a [`Result`] returns an error for bad input. Another one panics, as its documentation or that
//! of its type says: for the number of a cell that the mesh does not have, say.

use crate::mesh::MeshError;
use crate::mesh::gmsh::GmshError;
use crate::quadrature::QuadratureError;
use crate::readable_debug::debug_by_display;

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
    #[error("{datum} is {value} at {at} in cell {cell}: data must be finite")]
    DataNotFinite {
        /// Name of the datum: "source", "dirichlet", "obstacle", ...
        datum: &'static str,
        /// The value found.
        value: f64,
        /// The point, as coordinates in parentheses.
        at: String,
        /// The cell in which the point lies.
        cell: u64,
    },
    /// A diffusion coefficient is not positive and finite.
    #[error("coefficient is {value} at {at} in cell {cell}: it must be positive and finite")]
    CoefficientNotPositive {
        /// The value found.
        value: f64,
        /// The point, as coordinates in parentheses.
        at: String,
        /// The cell.
        cell: u64,
    },
    /// Two constraints leave no admissible value.
    #[error(
        "no admissible value in cell {cell} near {at}: the {}, {lower}, exceeds the {}, {upper}", of[0], of[1]
    )]
    EmptyConstraint {
        /// The unknown; on a [part](crate::mesh::Part) its number there.
        unknown: usize,
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
    /// Lower bounds exceed upper ones at a point of the finest mesh of a study.
    #[error(
        "no function is admissible: at {at}, a point of the finest mesh, the lower bound {lower} exceeds the upper bound {upper}"
    )]
    BoundsCross {
        /// The cell.
        cell: u64,
        /// The point, as coordinates in parentheses.
        at: String,
        /// The larger lower bound.
        lower: f64,
        /// The smaller upper bound.
        upper: f64,
    },
    /// No unknown of the constraint set can carry the bounds of an inequality.
    #[error(
        "bounds on {constraint} cannot impose {condition}: the element has no such values; choose {allowed}"
    )]
    NothingToBound {
        /// Name of the constraint set.
        constraint: String,
        /// The inequality: "an inequality" in general, or "a Signorini condition".
        condition: &'static str,
        /// The constraint sets that can impose it on the element.
        allowed: String,
    },
    /// A facet form asks for what the assembler does not make for the element.
    #[error("{requested} are made for {allowed} only")]
    UnsupportedForm {
        /// What the form asks for.
        requested: &'static str,
        /// For which elements it is made.
        allowed: &'static str,
    },
    /// The problem has data for a region or boundary group that the mesh does not have.
    #[error("the problem has data for {kind} {name}, which the mesh does not have: {known}")]
    UnknownGroup {
        /// "region" or "boundary group".
        kind: &'static str,
        /// The name.
        name: String,
        /// The names that the mesh has.
        known: String,
    },
    /// A datum is given twice for one name, or twice without a name.
    #[error(
        "the {datum} {} is given twice: give it once; only sources add up",
        .name.as_ref().map_or("without a name".to_owned(), |name| format!("for {name}"))
    )]
    GivenTwice {
        /// The datum: "coefficient", "lower obstacle", "Dirichlet datum", ...
        datum: &'static str,
        /// The name of its region or boundary group, where it has one.
        name: Option<String>,
    },
    /// The data of a boundary group are of another kind than its facets.
    #[error(
        "the problem has {given} data on boundary group {group}, whose facets are {found} in the mesh: bind the problem to the mesh by Problem::bind_boundary"
    )]
    UnboundBoundary {
        /// A name of the group.
        group: String,
        /// The condition to which the data belong.
        given: &'static str,
        /// The condition on the facets.
        found: &'static str,
    },
    /// Meshes are to follow an error bound that the scheme does not have.
    #[error("meshes cannot follow the error bound of {scheme}: {why}")]
    NotAdaptive {
        /// The scheme.
        scheme: String,
        /// Why there is no bound.
        why: String,
    },
    /// Mesh and scene disagree.
    #[error("the mesh does not fit {scene}: {why}")]
    UnfitMesh {
        /// Name of the scene.
        scene: String,
        /// What does not fit, where, and what to do.
        why: String,
    },
    /// Two solutions are compared whose meshes do not belong to one hierarchy.
    #[error(
        "solutions are compared on one mesh or on meshes of one hierarchy: solve both on the same `Hierarchy`"
    )]
    NotNested,
    /// What one of the processes that share a mesh found, or why they do not reach one another: an
    /// [`ExchangeError`](crate::processes::ExchangeError).
    #[error(transparent)]
    Processes(Box<dyn std::error::Error + Send + Sync>),
    /// A parameter outside its range.
    #[error("{parameter} = {value}: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given, as text.
        value: String,
        /// The values allowed.
        allowed: String,
    },
    /// A run would need more memory than the machine, the limits of the process and its control group leave.
    #[error(
        "{run}: would need about {:.1} GB of memory, {:.1} GB are available; choose {remedy}",
        .needed / 1e9, .available / 1e9
    )]
    NotEnoughMemory {
        /// The scheme, with its level or number of unknowns.
        run: String,
        /// The estimate in bytes, of the whole process.
        needed: f64,
        /// Bytes that the process may have in all.
        available: f64,
        /// What needs less.
        remedy: &'static str,
    },
    /// Two schemes or two solvers of a study have one name, and so have their rows and files.
    #[error(
        "two {items} of the study are named {name:?}, and nothing would tell their rows apart: name each once, and give one of your own another name by {by}"
    )]
    EqualNames {
        /// "schemes" or "solvers".
        items: &'static str,
        /// The name: of schemes the label, with constraint set and choices.
        name: String,
        /// The functions that name one of one's own.
        by: &'static str,
    },
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
    #[error(
        "{path} has the report of another request: it has {found}, this run has {wanted}; repeat that request or choose another directory"
    )]
    OtherRequest {
        /// The directory.
        path: String,
        /// What the report has and the run has not.
        found: String,
        /// What the run has and the report has not.
        wanted: String,
    },
}

debug_by_display!(Error);

impl Error {
    /// A parameter outside its range.
    pub(crate) fn parameter(
        parameter: &'static str,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Parameter { parameter, value: value.to_string(), allowed: allowed.into() }
    }
    /// Two schemes of a study have one label.
    pub(crate) fn equal_schemes(label: String) -> Self {
        let by = "`Scheme::name` or `Scheme::choices`";
        Self::EqualNames { items: "schemes", name: label, by }
    }
    /// The error with the number of its cell in the whole mesh, given those of the cells of a
    /// [part](crate::mesh::Part::cells), on which it was found.
    #[must_use]
    pub fn in_whole_mesh(mut self, cells: &[u64]) -> Self {
        if let Self::DataNotFinite { cell, .. }
        | Self::CoefficientNotPositive { cell, .. }
        | Self::EmptyConstraint { cell, .. }
        | Self::BoundsCross { cell, .. } = &mut self
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
