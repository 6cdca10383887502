//! Connected components of cells or unknowns.

use super::facets::Neighbours;

/// A partition of `0..n` into sets that grow by joining two members (union and find with path halving).
pub(crate) struct Components {
    parents: Vec<u32>,
}

impl Components {
    /// Sets of one member each.
    pub fn new(n: usize) -> Self {
        Self { parents: (0..n as u32).collect() }
    }
    /// Sets given by the smallest member of each member's set.
    pub fn from_smallest(smallest: Vec<u32>) -> Self {
        Self { parents: smallest }
    }
    /// The cells of a mesh, connected through facets.
    pub fn of_cells(neighbours: &Neighbours) -> Self {
        let mut components = Self::new(neighbours.n_cells());
        for cell in 0..neighbours.n_cells() {
            neighbours.cells_across(cell).for_each(|other| components.join(cell, other));
        }
        components
    }
    /// Number of members.
    pub fn len(&self) -> usize {
        self.parents.len()
    }
    /// The member that stands for the set of a member: the smallest one.
    pub fn find(&mut self, member: usize) -> usize {
        let mut at = member;
        while self.parents[at] as usize != at {
            let above = self.parents[at] as usize;
            self.parents[at] = self.parents[above];
            at = above;
        }
        at
    }
    /// As [`Components::find`], without path halving.
    pub fn smallest(&self, member: usize) -> u32 {
        let mut at = member as u32;
        while self.parents[at as usize] != at {
            at = self.parents[at as usize];
        }
        at
    }
    /// Makes one set of the sets of two members.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }
}
