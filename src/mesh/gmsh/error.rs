//! Errors and warnings of the reader.

use super::position::{ElementPosition, FilePosition};
use crate::mesh::MeshError;
use crate::readable_debug::debug_by_display;
use std::path::PathBuf;

/// The reason why a Gmsh file was not read: what is wrong, where, and what to do. `Debug` prints the
/// message and its causes.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum GmshError {
    /// The system does not hand out the file.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is something else.
    #[error(
        "not a Gmsh mesh: the file begins with {found} where `$MeshFormat` is expected; save the mesh from Gmsh as .msh"
    )]
    NotGmsh {
        /// How the file begins.
        found: String,
    },
    /// Another revision of the format.
    #[error(
        "{place}: MSH version {version} is not read, only 4.1 and 2.2 are; save again from Gmsh with `-format msh41` or `-format msh22`"
    )]
    UnsupportedVersion {
        /// Where the version stands.
        place: FilePosition,
        /// The version found.
        version: String,
    },
    /// Numbers of another size than this reader knows.
    #[error(
        "{place}: numbers of {data_size} bytes are not read, only of 8; save again from a 64-bit Gmsh"
    )]
    UnsupportedDataSize {
        /// Where the size stands.
        place: FilePosition,
        /// The size found.
        data_size: u64,
    },
    /// The number that shows the byte order of a binary file is not one.
    #[error(
        "{place}: the byte order mark of a binary file must be the integer 1, found bytes {found:?}; the file is damaged (was it copied as text?), save or copy it again"
    )]
    ByteOrder {
        /// Where the mark stands.
        place: FilePosition,
        /// The bytes found.
        found: [u8; 4],
    },
    /// The file ends inside a section.
    #[error(
        "{place}: the file ends inside section {section}; it is incomplete, save or copy it again"
    )]
    Truncated {
        /// Where the file ends.
        place: FilePosition,
        /// The section that was open.
        section: String,
    },
    /// A section without which there is no mesh.
    #[error("the file has no section {section}; save the mesh again from Gmsh")]
    MissingSection {
        /// The section.
        section: &'static str,
    },
    /// A partitioned mesh.
    #[error(
        "{place}: the mesh is partitioned; save it unpartitioned (in Gmsh: Mesh > Delete > Partitions, or leave out `-part`)"
    )]
    Partitioned {
        /// Where the section of partitions begins.
        place: FilePosition,
    },
    /// A word where a number is expected.
    #[error(
        "{place}, section {section}: expected {expected}, found `{word}`; correct the line or save the mesh again"
    )]
    NotANumber {
        /// Where the word stands.
        place: FilePosition,
        /// The section.
        section: String,
        /// Which number was expected.
        expected: &'static str,
        /// The word found.
        word: String,
    },
    /// Something else than the format asks for at this place.
    #[error(
        "{place}, section {section}: expected {expected}, found {found}; correct the line or save the mesh again"
    )]
    Unexpected {
        /// Where it stands.
        place: FilePosition,
        /// The section.
        section: String,
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// A section announces another number of records than it has.
    #[error(
        "{place}, section {section}: {announced} {what} are announced, {found} found; the file is damaged, save or copy it again"
    )]
    Count {
        /// Where the difference shows.
        place: FilePosition,
        /// The section.
        section: String,
        /// What is counted.
        what: &'static str,
        /// How many are announced.
        announced: u64,
        /// How many there are, as far as can be told.
        found: String,
    },
    /// An element names a node the file does not have.
    #[error(
        "{place}: element {element} names node {node}, which section $Nodes does not have; save the mesh again"
    )]
    UnknownNode {
        /// Where the element stands.
        place: FilePosition,
        /// Tag of the element.
        element: u64,
        /// Tag of the node.
        node: u64,
    },
    /// Two nodes have the same tag.
    #[error(
        "{place}: node {node} is given a second time (first: {first}); tags of nodes must be distinct, renumber the mesh in Gmsh"
    )]
    RepeatedNode {
        /// Where the second one stands.
        place: FilePosition,
        /// Where the first one stands.
        first: FilePosition,
        /// The tag of both.
        node: u64,
    },
    /// A coordinate is not finite.
    #[error(
        "{place}: coordinate {axis} of node {node} is {value}; coordinates must be finite, correct the geometry and mesh again"
    )]
    NotFinite {
        /// Where the node stands.
        place: FilePosition,
        /// Tag of the node.
        node: u64,
        /// The coordinate: x, y or z.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// A line or surface mesh that bends out of its line or plane.
    #[error(
        "{place}: node {node} has {axis} = {value}, another node {axis} = {constant}; a mesh of dimension {dimension} must lie in {within}, turn it there or mesh the solid it bounds"
    )]
    NotFlat {
        /// Where the node stands.
        place: FilePosition,
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
    /// Nothing but points, or nothing at all.
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
        /// What to do.
        advice: &'static str,
    },
    /// An element type outside the table of the format, or one without a fixed number of nodes.
    #[error(
        "{place}: elements of type {element_type} are not known; lines, triangles and tetrahedra are read"
    )]
    UnknownElementType {
        /// Where the type stands.
        place: FilePosition,
        /// The type found.
        element_type: i64,
    },
    /// An element that is not a simplex.
    #[error(
        "{place}: element {element} is a {name} (type {element_type}); only simplices are read, triangulate: mesh again without `Recombine`, `Mesh.RecombineAll` and `Mesh.SubdivisionAlgorithm`"
    )]
    NotSimplicial {
        /// Where the element stands.
        place: FilePosition,
        /// Tag of the element.
        element: u64,
        /// Its type.
        element_type: i64,
        /// Its type in words.
        name: &'static str,
    },
    /// No part of the boundary has a name.
    #[error(
        "no {elements} of the file is in a physical group, so the boundary conditions are unknown; name the boundary parts in Gmsh, e.g. `Physical {entity}(\"dirichlet\") = {{1, 2}};`, with the names dirichlet, neumann and contact, put the domain in a group too, and save without `Mesh.SaveAll`"
    )]
    NoPhysicalGroups {
        /// "point", "line" or "triangle".
        elements: &'static str,
        /// The word of a Gmsh script for such a part of the boundary.
        entity: &'static str,
    },
    /// A group of boundary elements with a name that is no boundary part.
    #[error(
        "{place}: physical group {tag} of dimension {dimension} is named \"{name}\"; allowed are dirichlet, neumann and contact, in lower case{hint}"
    )]
    UnknownGroup {
        /// Where the name stands.
        place: FilePosition,
        /// Dimension of the group.
        dimension: usize,
        /// Its tag.
        tag: i64,
        /// Its name.
        name: String,
        /// Which name was probably meant, as the end of the sentence.
        hint: String,
    },
    /// A group of boundary elements without a name.
    #[error(
        "{place}: element {element} is in physical group {tag} of dimension {dimension}, which has no name in $PhysicalNames; name it dirichlet, neumann or contact"
    )]
    UnnamedGroup {
        /// Where the element stands.
        place: FilePosition,
        /// Tag of the element.
        element: u64,
        /// Dimension of the group.
        dimension: usize,
        /// Tag of the group.
        tag: i64,
    },
    /// The file is sound, but what it holds is not a mesh.
    #[error("{source}{}", in_file(elements, nodes))]
    Mesh {
        /// What is wrong, with cells and vertices counted from zero.
        source: MeshError,
        /// The elements of the file it is about.
        elements: Vec<ElementPosition>,
        /// Tags of the nodes it is about.
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

/// What a caller should know about a mesh that was read all the same.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GmshWarning {
    /// Elements of higher order were taken as straight ones.
    Straightened {
        /// Their type in words.
        name: &'static str,
        /// Their polynomial order.
        order: u8,
        /// How many there are.
        count: usize,
    },
}

impl std::fmt::Display for GmshWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            GmshWarning::Straightened { name, order, count } => write!(
                f,
                "{count} elements of type {name} of order {order} are read as straight ones by their corner nodes"
            ),
        }
    }
}
