//! Box meshes with moved vertices, in any numbering.

use unilateral::mesh::BoxDomain;
use unilateral::mesh::{BoundaryCondition, Mesh, TaggedFacet};
use unilateral::prelude::*;

/// A small generator of pseudo-random numbers, so that a failure can be repeated.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}

/// The unit box, Dirichlet but for Neumann at the upper end of the first axis and contact at the
/// lower end of the last one (where there are two axes).
pub fn mixed_box<const D: usize>() -> BoxDomain<D> {
    let b = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(
        0,
        1,
        BoundaryCondition::Neumann,
    );
    if D > 1 { b.side(D - 1, 0, BoundaryCondition::Contact) } else { b }
}

/// The raw lists of a box mesh whose inner vertices are moved a little.
pub struct Raw<const D: usize> {
    pub vertices: Vec<Point<D>>,
    pub cells: Vec<u32>,
    pub boundary: Vec<TaggedFacet<D>>,
}

impl<const D: usize> Raw<D> {
    pub fn jittered(domain: &BoxDomain<D>, n: usize, size: f64, random: &mut Random) -> Self {
        let mesh = Mesh::<D>::kuhn_box(domain, [n; D]).unwrap();
        let mut vertices = mesh.vertices().to_vec();
        for x in &mut vertices {
            for k in 0..D {
                let inside =
                    (0..D).all(|j| x[j] > domain.lower[j] + 1e-9 && x[j] < domain.upper[j] - 1e-9);
                let shift = size / n as f64 * (random.unit() - 0.5);
                if inside {
                    x[k] += shift;
                }
            }
        }
        let boundary = mesh
            .boundary()
            .iter()
            .map(|f| {
                let v: Vec<u32> = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
                TaggedFacet { vertices: std::array::from_fn(|k| v[k]), condition: f.condition }
            })
            .collect();
        Self { vertices, cells: mesh.cells().to_vec(), boundary }
    }
    /// The same mesh with vertices renumbered, cells reordered and their vertices listed anyhow.
    pub fn shuffled(&self, random: &mut Random) -> Self {
        let permutation = |n: usize, random: &mut Random| {
            let mut p: Vec<usize> = (0..n).collect();
            for k in (1..n).rev() {
                p.swap(k, random.below(k + 1));
            }
            p
        };
        let p = permutation(self.vertices.len(), random);
        let mut vertices = self.vertices.clone();
        for (old, &new) in p.iter().enumerate() {
            vertices[new] = self.vertices[old];
        }
        let order = permutation(self.cells.len() / (D + 1), random);
        let mut cells = Vec::new();
        for c in order {
            let mut cell: Vec<u32> = self.cells[c * (D + 1)..(c + 1) * (D + 1)]
                .iter()
                .map(|&v| p[v as usize] as u32)
                .collect();
            for k in (1..=D).rev() {
                cell.swap(k, random.below(k + 1));
            }
            cells.extend(cell);
        }
        let boundary = self
            .boundary
            .iter()
            .map(|f| TaggedFacet {
                vertices: f.vertices.map(|v| p[v as usize] as u32),
                condition: f.condition,
            })
            .collect();
        Self { vertices, cells, boundary }
    }
    pub fn mesh(&self) -> Mesh<D> {
        Mesh::new(self.vertices.clone(), self.cells.clone(), &self.boundary).unwrap()
    }
}
