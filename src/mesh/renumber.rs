//! Numbers of vertices and cells: in the order of cells, and along a space-filling curve.

use std::cmp::Ordering;

use super::boundary::BoundaryFacet;
use super::simplicial::Mesh;
use crate::arrays::array_of;
use crate::parallel::vectors::collect;

/// Bits of each coordinate on the lattice of the curve.
const BITS: u32 = 21;

impl<const D: usize> Mesh<D> {
    /// The same cells with the vertices in the order in which cells name them first, and the new numbers of the
    /// vertices.
    pub(crate) fn in_order_of_cells(&self) -> (Self, Vec<u32>) {
        self.renumbered(self.cells.clone(), &|cell| cell, self.cell_regions.clone())
    }

    /// The mesh with its cells along a Hilbert curve through their barycentres, and its vertices in the order in
    /// which these cells name them first, those of one cell by their coordinates. The cells in their new order
    /// and the new numbers of the vertices follow.
    ///
    /// What is near in space is near in memory then. Of two lists with the same cells the result is the same,
    /// unless two barycentres agree to `2^-21` of the mesh.
    pub(in crate::mesh) fn along_curve(&self) -> (Self, Vec<u32>, Vec<u32>) {
        let corner = |v: u32| self.vertices[v as usize].as_slice();
        // sums in an order that does not depend on numbers
        let mut sorted = self.cells.clone();
        for cell in sorted.chunks_exact_mut(D + 1) {
            // coordinates of a mesh are finite
            sort_vertices(cell, &|v, w| {
                corner(v).partial_cmp(corner(w)).unwrap_or(Ordering::Equal)
            });
        }
        let barycentre =
            |cell: &[u32]| array_of(|k| cell.iter().map(|&v| corner(v)[k] / (D + 1) as f64).sum());
        let points: Vec<[f64; D]> =
            collect(self.n_cells(), |c| barycentre(&sorted[c * (D + 1)..][..D + 1]));
        let order = order_along_curve(&points);
        let mut positions = vec![0; order.len()];
        let mut cells = Vec::with_capacity(self.cells.len());
        for (position, &c) in (0..).zip(&order) {
            positions[c as usize] = position;
            let start = c as usize * (D + 1);
            cells.extend_from_slice(&sorted[start..start + D + 1]);
        }
        let regions = &self.cell_regions;
        let of_cells = order.iter().filter_map(|&c| regions.get(c as usize).copied()).collect();
        let (mesh, numbers) = self.renumbered(cells, &|c| positions[c as usize], of_cells);
        (mesh, order, numbers)
    }

    /// The mesh with the given vertices of cells, numbered in the order in which they are named first, and the
    /// new numbers of the vertices; `position` is the new number of a cell.
    fn renumbered(
        &self,
        mut cells: Vec<u32>,
        position: &dyn Fn(u32) -> u32,
        cell_regions: Vec<u16>,
    ) -> (Self, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let mut numbers = vec![NONE; self.vertices.len()];
        let mut vertices = Vec::with_capacity(self.vertices.len());
        for v in &mut cells {
            let number = &mut numbers[*v as usize];
            if *number == NONE {
                *number = vertices.len() as u32;
                vertices.push(self.vertices[*v as usize]);
            }
            *v = *number;
        }
        cells.chunks_exact_mut(D + 1).for_each(<[u32]>::sort_unstable);
        let renumbered = |facet: &BoundaryFacet| {
            let cell = self.cell(facet.cell as usize);
            let opposite = numbers[cell[facet.local as usize] as usize];
            let before = cell.iter().filter(|&&v| numbers[v as usize] < opposite).count();
            BoundaryFacet { cell: position(facet.cell), local: before as u8, ..*facet }
        };
        let mut boundary: Vec<BoundaryFacet> = self.boundary.iter().map(renumbered).collect();
        BoundaryFacet::sort(&mut boundary);
        let mesh = Self {
            vertices,
            cells,
            boundary,
            is_supported: self.is_supported,
            groups: self.groups.clone(),
            cell_regions,
            whole: self.whole,
            shapes: self.shapes.renumbered(&numbers),
        };
        (mesh, numbers)
    }
}

/// Sorts the vertices of a cell; not generic, so that the sorting code is compiled once.
fn sort_vertices(vertices: &mut [u32], compare: &dyn Fn(u32, u32) -> Ordering) {
    vertices.sort_unstable_by(|&v, &w| compare(v, w));
}

/// The positions of points in their order along a Hilbert curve through the box around them: points that
/// are near in this order are near in space. Of equal places the first point comes first.
pub(in crate::mesh) fn order_along_curve<const D: usize>(points: &[[f64; D]]) -> Vec<u32> {
    let fold = |k: usize, start: f64, f: fn(f64, f64) -> f64| {
        points.iter().fold(start, |found, x| f(found, x[k]))
    };
    let low: [f64; D] = array_of(|k| fold(k, f64::INFINITY, f64::min));
    let high: [f64; D] = array_of(|k| fold(k, f64::NEG_INFINITY, f64::max));
    let side = (0..D).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let steps = f64::from((1_u32 << BITS) - 1) / side;
    let key = |x: &[f64; D]| hilbert::<D>(array_of(|k| ((x[k] - low[k]) * steps) as u32));
    let mut order = collect(points.len(), |k| (key(&points[k]), k as u32));
    order.sort_unstable();
    order.into_iter().map(|(_, k)| k).collect()
}

/// The distance along the Hilbert curve of a point of a lattice.
///
/// Source: J. Skilling, AIP Conf. Proc. 707 (2004), 381-387.
fn hilbert<const D: usize>(mut x: [u32; D]) -> u64 {
    let bits = || (0..BITS).rev().map(|k| 1_u32 << k);
    for bit in bits().take_while(|&bit| bit > 1) {
        let below = bit - 1;
        for k in 0..D {
            if x[k] & bit != 0 {
                x[0] ^= below;
            } else {
                let both = (x[0] ^ x[k]) & below;
                x[0] ^= both;
                x[k] ^= both;
            }
        }
    }
    for k in 1..D {
        x[k] ^= x[k - 1];
    }
    let set = bits().filter(|&bit| bit > 1 && x[D - 1] & bit != 0);
    let flip = set.fold(0, |flip, bit| flip ^ (bit - 1));
    bits().fold(0, |distance, bit| {
        x.iter().fold(distance, |distance, x| distance << 1 | u64::from((x ^ flip) & bit != 0))
    })
}
