//! Nodes: the functionals on the functions of a cell whose values are the unknowns.

use crate::arrays::array_of;
use crate::mesh::edge_vertices;
use crate::quadrature::{Rule, facet_to_cell, vertex_point};

/// A vertex, an edge or a facet of the reference simplex, or the simplex itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entity {
    /// A vertex.
    Vertex(usize),
    /// An edge, in the order of [`Layout::edge`](super::Layout::edge).
    Edge(usize),
    /// The facet opposite a vertex.
    Facet(usize),
    /// The cell.
    Cell,
}

impl Entity {
    /// Whether vertex `k` of a cell of this dimension belongs to the entity.
    pub fn contains(self, dimension: usize, k: usize) -> bool {
        k <= dimension
            && match self {
                Self::Vertex(vertex) => k == vertex,
                Self::Edge(edge) => edge_vertices(3).get(edge).is_some_and(|e| e.contains(&k)),
                Self::Facet(opposite) => k != opposite,
                Self::Cell => true,
            }
    }
}

/// The functional that an unknown is the value of: the value at a point, the mean over a facet or a coefficient of
/// Bernstein, tied to a vertex, an edge, a facet or the cell. Points are barycentric; entries beyond the dimension are
/// zero.
///
/// The literature calls it degree of freedom or *nodal variable* (S. C. Brenner, L. R. Scott, The mathematical
/// theory of finite element methods, 3.1.1), and the basis dual to it the nodal basis. Here it is a node, be it a
/// value at a point, a mean or a coefficient, and its number in the vector of values an unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    entity: Entity,
    functional: Functional,
}

#[derive(Clone, Debug, PartialEq)]
enum Functional {
    /// The value at a point.
    Value([f64; 4]),
    /// The mean over the facet.
    FacetMean,
    /// The coefficient of a vertex or an edge in the basis of Bernstein.
    Coefficient,
}

