//! What may be wrong with a problem file.

use std::io;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::mesh::gmsh::GmshError;
use crate::readable_debug::debug_by_display;

/// Why a problem file is not a problem, with the place in the file. `Debug` prints the message.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ProblemFileError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Something in the file is wrong.
    #[error("{}:{line}:{column}: {fault}", path.display())]
    At {
        /// The file.
        path: PathBuf,
        /// The line, from one.
        line: usize,
        /// The column in characters, from one.
        column: usize,
        /// What is wrong.
        fault: ProblemFileFault,
    },
    /// The mesh file that it names is no mesh.
    #[error("{}:{line}:{column}: {}", path.display(), with_path(mesh, source))]
    Mesh {
        /// The problem file.
        path: PathBuf,
        /// The line of the name, from one.
        line: usize,
        /// Its column in characters, from one.
        column: usize,
        /// The mesh file.
        mesh: PathBuf,
        /// Why.
        source: Box<GmshError>,
    },
    /// Its data do not make a problem.
    #[error("{}: {source}", path.display())]
    Problem {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<Error>,
    },
}

debug_by_display!(ProblemFileError);

/// The message on a mesh file, with its path once.
fn with_path(mesh: &Path, error: &GmshError) -> String {
    match error {
        GmshError::Unreadable { .. } => error.to_string(),
        _ => format!("mesh {}: {error}", mesh.display()),
    }
}

/// What is wrong at a place of a problem file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemFileFault {
    /// The file is not TOML.
    #[error("{0}")]
    Syntax(String),
    /// A key that means nothing.
    #[error("unknown key `{key}`; allowed are {allowed}")]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys that are allowed.
        allowed: String,
    },
    /// A key is missing in a table.
    #[error("`{key}` is missing: {purpose}")]
    Missing {
        /// The key.
        key: &'static str,
        /// What it is for.
        purpose: &'static str,
    },
    /// A value of another type.
    #[error("`{key}` must be {expected}, not {found}")]
    WrongType {
        /// The key.
        key: String,
        /// What is expected.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// An expression cannot be read.
    #[error("{0}")]
    Expression(String),
    /// A number or expression has a value that the datum cannot have.
    #[error("{datum} is {value} at {at}: it must be {allowed}")]
    Value {
        /// The datum.
        datum: String,
        /// The value.
        value: f64,
        /// The point, as coordinates in parentheses.
        at: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A component of the gradient of the exact solution is not that of its value.
    #[error(
        "component {component} of exact.gradient is {value} at {at}, but difference quotients of exact.value are {quotient}"
    )]
    Gradient {
        /// The component, from one.
        component: usize,
        /// The value.
        value: f64,
        /// The difference quotient of the exact solution.
        quotient: f64,
        /// The point, as coordinates in parentheses.
        at: String,
    },
    /// The mesh has no such region or boundary group.
    #[error("the mesh has no {kind} `{name}`; it has {known}")]
    UnknownGroup {
        /// "region" or "boundary group".
        kind: &'static str,
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// The file has data for a group of facets between two cells.
    #[error(
        "`{name}` lies inside the domain, between two cells: data are given on the boundary only, where the mesh has {known}"
    )]
    GroupInside {
        /// The name.
        name: String,
        /// The names of the boundary groups.
        known: String,
    },
    /// The file does not say what holds on a boundary group of the mesh.
    #[error(
        "the boundary group `{name}` of the mesh is missing: add a table [boundary.{name}] with its kind, dirichlet, neumann or contact, or [boundary.default] for groups without one, if its kind is that of the name"
    )]
    MissingBoundary {
        /// The name.
        name: String,
    },
}
