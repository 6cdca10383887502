//! Positions in a mesh file.

use std::fmt;

/// A position in a mesh file: a line of a text file, an offset into a binary one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FilePosition {
    /// Line of a text file, counted from one.
    Line(usize),
    /// Offset of a byte in a binary file, counted from zero.
    Byte(usize),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilePosition::Line(line) => write!(f, "line {line}"),
            FilePosition::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// An element of the file, in the message of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ElementPosition {
    /// Tag of the element.
    pub element: u64,
    /// Position of the element.
    pub position: FilePosition,
}

impl fmt::Display for ElementPosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "element {} ({})", self.element, self.position)
    }
}
