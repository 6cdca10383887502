//! The errors of a problem file.

use std::error::Error;
use std::path::{Path, PathBuf};

use crate::readable_debug::debug_by_display;

/// Why a problem file is not a problem: what is wrong, where, and what is allowed. `Debug` prints the message.
#[derive(thiserror::Error)]
#[error("{}{}: {message}", path.display(), place.map_or(String::new(), |[line, column]| format!(":{line}:{column}")))]
#[non_exhaustive]
pub struct ProblemFileError {
    /// The kind of the error.
    pub kind: ProblemFileErrorKind,
    /// The file.
    pub path: PathBuf,
    /// Line and column in characters, from one, of what is wrong at one place of the file.
    pub place: Option<[usize; 2]>,
    pub(super) message: String,
    /// The error of the system, of the mesh file, or of the problem.
    pub(super) source: Option<Box<dyn Error + Send + Sync>>,
}

debug_by_display!(ProblemFileError);

impl ProblemFileError {
    /// The error of a file that another error causes, which is its message.
    pub(super) fn of_file(
        path: &Path,
        kind: ProblemFileErrorKind,
        source: impl Error + Send + Sync + 'static,
    ) -> Self {
        let message = source.to_string();
        Self { kind, path: path.into(), place: None, message, source: Some(Box::new(source)) }
    }
}

/// The kinds of errors of a problem file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProblemFileErrorKind {
    /// The file cannot be read.
    Unreadable,
    /// The file is not TOML, or a key, the type of a value, an expression or a constant is wrong or missing.
    Text,
    /// A number or expression has a value that the datum cannot have, or a gradient is not that of its function.
    Value,
    /// The mesh has no such region or boundary group, or the file does not say what holds on a boundary group.
    Group,
    /// The mesh file that it names is no mesh, or the shape of a boundary group does not fit it: the source of the first
    /// is a [`GmshError`](crate::mesh::gmsh::GmshError).
    Mesh,
    /// Its data do not make a problem: the source is an [`Error`](crate::error::Error).
    Problem,
}
