//! Uniform refinement, with the parent relation kept.

use super::validate::check_size;
use super::{BoundaryFacet, Mesh, MeshError};
use crate::real::{Point, Real};

/// How the vertices of a refined mesh came from those of the coarse one.
///
/// Fine cell `c` lies in coarse cell `c / 2^D`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// The two coarse vertices whose midpoint each fine vertex is; twice the same for a vertex that
    /// was there before.
    pub parents: Vec<[u32; 2]>,
}

/// Children of a simplex. A vertex is the midpoint of two vertices of the parent, named by their
/// local numbers.
type Children = &'static [&'static [[usize; 2]]];

/// The corner children first, then, in three dimensions, the inner octahedron cut around the edge
/// from the midpoint of vertices 0 and 2 to that of 1 and 3.
///
/// Every list is ascending in lexicographic order. Source: J. Bey, Computing 55 (1995), 355-378,
/// whose rule this is, and who shows that it makes at most three classes of congruent tetrahedra
/// of each initial one.
const fn children(dimension: usize) -> Children {
    match dimension {
        1 => &[&[[0, 0], [0, 1]], &[[0, 1], [1, 1]]],
        2 => &[
            &[[0, 0], [0, 1], [0, 2]],
            &[[0, 1], [1, 1], [1, 2]],
            &[[0, 2], [1, 2], [2, 2]],
            &[[0, 1], [0, 2], [1, 2]],
        ],
        _ => &[
            &[[0, 0], [0, 1], [0, 2], [0, 3]],
            &[[0, 1], [1, 1], [1, 2], [1, 3]],
            &[[0, 2], [1, 2], [2, 2], [2, 3]],
            &[[0, 3], [1, 3], [2, 3], [3, 3]],
            &[[0, 1], [0, 2], [0, 3], [1, 3]],
            &[[0, 1], [0, 2], [1, 2], [1, 3]],
            &[[0, 2], [0, 3], [1, 3], [2, 3]],
            &[[0, 2], [1, 2], [1, 3], [2, 3]],
        ],
    }
}

/// The fine vertices, numbered by their pair of coarse parents in lexicographic order.
///
/// This order is what makes repeated refinement work without storing how a cell was made: the
/// children's vertices, ascending, come out in the order Bey's rule needs for the next step.
struct Midpoints {
    starts: Vec<u32>,
    upper: Vec<u32>,
}

impl Midpoints {
    fn new<T: Real, const D: usize>(mesh: &Mesh<T, D>) -> Self {
        let n = mesh.vertices().len();
        let mut starts = vec![0_u32; n + 1];
        for cell in mesh.cells().chunks_exact(D + 1) {
            for (i, &a) in cell.iter().enumerate() {
                starts[a as usize + 1] += (D - i) as u32;
            }
        }
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        let mut upper = vec![0_u32; starts[n] as usize];
        let mut fill = starts.clone();
        for cell in mesh.cells().chunks_exact(D + 1) {
            for (i, &a) in cell.iter().enumerate() {
                for &b in &cell[i + 1..] {
                    upper[fill[a as usize] as usize] = b;
                    fill[a as usize] += 1;
                }
            }
        }
        let mut kept = 0;
        for v in 0..n {
            let (begin, end) = (starts[v] as usize, starts[v + 1] as usize);
            upper[begin..end].sort_unstable();
            starts[v] = kept as u32;
            for k in begin..end {
                let b = upper[k];
                if k == begin || b != upper[kept - 1] || kept == starts[v] as usize {
                    upper[kept] = b;
                    kept += 1;
                }
            }
        }
        starts[n] = kept as u32;
        upper.truncate(kept);
        Self { starts, upper }
    }

    fn range(&self, a: u32) -> std::ops::Range<usize> {
        self.starts[a as usize] as usize..self.starts[a as usize + 1] as usize
    }

