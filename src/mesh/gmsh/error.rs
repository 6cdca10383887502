//! Errors and warnings of the reader.

use super::position::{ElementPosition, FilePosition};
use crate::mesh::error::{MeshError, UNITE};
use crate::readable_debug::debug_by_display;
use std::path::PathBuf;

/// The reason why a Gmsh file was not read: what is wrong, where, and what to do. `Debug` prints the
/// message and its causes.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum GmshError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a Gmsh mesh.
    #[error(
        "not a Gmsh mesh: the file begins with {found} where `$MeshFormat` is expected; save the mesh from Gmsh as .msh"
    )]
    NotGmsh {
        /// The first word of the file.
        found: String,
    },
    /// The version of the format is not supported.
    #[error(
        "{position}: MSH version {version} is not read, only 4.1 and 2.2 are; save again from Gmsh with `-format msh41` or `-format msh22`"
    )]
    UnsupportedVersion {
        /// Position of the version.
        position: FilePosition,
        /// The version found.
        version: String,
    },
    /// The size of numbers is not supported.
    #[error(
        "{position}: numbers of {data_size} bytes are not read, only of 8; save again from a 64-bit Gmsh"
    )]
    UnsupportedDataSize {
        /// Position of the size.
        position: FilePosition,
        /// The size found.
        data_size: u64,
    },
    /// The byte order mark of a binary file is not the integer one.
    #[error(
        "{position}: the byte order mark of a binary file must be the integer 1, found bytes {found:?}; the file is damaged (was it copied as text?), save or copy it again"
    )]
    ByteOrder {
        /// Position of the mark.
        position: FilePosition,
        /// The bytes found.
        found: [u8; 4],
    },
    /// The file ends inside a section.
    #[error(
        "{position}: the file ends inside section {section}; it is incomplete, save or copy it again"
    )]
    Truncated {
        /// Position of the end of the file.
        position: FilePosition,
        /// The section that was open.
        section: String,
    },
    /// A required section is missing.
    #[error("the file has no section {section}; save the mesh again from Gmsh")]
    MissingSection {
        /// The section.
        section: &'static str,
    },
    /// The mesh is partitioned.
    #[error(
        "{position}: the mesh is partitioned; save it unpartitioned (in Gmsh: Mesh > Delete > Partitions, or leave out `-part`)"
    )]
    Partitioned {
        /// Position of the section of partitions.
        position: FilePosition,
    },
    /// A word where a number is expected.
    #[error(
        "{position}, section {section}: expected {expected}, found `{word}`; correct the line or save the mesh again"
    )]
    NotANumber {
        /// Position of the word.
        position: FilePosition,
        /// The section.
        section: String,
        /// Which number was expected.
        expected: &'static str,
        /// The word found.
        word: String,
    },
    /// The contents differ from the format.
    #[error(
        "{position}, section {section}: expected {expected}, found {found}; correct the line or save the mesh again"
    )]
    Unexpected {
        /// Position of the contents.
        position: FilePosition,
        /// The section.
        section: String,
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The number of records of a section differs from the announced one.
    #[error(
        "{position}, section {section}: {announced} {what} are announced, {found} found; the file is damaged, save or copy it again"
    )]
    Count {
        /// Position of the difference.
        position: FilePosition,
        /// The section.
        section: String,
        /// What is counted.
        what: &'static str,
        /// The announced number.
        announced: u64,
        /// The number found, or a bound of it.
        found: String,
    },
    /// An element names a node the file does not have.
    #[error(
        "{position}: element {element} names node {node}, which section $Nodes does not have; save the mesh again"
    )]
    UnknownNode {
        /// Position of the element.
        position: FilePosition,
        /// Tag of the element.
        element: u64,
        /// Tag of the node.
        node: u64,
    },
    /// Two nodes have the same tag.
    #[error(
        "{position}: node {node} is given a second time (first: {first}); tags of nodes must be distinct, renumber the mesh in Gmsh"
    )]
    RepeatedNode {
        /// Position of the second node.
        position: FilePosition,
        /// Position of the first node.
        first: FilePosition,
        /// The tag of both.
        node: u64,
    },
    /// A coordinate is not finite.
    #[error(
        "{position}: coordinate {axis} of node {node} is {value}; coordinates must be finite, correct the geometry and mesh again"
    )]
    NotFinite {
        /// Position of the node.
        position: FilePosition,
        /// Tag of the node.
        node: u64,
        /// The coordinate: x, y or z.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// A line or surface mesh does not lie in a line or plane.
    #[error(
        "{position}: node {node} has {axis} = {value}, another node {axis} = {constant}; a mesh of dimension {dimension} must lie in {within}, turn it there or mesh the solid it bounds"
    )]
    NotFlat {
        /// Position of the node.
        position: FilePosition,
        /// Tag of the node.
        node: u64,
        /// The coordinate that must be constant: y or z.
        axis: char,
        /// Its value at the node.
        value: f64,
        /// Its value at the first node.
        constant: f64,
        /// Dimension of the mesh.
        dimension: usize,
        /// The line or plane in words.
        within: &'static str,
    },
    /// The file has no elements, or only points.
    #[error(
        "the file has no lines, triangles or tetrahedra; mesh before saving, and put the domain in a physical group: Gmsh saves only elements of groups once there is one"
    )]
    NoCells,
    /// The mesh has another dimension than asked for.
    #[error(
        "the mesh has dimension {found} (its largest elements), but dimension {asked} was asked for; {advice}"
    )]
    WrongDimension {
        /// Dimension asked for.
        asked: usize,
        /// Largest dimension of an element of the file.
        found: usize,
        /// The remedy.
        advice: &'static str,
    },
    /// An element type outside the table of the format, or one without a fixed number of nodes.
    #[error(
        "{position}: elements of type {element_type} are not known; lines, triangles and tetrahedra are read"
    )]
    UnknownElementType {
        /// Position of the type.
        position: FilePosition,
        /// The type found.
        element_type: i64,
    },
    /// An element that is not a simplex.
    #[error(
        "{position}: element {element} is a {name} (type {element_type}); only simplices are read, triangulate: mesh again without `Recombine`, `Mesh.RecombineAll` and `Mesh.SubdivisionAlgorithm`"
    )]
    NotSimplicial {
        /// Position of the element.
        position: FilePosition,
        /// Tag of the element.
        element: u64,
        /// Its type.
        element_type: i64,
        /// Its type in words.
        name: &'static str,
    },
    /// No boundary element is in a physical group.
    #[error(
        "no {elements} of the file is in a physical group, so the boundary conditions are unknown; name the boundary parts in Gmsh, e.g. `Physical {entity}(\"dirichlet\") = {{1, 2}};`, with the names dirichlet, neumann and contact or with others, for which the problem says what holds there; put the domain in a group too, and save without `Mesh.SaveAll`"
    )]
    NoPhysicalGroups {
        /// "point", "line" or "triangle".
        elements: &'static str,
        /// The keyword of a Gmsh script for groups of such elements.
        entity: &'static str,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The physical groups of one dimension are too many.
    #[error(
        "the file has more than {limit} groups, or intersections of groups, of one dimension; leave out those that are not needed"
    )]
    TooManyGroups {
        /// The largest number.
        limit: usize,
    },
    /// The contents of the file are not a mesh.
    #[error("{source}{}", in_file(elements, nodes))]
    Mesh {
        /// The error of the mesh, with cells and vertices counted from zero.
        source: MeshError,
        /// The elements of the file in the message.
        elements: Vec<ElementPosition>,
        /// Tags of the nodes in the message.
        nodes: Vec<u64>,
    },
}

