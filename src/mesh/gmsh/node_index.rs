//! The map from the tags of nodes to their numbers in the order of the file.

use super::contents::Contents;
use super::error::{GmshError, GmshErrorKind};
use crate::mesh::error::MeshError;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The numbers of the nodes in the order of the file, by their tags.
pub(super) enum NodeIndex {
    /// A table over all tags up to the largest; [`ABSENT`] where there is no node.
    Dense(Vec<u32>),
    /// A hash table, for tags with large gaps.
    Sparse(HashMap<u64, u32>),
}

const ABSENT: u32 = u32::MAX;

impl NodeIndex {
    /// The index of all nodes of a file, whose tags must be distinct.
    pub(super) fn new(contents: &Contents) -> Result<Self, GmshError> {
        let nodes = &contents.nodes;
        let tags = &nodes.tags;
        let count = tags.len();
        if count >= ABSENT as usize {
            let limit = ABSENT as usize - 1;
            return Err(GmshError::of_mesh(MeshError::too_large("vertices", count, limit), &[]));
        }
        let largest = tags.iter().copied().max().unwrap_or(0);
        let repeated = |first: u32, second: u32| {
            let message = format!(
                "node {} is given a second time (first: {}); tags of nodes must be distinct, renumber the mesh in Gmsh",
                tags[second as usize],
                contents.position(nodes.offsets[first as usize])
            );
            contents.error(nodes.offsets[second as usize], GmshErrorKind::RepeatedNode, message)
        };
        if largest <= 4 * count as u64 + 1024 {
            let mut table = vec![ABSENT; largest as usize + 1];
            for (&tag, at) in tags.iter().zip(0..) {
                let entry = &mut table[tag as usize];
                if *entry != ABSENT {
                    return Err(repeated(*entry, at));
                }
                *entry = at;
            }
            return Ok(NodeIndex::Dense(table));
        }
        let mut table = HashMap::with_capacity(count);
        for (&tag, at) in tags.iter().zip(0..) {
            match table.entry(tag) {
                Entry::Occupied(entry) => return Err(repeated(*entry.get(), at)),
                Entry::Vacant(entry) => entry.insert(at),
            };
        }
        Ok(NodeIndex::Sparse(table))
    }
    /// The number of a node, if the file has it.
    #[inline]
    pub(super) fn find(&self, tag: u64) -> Option<u32> {
        match self {
            NodeIndex::Dense(table) => {
                let at = *table.get(usize::try_from(tag).ok()?)?;
                (at != ABSENT).then_some(at)
            }
            NodeIndex::Sparse(table) => table.get(&tag).copied(),
        }
    }
}
