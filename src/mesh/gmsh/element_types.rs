//! The table of element types.

use super::error::{GmshError, GmshErrorKind};
use super::source::Source;

/// The shape of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// A simplex of this dimension: its corners are one more.
    Simplex(usize),
    /// Another shape, in words.
    Other(&'static str),
}
use Shape::{Other, Simplex};

/// The simplices in words, by dimension.
pub(super) const SIMPLICES: [&str; 4] = ["point", "line", "triangle", "tetrahedron"];

impl Shape {
    /// The shape in words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Simplex(dimension) => SIMPLICES[dimension],
            Other(name) => name,
        }
    }
}

/// Which nodes of its order an element has.
#[derive(Clone, Copy)]
enum Nodes {
    /// All of them.
    All,
    /// Those on edges, of tetrahedra also none inside the faces.
    OnEdges,
}
use Nodes::{All, OnEdges};

/// Ranges of types, first and last included: their shape, the order of the first, to which each following type adds
/// one, and their nodes. Orders six to ten have ranges of their own.
const SIMPLICIAL: [(i64, i64, usize, u8, Nodes); 22] = [
    (15, 15, 0, 1, All),
    (1, 1, 1, 1, All),
    (8, 8, 1, 2, All),
    (26, 28, 1, 3, All),
    (62, 66, 1, 6, All),
    (2, 2, 2, 1, All),
    (9, 9, 2, 2, All),
    (21, 21, 2, 3, All),
    (23, 23, 2, 4, All),
    (25, 25, 2, 5, All),
    (42, 46, 2, 6, All),
    (20, 20, 2, 3, OnEdges),
    (22, 22, 2, 4, OnEdges),
    (24, 24, 2, 5, OnEdges),
    (52, 56, 2, 6, OnEdges),
    (4, 4, 3, 1, All),
    (11, 11, 3, 2, All),
    (29, 31, 3, 3, All),
    (71, 75, 3, 6, All),
    (137, 137, 3, 3, OnEdges),
    (32, 33, 3, 4, OnEdges),
    (79, 83, 3, 6, OnEdges),
];

/// The properties of an element type. The corners of an element are its first nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ElementType {
    pub(super) number: i64,
    pub(super) shape: Shape,
    /// Polynomial order of the map from the reference element; 1 for every type that is not a simplex.
    pub(super) order: u8,
    /// Number of nodes; 0 for every type that is not a simplex.
    pub(super) nodes: usize,
}

impl ElementType {
    /// The type with this number; none for a type without a fixed number of nodes.
    pub(super) fn new(number: i64) -> Option<Self> {
        for (first, last, dimension, order_of_first, nodes) in SIMPLICIAL {
            if (first..=last).contains(&number) {
                let order = order_of_first + (number - first) as u8;
                let nodes = nodes.of_simplex(dimension, usize::from(order));
                return Some(Self { number, shape: Simplex(dimension), order, nodes });
            }
        }
        let name = match number {
            3 | 10 | 16 | 36..=41 | 47..=51 | 57..=61 => "quadrilateral",
            5 | 12 | 17 | 92..=105 => "hexahedron",
            6 | 13 | 18 | 90 | 91 | 106..=117 => "prism",
            7 | 14 | 19 | 118..=131 => "pyramid",
            _ => return None,
        };
        Some(Self { number, shape: Other(name), order: 1, nodes: 0 })
    }
}

/// Reads the number of an element type.
pub(super) fn element_type(source: &mut Source) -> Result<ElementType, GmshError> {
    let number = source.integer("the type of an element")?;
    ElementType::new(number).ok_or_else(|| {
        let message = format!(
            "elements of type {number} are not known; lines, triangles and tetrahedra are read"
        );
        source.error(GmshErrorKind::UnknownElementType, message)
    })
}

/// The dimension of an element; an error that names it if it is not a simplex.
pub(super) fn simplex_dimension(
    source: &Source,
    of_type: &ElementType,
    element: u64,
) -> Result<usize, GmshError> {
    match of_type.shape {
        Simplex(dimension) => Ok(dimension),
        Other(name) => {
            let message = format!(
                "element {element} is a {name} (type {}); only simplices are read, triangulate: mesh again without `Recombine`, `Mesh.RecombineAll` and `Mesh.SubdivisionAlgorithm`",
                of_type.number
            );
            Err(source.error(GmshErrorKind::NotSimplicial, message))
        }
    }
}

impl Nodes {
    /// Their number, of a simplex of this dimension and order.
    fn of_simplex(self, dimension: usize, order: usize) -> usize {
        match self {
            All => (1..=dimension).fold(1, |nodes, k| nodes * (order + k) / k),
            OnEdges => dimension + 1 + dimension * (dimension + 1) / 2 * (order - 1),
        }
    }
}
