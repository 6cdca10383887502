//! The contents of a file before a mesh is made of them.

use super::error::{FilePosition, GmshError, GmshErrorKind};
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
#[derive(Clone, Debug, Default)]
pub(super) struct Nodes {
    pub(super) tags: Vec<u64>,
    pub(super) points: Vec<[f64; 3]>,
    /// Their offsets in bytes.
    pub(super) offsets: Vec<usize>,
}

impl Nodes {
    pub(super) fn reserve(&mut self, nodes: usize) {
        self.tags.reserve(nodes);
        self.points.reserve(nodes);
        self.offsets.reserve(nodes);
    }
    /// Appends a node, whose coordinates must be finite.
    pub(super) fn push(
        &mut self,
        source: &Source,
        offset: usize,
        node: u64,
        point: [f64; 3],
    ) -> Result<(), GmshError> {
        if let Some(k) = point.iter().position(|x| !x.is_finite()) {
            let (axis, value) = (['x', 'y', 'z'][k], point[k]);
            let message = format!(
                "coordinate {axis} of node {node} is {value}; coordinates must be finite, correct the geometry and mesh again"
            );
            return Err(source.error_at(offset, GmshErrorKind::NotFinite, message));
        }
        self.tags.push(node);
        self.points.push(point);
        self.offsets.push(offset);
        Ok(())
    }
}

/// The simplices of one dimension, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Simplices {
    /// Tags of the corners, one more than the dimension for each.
    pub(super) corners: Vec<u64>,
    pub(super) tags: Vec<u64>,
    /// Their offsets in bytes.
    pub(super) offsets: Vec<usize>,
    /// Runs of elements with the same groups: the first element of each, and its groups.
    pub(super) memberships: Vec<(usize, Membership)>,
    /// Numbers of elements of higher order, by order.
    pub(super) curved: BTreeMap<u8, usize>,
}

impl Simplices {
    pub(super) fn reserve(&mut self, elements: usize, corners_each: usize) {
        self.tags.reserve(elements);
        self.offsets.reserve(elements);
        self.corners.reserve(elements * corners_each);
    }
    /// Appends an element whose corners are appended to `corners` before.
    pub(super) fn push(&mut self, offset: usize, element: u64, order: u8, membership: Membership) {
        if self.memberships.last().is_none_or(|&(_, last)| last != membership) {
            self.memberships.push((self.tags.len(), membership));
        }
        if order > 1 {
            *self.curved.entry(order).or_insert(0) += 1;
        }
        self.tags.push(element);
        self.offsets.push(offset);
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
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    /// The bytes of the file.
    pub(super) bytes: Vec<u8>,
    /// Whether the file is binary.
    pub(super) is_binary: bool,
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
    /// The largest dimension of an element that is not a point.
    pub(super) fn dimension(&self) -> Option<usize> {
        (1..=3).rev().find(|&d| !self.simplices[d].tags.is_empty())
    }
    /// The position of a byte.
    pub(super) fn position(&self, offset: usize) -> FilePosition {
        FilePosition::of(offset, &self.bytes, self.is_binary)
    }
    /// An error at a byte.
    pub(super) fn error(&self, offset: usize, kind: GmshErrorKind, message: String) -> GmshError {
        GmshError::new(kind, message).at(self.position(offset))
    }
    /// The names of all groups of an element; the number of a group without a name.
    pub(super) fn names_of(&self, dimension: usize, membership: Membership) -> Vec<String> {
        let tags = match &membership {
            Membership::Entity(entity) => {
                self.entities.get(&(dimension, *entity)).map(Vec::as_slice)
            }
            Membership::Group(0) => None,
            Membership::Group(tag) => Some(std::slice::from_ref(tag)),
        };
        let name = |&tag: &i64| match self.groups.get(&(dimension, tag)) {
            Some(name) => name.clone(),
            None => tag.to_string(),
        };
        // an entity that the file does not list is in no group
        tags.into_iter().flatten().map(name).collect()
    }
}
