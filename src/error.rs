//! Everything that can be wrong with what a caller hands in.
//!
//! A numerical outcome (iteration limit, cycling) is not an error: see [`crate::inequality::Outcome`].

use crate::mesh::MeshError;
use crate::mesh::gmsh::GmshError;

/// What was wrong, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh cannot carry a finite element space.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A mesh file could not be read.
    #[error(transparent)]
    Gmsh(#[from] GmshError),
    /// A datum is not a finite number where it is needed.
    #[error("{datum} is {value} at {at} in cell {cell}: data of a scene must be finite")]
    DataNotFinite {
        /// Which datum: "source", "dirichlet", "obstacle", ...
        datum: &'static str,
        /// The value found.
        value: f64,
        /// The point, as coordinates in parentheses.
        at: String,
        /// The cell in which the point lies.
        cell: u32,
    },
    /// A diffusion coefficient must be positive.
    #[error("coefficient is {value} in cell {cell}: it must be positive and finite")]
    CoefficientNotPositive {
        /// The value found.
        value: f64,
        /// The cell.
        cell: u32,
    },
    /// Two constraints leave no admissible value.
    #[error(
        "no admissible value at unknown {unknown} near {at}: lower bound {lower} exceeds upper bound {upper}"
    )]
    EmptyConstraint {
        /// The unknown.
        unknown: usize,
        /// Where it lives.
        at: String,
        /// The larger lower bound.
        lower: f64,
        /// The smaller upper bound.
        upper: f64,
    },
    /// A constraint set has nothing that an inequality could bind.
    #[error("bounds on {constraint} cannot impose {condition}: {allowed}")]
    NothingToBound {
        /// Name of the constraint set.
        constraint: &'static str,
        /// The inequality.
        condition: &'static str,
        /// Which sets can.
        allowed: &'static str,
    },
    /// The mesh does not fit the scene.
    #[error("mesh does not fit scene {scene}: {why}")]
    UnfitMesh {
        /// Name of the scene.
        scene: String,
        /// What does not fit, where, and what would.
        why: String,
    },
    /// A parameter outside its range.
    #[error("{parameter} = {value}: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given, as text.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A report could not be written.
    #[error("cannot write {path}: {why}")]
    Write {
        /// The file.
        path: String,
        /// The system's reason.
        why: String,
    },
}

/// The error of a file that cannot be written.
#[cfg(feature = "report")]
pub(crate) fn write_error(path: &std::path::Path, why: impl std::fmt::Display) -> Error {
    Error::Write { path: path.display().to_string(), why: why.to_string() }
}
