//! The vertices of a cell that stand for a node.

use crate::algebra::DofLocation;

/// One to four vertices of a cell, ascending, each as often as it counts in their barycentre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NodeVertices {
    vertices: [u8; 4],
    n: usize,
}

impl NodeVertices {
    /// The fewest vertices whose barycentre is a point; if no four are, four with a barycentre near
    /// to it.
    pub fn new(point: &[f64; 4]) -> Self {
        let mut found = Self { vertices: [0; 4], n: 4 };
        for n in 1..=4 {
            // each vertex in turn is the one whose share lies furthest below its coordinate
            let mut missing = point.map(|x| x * n as f64);
            let mut counts = [0; 4];
            for _ in 0..n {
                let most = (1..4).fold(0, |k, l| if missing[l] > missing[k] { l } else { k });
                missing[most] -= 1.0;
                counts[most] += 1;
            }
            let mut vertices = [0; 4];
            let listed = (0..4).flat_map(|k| std::iter::repeat_n(k as u8, counts[k]));
            vertices.iter_mut().zip(listed).for_each(|(v, k)| *v = k);
            found = Self { vertices, n };
            if missing.iter().all(|x| x.abs() < 1e-9) {
                break;
            }
        }
        found
    }

    /// The location of a basis function with this node, in a cell with these vertices.
    #[inline(always)]
    pub fn location(&self, owner: Option<u32>, vertices: &[u32]) -> DofLocation {
        let own = self.vertices.map(|k| vertices[usize::from(k)]);
        DofLocation::new(owner, &own[..self.n])
    }
}
