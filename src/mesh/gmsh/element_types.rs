//! The table of element types.

/// The shape of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Point,
    Line,
    Triangle,
    Tetrahedron,
    Quadrilateral,
    Hexahedron,
    Prism,
    Pyramid,
}

impl Shape {
    /// The dimension, of a simplex only: its corners are one more.
    pub(super) fn simplex_dimension(self) -> Option<usize> {
        match self {
            Shape::Point => Some(0),
            Shape::Line => Some(1),
            Shape::Triangle => Some(2),
            Shape::Tetrahedron => Some(3),
            _ => None,
        }
    }
    /// The shape in words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Shape::Point => "point",
            Shape::Line => "line",
            Shape::Triangle => "triangle",
            Shape::Tetrahedron => "tetrahedron",
            Shape::Quadrilateral => "quadrilateral",
            Shape::Hexahedron => "hexahedron",
            Shape::Prism => "prism",
            Shape::Pyramid => "pyramid",
        }
    }
}

/// The properties of an element type. The corners of an element are its first nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TypeProperties {
    /// The shape.
    pub(super) shape: Shape,
    /// Polynomial order of the map from the reference element; 1 for every type that is not a simplex.
    pub(super) order: u8,
    /// Number of nodes; 0 for every type that is not a simplex.
    pub(super) nodes: usize,
}

impl TypeProperties {
    /// The properties of an element type; none for a type without a fixed number of nodes.
    pub(super) fn from_type(element_type: i64) -> Option<Self> {
        // Orders six to ten have numbers in separate ranges.
        let order = |first: i64, order: i64| (element_type - first + order) as u8;
        Some(match element_type {
            15 => TypeProperties { shape: Shape::Point, order: 1, nodes: 1 },
            1 => line(1),
            8 => line(2),
            26..=28 => line(order(26, 3)),
            62..=66 => line(order(62, 6)),
            2 => triangle(1),
            9 => triangle(2),
            21 => triangle(3),
            23 => triangle(4),
            25 => triangle(5),
            42..=46 => triangle(order(42, 6)),
            20 => triangle_edges(3),
            22 => triangle_edges(4),
            24 => triangle_edges(5),
            52..=56 => triangle_edges(order(52, 6)),
            4 => tetrahedron(1),
            11 => tetrahedron(2),
            29..=31 => tetrahedron(order(29, 3)),
            71..=75 => tetrahedron(order(71, 6)),
            137 => tetrahedron_edges(3),
            32..=33 => tetrahedron_edges(order(32, 4)),
            79..=83 => tetrahedron_edges(order(79, 6)),
            3 | 10 | 16 | 36..=41 | 47..=51 | 57..=61 => other(Shape::Quadrilateral),
            5 | 12 | 17 | 92..=105 => other(Shape::Hexahedron),
            6 | 13 | 18 | 90 | 91 | 106..=117 => other(Shape::Prism),
            7 | 14 | 19 | 118..=131 => other(Shape::Pyramid),
            _ => return None,
        })
    }
}

fn line(order: u8) -> TypeProperties {
    TypeProperties { shape: Shape::Line, order, nodes: usize::from(order) + 1 }
}

fn triangle(order: u8) -> TypeProperties {
    let k = usize::from(order);
    TypeProperties { shape: Shape::Triangle, order, nodes: (k + 1) * (k + 2) / 2 }
}

/// Triangles without inner nodes.
fn triangle_edges(order: u8) -> TypeProperties {
    TypeProperties { shape: Shape::Triangle, order, nodes: 3 * usize::from(order) }
}

fn tetrahedron(order: u8) -> TypeProperties {
    let k = usize::from(order);
    TypeProperties { shape: Shape::Tetrahedron, order, nodes: (k + 1) * (k + 2) * (k + 3) / 6 }
}

/// Tetrahedra without nodes inside the tetrahedron and its faces.
fn tetrahedron_edges(order: u8) -> TypeProperties {
    TypeProperties { shape: Shape::Tetrahedron, order, nodes: 6 * usize::from(order) - 2 }
}

fn other(shape: Shape) -> TypeProperties {
    TypeProperties { shape, order: 1, nodes: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_the_types_in_the_manual() {
        let table = [
            (1, 2),
            (2, 3),
            (4, 4),
            (8, 3),
            (9, 6),
            (11, 10),
            (15, 1),
            (20, 9),
            (21, 10),
            (22, 12),
            (23, 15),
            (24, 15),
            (25, 21),
            (26, 4),
            (27, 5),
            (28, 6),
            (29, 20),
            (30, 35),
            (31, 56),
            (32, 22),
            (33, 28),
            (46, 66),
            (56, 30),
            (66, 11),
            (75, 286),
            (79, 34),
            (83, 58),
            (137, 16),
        ];
        for (element_type, nodes) in table {
            assert_eq!(
                TypeProperties::from_type(element_type).map(|k| k.nodes),
                Some(nodes),
                "type {element_type}"
            );
        }
        for element_type in [-1, 0, 34, 35, 67, 84, 140, 1 << 40] {
            assert_eq!(TypeProperties::from_type(element_type), None, "type {element_type}");
        }
    }
}