debug_by_display!(GmshError);

/// The end of the message that translates cells and vertices to elements and nodes of the file.
fn in_file(elements: &[ElementPosition], nodes: &[u64]) -> String {
    let mut parts: Vec<String> = elements.iter().map(ToString::to_string).collect();
    if !nodes.is_empty() {
        let tags: Vec<String> = nodes.iter().map(ToString::to_string).collect();
        parts.push(format!("nodes {}", tags.join(", ")));
    }
    if parts.is_empty() { String::new() } else { format!("; in the file: {}", parts.join(", ")) }
}

/// A property of the file that the mesh does not represent.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GmshWarning {
    /// Elements of higher order are read as straight ones.
    Straightened {
        /// Their type.
        name: &'static str,
        /// Their polynomial order.
        order: u8,
        /// Their number.
        count: usize,
    },
    /// Boundary facets lie on each other, each with nodes of its own.
    Coincident {
        /// Their number.
        count: usize,
    },
    /// Some facets of a boundary group lie between two cells.
    Inside {
        /// The name of the group.
        group: String,
    },
    /// The file says which nodes correspond to each other on periodic boundaries.
    Periodic,
}

impl std::fmt::Display for GmshWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            GmshWarning::Straightened { name, order, count } => write!(
                f,
                "{count} elements of type {name} of order {order} are read as straight ones by their corner nodes"
            ),
            GmshWarning::Coincident { count } => write!(
                f,
                "{count} facets of the boundary lie on others with different nodes, so the two sides are not connected there: {UNITE}, unless a slit is meant"
            ),
            GmshWarning::Inside { group } => write!(
                f,
                "some facets of group {group} lie inside the domain, between two cells, and are left out: data are given on the boundary only"
            ),
            GmshWarning::Periodic => f.write_str(
                "section $Periodic is not used: the two sides of a periodic boundary are not tied to each other",
            ),
        }
    }
}