    /// Number of the midpoint of `a <= b`.
    fn number(&self, a: u32, b: u32) -> u32 {
        let base = a + self.starts[a as usize];
        if a == b {
            base
        } else {
            let range = self.range(a);
            let position = self.upper[range].iter().position(|&u| u == b).unwrap_or(0);
            base + 1 + position as u32
        }
    }

    fn parents(&self) -> Vec<[u32; 2]> {
        let n = self.starts.len() - 1;
        let mut parents = Vec::with_capacity(n + self.upper.len());
        for a in 0..n as u32 {
            parents.push([a, a]);
            parents.extend(self.upper[self.range(a)].iter().map(|&b| [a, b]));
        }
        parents
    }
}

impl<T: Real, const D: usize> Mesh<T, D> {
    /// Cuts every cell into `2^D` of equal volume; boundary parts are inherited.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn refine(&self) -> Result<(Self, Refinement), MeshError> {
        let children = children(D);
        let n_fine = self.n_cells().saturating_mul(children.len());
        check_size(n_fine, 0)?;
        let midpoints = Midpoints::new(self);
        let parents = midpoints.parents();
        check_size(n_fine, parents.len())?;
        let half = T::lit(0.5);
        let vertices: Vec<Point<T, D>> = parents
            .iter()
            .map(|&[a, b]| {
                if a == b {
                    self.vertices[a as usize]
                } else {
                    (self.vertices[a as usize] + self.vertices[b as usize]) * half
                }
            })
            .collect();
        let mut cells = Vec::with_capacity(n_fine * (D + 1));
        for cell in self.cells.chunks_exact(D + 1) {
            for child in children {
                cells.extend(child.iter().map(|&[i, j]| midpoints.number(cell[i], cell[j])));
            }
        }
        let mut boundary = Vec::with_capacity(self.boundary.len() << (D - 1));
        for facet in &self.boundary {
            for (k, child) in children.iter().enumerate() {
                // a fine facet lies on the coarse one if no vertex of it involves the opposite one
                let off = |v: &[usize; 2]| v.contains(&(facet.local as usize));
                for local in 0..=D {
                    if child.iter().enumerate().all(|(i, v)| i == local || !off(v)) {
                        let cell = facet.cell * children.len() as u32 + k as u32;
                        boundary.push(BoundaryFacet { cell, local: local as u8, part: facet.part });
                    }
                }
            }
        }
        boundary.sort_unstable_by_key(|f| (f.cell, f.local));
        Ok((Self { vertices, cells, boundary }, Refinement { parents }))
    }
}

/// Nested meshes, coarse to fine, each a uniform refinement of the one before.
#[derive(Clone, Debug)]
pub struct Hierarchy<T, const D: usize> {
    meshes: Vec<Mesh<T, D>>,
    refinements: Vec<Refinement>,
}

impl<T: Real, const D: usize> Hierarchy<T, D> {
    /// One mesh and nothing coarser.
    pub fn single(mesh: Mesh<T, D>) -> Self {
        Self { meshes: vec![mesh], refinements: Vec::new() }
    }
    /// A mesh and `times` refinements of it.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn refined(coarsest: Mesh<T, D>, times: usize) -> Result<Self, MeshError> {
        let mut hierarchy = Self::single(coarsest);
        for _ in 0..times {
            let (fine, refinement) = hierarchy.finest().refine()?;
            hierarchy.meshes.push(fine);
            hierarchy.refinements.push(refinement);
        }
        Ok(hierarchy)
    }
    /// The meshes, coarse to fine.
    pub fn meshes(&self) -> &[Mesh<T, D>] {
        &self.meshes
    }
    /// The refinement that made mesh `k + 1` of mesh `k`.
    pub fn refinements(&self) -> &[Refinement] {
        &self.refinements
    }
    /// The finest mesh.
    pub fn finest(&self) -> &Mesh<T, D> {
        &self.meshes[self.meshes.len() - 1]
    }
}
