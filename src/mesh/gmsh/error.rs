//! Errors and warnings of the reader.

use crate::mesh::error::MeshError;
use crate::readable_debug::debug_by_display;
use std::fmt;

/// The reason why a Gmsh file was not read or written: what is wrong, where, and what to do. `Debug` prints the
/// message and its causes.
#[derive(thiserror::Error)]
#[error("{}{message}", .position.map_or(String::new(), |position| format!("{position}: ")))]
#[non_exhaustive]
pub struct GmshError {
    /// What is wrong.
    pub kind: GmshErrorKind,
    /// Where it was found, if at one place of the file.
    pub position: Option<FilePosition>,
    message: String,
    /// The error of the operating system, or a [`MeshError`] with cells and vertices counted from zero.
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

debug_by_display!(GmshError);

impl GmshError {
    /// The error with this sentence.
    pub(crate) fn new(kind: GmshErrorKind, message: impl Into<String>) -> Self {
        Self { kind, position: None, message: message.into(), source: None }
    }
    pub(super) fn at(self, position: FilePosition) -> Self {
        Self { position: Some(position), ..self }
    }
    pub(super) fn caused_by(self, source: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self { source: Some(Box::new(source)), ..self }
    }
    /// The error of a mesh; `in_file` names its elements and nodes in the file.
    pub(crate) fn of_mesh(source: MeshError, in_file: &[String]) -> Self {
        let place = match in_file {
            [] => String::new(),
            some => format!("; in the file: {}", some.join(", ")),
        };
        Self::new(GmshErrorKind::Mesh, format!("{source}{place}")).caused_by(source)
    }
    /// More groups than can be numbered.
    pub(super) fn too_many_groups() -> Self {
        let message = format!(
            "the file has more than {} groups, or intersections of groups, of one dimension; leave out those that are not needed",
            u16::MAX
        );
        Self::new(GmshErrorKind::TooManyGroups, message)
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
    /// The version of the format is not read.
    UnsupportedVersion,
    /// Numbers have another size than eight bytes.
    UnsupportedDataSize,
    /// The byte order mark of a binary file is not the integer one.
    ByteOrder,
    /// The file ends inside a section.
    Truncated,
    /// A required section is missing.
    MissingSection,
    /// The mesh is partitioned.
    Partitioned,
    /// A word where a number is expected.
    NotANumber,
    /// The contents differ from the format.
    Unexpected,
    /// The number of records of a section differs from the announced one.
    Count,
    /// An element names a node the file does not have.
    UnknownNode,
    /// Two nodes have the same tag.
    RepeatedNode,
    /// A coordinate is not finite.
    NotFinite,
    /// A line or surface mesh does not lie in a line or plane.
    NotFlat,
    /// The file has no elements, or only points.
    NoCells,
    /// The mesh has another dimension than asked for.
    WrongDimension,
    /// An element type outside the table of the format, or one without a fixed number of nodes.
    UnknownElementType,
    /// An element that is not a simplex.
    NotSimplicial,
    /// No boundary element is in a physical group.
    NoPhysicalGroups,
    /// The physical groups of one dimension are too many.
    TooManyGroups,
    /// The contents of the file are not a mesh: the source of the error is a [`MeshError`].
    Mesh,
    /// The file cannot be written.
    Unwritable,
}

/// A position in a mesh file: a line of a text file, an offset into a binary one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FilePosition {
    /// Line of a text file, counted from one.
    Line(usize),
    /// Offset of a byte in a binary file, counted from zero.
    Byte(usize),
}

impl FilePosition {
    /// The position of a byte of a file.
    pub(super) fn of(offset: usize, bytes: &[u8], is_binary: bool) -> Self {
        match is_binary {
            true => Self::Byte(offset),
            false => Self::Line(1 + bytes[..offset].iter().filter(|&&byte| byte == b'\n').count()),
        }
    }
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilePosition::Line(line) => write!(f, "line {line}"),
            FilePosition::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// A property of the file that the mesh does not represent: the kind, and the sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GmshWarning {
    /// Elements of higher order are read as straight ones.
    #[error("{0}")]
    Straightened(String),
    /// Boundary facets lie on each other, each with nodes of its own.
    #[error("{0}")]
    Coincident(String),
    /// Some facets of a boundary group lie between two cells.
    #[error("{0}")]
    Inside(String),
    /// The file says which nodes correspond to each other on periodic boundaries.
    #[error(
        "section $Periodic is not used: the two sides of a periodic boundary are not tied to each other"
    )]
    Periodic,
}
