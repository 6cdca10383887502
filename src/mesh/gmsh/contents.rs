//! The contents of a file before they are assembled to a mesh.

use super::element_types::{Shape, TypeProperties};
use super::error::GmshError;
use super::position::{ElementPosition, FilePosition};
use super::source::Source;
use std::collections::{BTreeMap, HashMap};

/// The source of the physical groups of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Membership {
    /// The groups of a geometric entity, in MSH 4.1.
    Entity(i64),
    /// One group, in MSH 2.2; zero for none.
    Group(i64),
}

/// The nodes, in the order of the file.
#[derive(Default)]
pub(super) struct Nodes {
    pub(super) tags: Vec<u64>,
    pub(super) points: Vec<[f64; 3]>,
    /// Numbers of the positions, see [`Contents::position_of`].
    pub(super) marks: Vec<usize>,
}

impl Nodes {
    pub(super) fn reserve(&mut self, nodes: usize) {
        self.tags.reserve(nodes);
        self.points.reserve(nodes);
        self.marks.reserve(nodes);
    }
    /// Appends a node, whose coordinates must be finite.
    pub(super) fn push(
        &mut self,
        source: &Source,
        mark: usize,
        node: u64,
        point: [f64; 3],
    ) -> Result<(), GmshError> {
        if let Some(axis) = point.iter().position(|x| !x.is_finite()) {
            let position = source.position_of(mark);
            return Err(GmshError::NotFinite {
                position,
                node,
                axis: ['x', 'y', 'z'][axis],
                value: point[axis],
            });
        }
        self.tags.push(node);
        self.points.push(point);
        self.marks.push(mark);
        Ok(())
    }
}

/// The simplices of one dimension, in the order of the file.
#[derive(Default)]
pub(super) struct Simplices {
    /// Tags of the corners, one more than the dimension for each.
    pub(super) corners: Vec<u64>,
    pub(super) tags: Vec<u64>,
    /// Numbers of the positions, see [`Contents::position_of`].
    pub(super) marks: Vec<usize>,
    /// Runs of elements with the same groups: the first element of each, and its groups.
    pub(super) memberships: Vec<(usize, Membership)>,
    /// Numbers of elements of higher order, by order.
    pub(super) curved: BTreeMap<u8, usize>,
}

impl Simplices {
    pub(super) fn reserve(&mut self, elements: usize, corners_each: usize) {
        self.tags.reserve(elements);
        self.marks.reserve(elements);
        self.corners.reserve(elements * corners_each);
    }
    /// Appends an element whose corners are appended to `corners` before.
    pub(super) fn push(&mut self, mark: usize, element: u64, order: u8, membership: Membership) {
        if self.memberships.last().is_none_or(|&(_, last)| last != membership) {
            self.memberships.push((self.tags.len(), membership));
        }
        if order > 1 {
            *self.curved.entry(order).or_insert(0) += 1;
        }
        self.tags.push(element);
        self.marks.push(mark);
    }
    /// Runs of consecutive elements with the same groups.
    pub(super) fn runs(&self) -> impl Iterator<Item = (std::ops::Range<usize>, Membership)> + '_ {
        let ends =
            self.memberships.iter().skip(1).map(|&(start, _)| start).chain([self.tags.len()]);
        self.memberships
            .iter()
            .zip(ends)
            .map(|(&(start, membership), end)| (start..end, membership))
    }
}

/// The contents of a file.
pub(super) struct Contents {
    /// Whether positions are bytes, otherwise lines.
    pub(super) binary: bool,
    /// The names of the physical groups, by dimension and tag.
    pub(super) groups: BTreeMap<(usize, i64), String>,
    /// The groups of the entities, by dimension and tag of the entity.
    pub(super) entities: HashMap<(usize, i64), Vec<i64>>,
    pub(super) nodes: Nodes,
    /// The simplices, by dimension.
    pub(super) simplices: [Simplices; 4],
    /// Whether the file has a section of periodic boundaries.
    pub(super) is_periodic: bool,
}

impl Contents {
    pub(super) fn new() -> Self {
        Contents {
            binary: false,
            groups: BTreeMap::new(),
            entities: HashMap::new(),
            nodes: Nodes::default(),
            simplices: Default::default(),
            is_periodic: false,
        }
    }
    /// The largest dimension of an element that is not a point.
    pub(super) fn dimension(&self) -> Result<usize, GmshError> {
        (1..=3).rev().find(|&d| !self.simplices[d].tags.is_empty()).ok_or(GmshError::NoCells)
    }
    pub(super) fn position_of(&self, mark: usize) -> FilePosition {
        if self.binary { FilePosition::Byte(mark) } else { FilePosition::Line(mark) }
    }
    /// An element by its position in the list of its dimension.
    pub(super) fn element(&self, dimension: usize, index: usize) -> Option<ElementPosition> {
        let simplices = &self.simplices[dimension];
        let position = self.position_of(*simplices.marks.get(index)?);
        Some(ElementPosition { element: *simplices.tags.get(index)?, position })
    }
}

/// The properties of an element type, of simplices or not.
pub(super) fn type_properties(
    source: &Source,
    element_type: i64,
) -> Result<TypeProperties, GmshError> {
    TypeProperties::from_type(element_type)
        .ok_or_else(|| GmshError::UnknownElementType { position: source.position(), element_type })
}

/// The dimension of a simplex; an error that names the element for anything else.
pub(super) fn simplex_dimension(
    source: &Source,
    shape: Shape,
    element_type: i64,
    element: u64,
) -> Result<usize, GmshError> {
    shape.simplex_dimension().ok_or_else(|| GmshError::NotSimplicial {
        position: source.position(),
        element,
        element_type,
        name: shape.name(),
    })
}
