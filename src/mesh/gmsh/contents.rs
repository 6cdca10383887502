//! The contents of a file before a mesh is made of them.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use super::error::{GmshError, GmshErrorKind, place};

/// The nodes, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Nodes {
    pub tags: Vec<u64>,
    pub points: Vec<[f64; 3]>,
    /// Their offsets in bytes.
    pub offsets: Vec<usize>,
}

/// The simplices of one dimension, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Simplices {
    /// Tags of the corners, one more than the dimension for each.
    pub corners: Vec<u64>,
    pub tags: Vec<u64>,
    /// Their offsets in bytes.
    pub offsets: Vec<usize>,
    /// Runs of elements in the same physical groups: the first element of each, and the groups.
    starts: Vec<(usize, Vec<i64>)>,
    /// How many have more nodes than corners.
    pub curved: usize,
}

impl Simplices {
    /// Appends an element in these groups, whose corners are appended to `corners` before.
    pub fn push(&mut self, (offset, tag): (usize, u64), groups: &[i64]) {
        if self.starts.last().is_none_or(|(_, last)| last != groups) {
            self.starts.push((self.tags.len(), groups.to_vec()));
        }
        self.tags.push(tag);
        self.offsets.push(offset);
    }
    /// Runs of consecutive elements in the same groups.
    pub fn runs(&self) -> impl Iterator<Item = (Range<usize>, &[i64])> {
        let ends = self.starts.iter().skip(1).map(|(start, _)| *start).chain([self.tags.len()]);
        self.starts.iter().zip(ends).map(|((start, groups), end)| (*start..end, &groups[..]))
    }
}

/// The contents of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    pub is_binary: bool,
    /// Whether an element of several groups is listed once for each of them, as in MSH 2.2.
    pub lists_by_group: bool,
    /// The names of the physical groups, by dimension and tag.
    pub groups: BTreeMap<(usize, i64), String>,
    pub nodes: Nodes,
    /// The simplices, by dimension.
    pub simplices: [Simplices; 4],
}

impl Contents {
    /// The largest dimension of an element that is not a point.
    pub fn dimension(&self) -> Option<usize> {
        (1..=3).rev().find(|&d| !self.simplices[d].tags.is_empty())
    }
    /// The place of a byte, for messages.
    pub fn place(&self, offset: usize) -> String {
        place(offset, &self.bytes, self.is_binary)
    }
    /// An error at a byte.
    pub fn error(&self, offset: usize, kind: GmshErrorKind, message: &str) -> GmshError {
        GmshError::new(kind, format!("{}: {message}", self.place(offset)))
    }
    /// The names of groups of a dimension; the number of a group without a name.
    pub fn names_of(&self, dimension: usize, groups: &[i64]) -> Vec<String> {
        let name = |&tag: &i64| match self.groups.get(&(dimension, tag)) {
            Some(name) => name.clone(),
            None => tag.to_string(),
        };
        groups.iter().map(name).collect()
    }
    /// The numbers of the nodes in the order of the file, by their tags.
    pub fn node_numbers(&self) -> Result<HashMap<u64, u32>, GmshError> {
        let Nodes { tags, offsets, .. } = &self.nodes;
        let mut numbers = HashMap::with_capacity(tags.len());
        // a file of at most 2 GiB has fewer nodes than there are numbers of 32 bits
        for (number, tag) in (0..).zip(tags) {
            if let Some(first) = numbers.insert(*tag, number) {
                let message = format!(
                    "node {tag} is given a second time (first: {}); tags of nodes must be distinct, renumber the mesh in Gmsh",
                    self.place(offsets[first as usize])
                );
                return Err(self.error(offsets[number as usize], GmshErrorKind::Node, &message));
            }
        }
        Ok(numbers)
    }
}
