//! Errors of the reader.

use crate::mesh::error::MeshError;
use crate::readable_debug::debug_by_display;

/// The reason why a Gmsh file was not read: what is wrong, the line of a text file or the byte of a binary one where it
/// is, and what to do. `Debug` prints the message and its causes.
#[derive(thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct GmshError {
    /// What is wrong.
    pub kind: GmshErrorKind,
    message: String,
    /// The error of the operating system, or a [`MeshError`] with cells and vertices counted from zero.
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

debug_by_display!(GmshError);

impl GmshError {
    /// The error with this sentence.
    pub(super) fn new(kind: GmshErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), source: None }
    }
    pub(super) fn caused_by(self, source: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self { source: Some(Box::new(source)), ..self }
    }
    /// The error of a mesh; `in_file` names its elements and nodes in the file.
    pub(super) fn of_mesh(source: MeshError, in_file: &[String]) -> Self {
        let message = format!("{source}; in the file: {}", in_file.join(", "));
        Self::new(GmshErrorKind::Mesh, message).caused_by(source)
    }
}

/// What is wrong with a Gmsh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GmshErrorKind {
    /// The file cannot be read.
    Unreadable,
    /// The file is not a Gmsh mesh.
    NotGmsh,
    /// A version of the format, a partition or a type of elements that is not read.
    Unsupported,
    /// The contents differ from the format, or end early.
    Damaged,
    /// A node that the file does not have or has twice, or one whose coordinates are not finite.
    Node,
    /// A line or surface mesh does not lie in a line or plane.
    NotFlat,
    /// The file has no elements, or only points.
    NoCells,
    /// The mesh has another dimension than asked for.
    WrongDimension,
    /// No boundary element is in a physical group, or the groups are too many.
    Groups,
    /// The contents of the file are not a mesh: the source of the error is a [`MeshError`].
    Mesh,
}

/// A byte of a file for messages: the line of a text file, counted from one, the offset in a binary one.
pub(super) fn place(offset: usize, bytes: &[u8], is_binary: bool) -> String {
    match is_binary {
        true => format!("byte {offset}"),
        false => {
            format!("line {}", 1 + bytes[..offset].iter().filter(|&&byte| byte == b'\n').count())
        }
    }
}