impl Node {
    /// The value at a vertex of the cell.
    ///
    /// # Panics
    /// If the number of the vertex is above three.
    pub fn vertex(k: usize) -> Self {
        Self::value(Entity::Vertex(k), vertex_point(k))
    }
    /// The value at the midpoint of an edge, in the order of [`Layout::edge`](super::Layout::edge).
    ///
    /// # Panics
    /// If the number of the edge is above five.
    pub fn midpoint(edge: usize) -> Self {
        Self::on_edge(edge, 0.5)
    }
    /// The value at the point of an edge whose distance from the edge's first vertex is this share
    /// of the edge, above zero and below one. The first vertex has the lower number in the cell and in
    /// the mesh, so that cells agree on the nodes of a common edge.
    ///
    /// # Panics
    /// If the number of the edge is above five.
    pub fn on_edge(edge: usize, share: f64) -> Self {
        // edges are ordered by their second vertex, so that the first ones are those of a triangle
        let [first, second] = edge_vertices(3)[edge];
        let mut point = [0.0; 4];
        (point[first], point[second]) = (1.0 - share, share);
        Self::value(Entity::Edge(edge), point)
    }
    /// The value at the barycentre of a cell of this dimension.
    pub fn barycentre(dimension: usize) -> Self {
        let share = 1.0 / (dimension + 1) as f64;
        Self::value(Entity::Cell, array_of(|k| if k <= dimension { share } else { 0.0 }))
    }
    /// The mean over the facet opposite a vertex of the cell.
    pub fn facet_mean(k: usize) -> Self {
        Self { entity: Entity::Facet(k), functional: Functional::FacetMean }
    }
    /// The Bernstein coefficient of a quadratic at a vertex of the cell, which is the value there.
    pub fn coefficient_of_vertex(k: usize) -> Self {
        Self { entity: Entity::Vertex(k), functional: Functional::Coefficient }
    }
    /// The Bernstein coefficient of a quadratic on an edge: twice the value at the midpoint less the mean of
    /// the values at the ends.
    pub fn coefficient_of_edge(edge: usize) -> Self {
        Self { entity: Entity::Edge(edge), functional: Functional::Coefficient }
    }
    /// The value at a point of an entity.
    pub fn value(entity: Entity, point: [f64; 4]) -> Self {
        Self { entity, functional: Functional::Value(point) }
    }
    /// The entity to which the functional is tied; its functionals of a function are known from the
    /// function on the entity.
    pub fn entity(&self) -> Entity {
        self.entity
    }
    /// The point if the functional is the value at a point.
    pub fn point(&self) -> Option<&[f64; 4]> {
        match &self.functional {
            Functional::Value(point) => Some(point),
            _ => None,
        }
    }
    /// Whether the functional is the value at the midpoint of an edge.
    pub fn is_midpoint(&self) -> bool {
        matches!(self.entity, Entity::Edge(_))
            && self.point().is_some_and(|point| point.iter().all(|&x| x == 0.0 || x == 0.5))
    }
    /// Whether the functional is the mean over a facet.
    pub fn is_facet_mean(&self) -> bool {
        self.functional == Functional::FacetMean
    }
    /// Whether the functional is a Bernstein coefficient.
    pub fn is_coefficient(&self) -> bool {
        self.functional == Functional::Coefficient
    }
    /// The functional as points with weights. Means are taken by the rule for facets, exactly for polynomials that the
    /// rule integrates exactly.
    pub fn terms(&self, facet_rule: &Rule) -> Vec<([f64; 4], f64)> {
        match (&self.functional, self.entity) {
            (Functional::Value(point), _) => vec![(*point, 1.0)],
            (Functional::Coefficient, Entity::Edge(k)) => {
                let ends = edge_vertices(3)[k].map(|v| (vertex_point(v), -0.5));
                // in this order rounding leaves a constant as it is
                vec![ends[0], ends[1], (self.centre(3), 2.0)]
            }
            (Functional::FacetMean, Entity::Facet(k)) => {
                facet_rule.iter().map(|(point, w)| (facet_to_cell(point, k), w)).collect()
            }
            _ => vec![(self.centre(3), 1.0)],
        }
    }
    /// The point that stands for the node: where it is the value at a point that point, of a mean and of a
    /// Bernstein coefficient the barycentre.
    pub fn centre(&self, dimension: usize) -> [f64; 4] {
        if let Functional::Value(point) = self.functional {
            return point;
        }
        let is_vertex = |k: usize| self.entity.contains(dimension, k);
        let n = (0..4).filter(|&k| is_vertex(k)).count() as f64;
        array_of(|k| if is_vertex(k) { 1.0 / n } else { 0.0 })
    }
    /// The node that the cell across a facet has in the place of this one, if the node is tied to
    /// the facet, which is opposite vertex `facet` of this cell and `other` of the cell across. Both
    /// cells list the vertices of the facet in the same order.
    pub(crate) fn across(&self, dimension: usize, facet: usize, other: usize) -> Option<Self> {
        if self.entity.contains(dimension, facet) {
            return None;
        }
        let place = |k: usize| k - usize::from(k > facet);
        let vertex = |k: usize| place(k) + usize::from(place(k) >= other);
        let point = |p: &[f64; 4]| {
            let mut moved = [0.0; 4];
            for k in (0..dimension + 1).filter(|&k| k != facet) {
                moved[vertex(k)] = p[k];
            }
            moved
        };
        let entity = match self.entity {
            Entity::Vertex(k) => Entity::Vertex(vertex(k)),
            Entity::Edge(k) => {
                let ends = edge_vertices(dimension).get(k)?.map(vertex);
                let edge = edge_vertices(dimension).iter().position(|e| *e == ends);
                Entity::Edge(edge?)
            }
            Entity::Facet(_) => Entity::Facet(other),
            Entity::Cell => return None,
        };
        let functional = match &self.functional {
            Functional::Value(p) => Functional::Value(point(p)),
            other => other.clone(),
        };
        Some(Self { entity, functional })
    }
}
