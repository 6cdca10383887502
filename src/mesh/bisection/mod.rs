//! Local refinement by conforming bisection, with the ancestors of cells and the parents of vertices.

mod midpoints;
mod ordered_cell;

use super::boundary::BoundaryFacet;
use super::edges::edge_vertices;
use super::error::{MeshError, MeshErrorKind};
use super::geometry::{CellGeometry, describe_point};
use super::part::extent::Extent;
use super::simplicial::Mesh;
use super::validate::check_size;
use crate::arrays::map_entries;
use crate::instances::compiled;
use crate::real::Point;
use midpoints::Midpoints;
use ordered_cell::OrderedCell;

/// A mesh that [`BisectedMesh::bisect`] refines locally: the mesh, and the edge at which each cell is
/// divided next.
///
/// The edges depend on the bisections before and cannot be read off a mesh. They bound the shapes: the
/// descendants of a cell have finitely many shapes, at any depth. In the initial mesh the edge of a cell
/// is its longest one. Any conforming mesh can be initial: in one dimension bisection halves cells, in
/// two it is newest vertex bisection, in three that of D. N. Arnold, A. Mukherjee and L. Pouly (SIAM J.
/// Sci. Comput. 22 (2000), 431-448), which puts no condition on the initial mesh.
///
/// ```
/// use unilateral::mesh::BisectedMesh;
/// use unilateral::prelude::*;
///
/// let square = BoxDomain::dirichlet(Point::from([0.0, 0.0]), Point::from([1.0, 1.0]));
/// let mut refined = BisectedMesh::new(Mesh::<2>::kuhn_box(&square, [4, 4])?);
/// for _ in 0..10 {
///     // towards a corner
///     let mesh = refined.mesh();
///     let marked: Vec<usize> = (0..mesh.n_cells()).filter(|&c| mesh.cell(c)[0] == 0).collect();
///     (refined, _) = refined.bisect(&marked)?;
/// }
/// assert!(refined.mesh().shortest_edge() < 0.01);
/// # Ok::<(), unilateral::mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BisectedMesh<const D: usize> {
    mesh: Mesh<D>,
    cells: Vec<OrderedCell>,
}

/// How a mesh follows from another one by bisection.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Bisection {
    /// For each cell of the new mesh the cell of the old mesh that contains it, ascending. A cell that
    /// is not divided is the only one with its ancestor.
    pub ancestors: Vec<u32>,
    /// For each vertex of the new mesh the two vertices of the new mesh whose midpoint it is, both of
    /// lower number; twice the vertex itself for a vertex of the old mesh, which keeps its number.
    ///
    /// Ascending in the vertices, the values `(value(a) + value(b)) / 2` at the new vertices continue a
    /// continuous piecewise linear function.
    pub parents: Vec<[u32; 2]>,
}

impl<const D: usize> BisectedMesh<D> {
    /// An initial mesh. Of edges of equal length the one whose vertices have higher numbers counts as
    /// longer.
    pub fn new(mesh: Mesh<D>) -> Self {
        let length = |[a, b]: [u32; 2]| {
            let [x, y] = map_entries([a, b], |v| mesh.vertices[v as usize]);
            (x - y).norm_squared()
        };
        let is_longer = |one: [u32; 2], other: [u32; 2]| {
            length(one).total_cmp(&length(other)).then(one.cmp(&other)).is_gt()
        };
        let cells = mesh.cells.chunks_exact(D + 1);
        let cells = cells.map(|cell| OrderedCell::new::<D>(cell, is_longer)).collect();
        Self { mesh, cells }
    }
    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }
    /// The mesh, without the edges at which its cells are divided next.
    pub fn into_mesh(self) -> Mesh<D> {
        self.mesh
    }

    /// Divides every marked cell at least once, and of the others those that must be divided for the
    /// mesh to be conforming. Neither the order of marks nor their repetition matters.
    ///
    /// A division cuts a cell into two of equal volume. Regions, boundary conditions and groups are
    /// inherited. New vertices are midpoints of edges; then they move onto the [shape](Mesh::with_shape) of a
    /// boundary group that has one.
    ///
    /// # Errors
    /// [`MeshErrorKind::Parameter`] for a marked cell that does not exist, [`MeshErrorKind::TooLarge`],
    /// [`MeshErrorKind::TooSmallToBisect`] for a cell at the size of rounding, and [`MeshErrorKind::Shape`].
    pub fn bisect(&self, marked: &[usize]) -> Result<(Self, Bisection), MeshError> {
        compiled!(const D: fn(
                &BisectedMesh<D>,
                &[usize],
            ) -> Result<(BisectedMesh<D>, Bisection), MeshError>
                = BisectedMesh::bisect_marked
        )(self, marked)
    }
    fn bisect_marked(&self, marked: &[usize]) -> Result<(Self, Bisection), MeshError> {
        let n_cells = self.cells.len();
        let mut is_marked = vec![false; n_cells];
        for &cell in marked {
            let Some(is_marked) = is_marked.get_mut(cell) else {
                let allowed = format!("less than {n_cells}, the number of cells");
                return Err(MeshError::parameter("marked cell", cell, allowed));
            };
            *is_marked = true;
        }
        let mut division = Division::new(self);
        for cell in (0..n_cells).filter(|&cell| is_marked[cell]) {
            division.divide(cell)?;
        }
        division.make_conforming()?;
        division.finish(&self.mesh)
    }
}

/// A cell of a mesh that is being refined.
#[derive(Clone, Copy)]
struct Leaf {
    cell: OrderedCell,
    /// For each facet, by the position of the opposite vertex, the boundary facet of the old mesh that
    /// contains it, or [`INTERIOR`].
    facets: [u32; 4],
    ancestor: u32,
}

impl Leaf {
    /// Sorts leaves by ancestor and keeps the order of equal ones; not generic, so that the sorting
    /// code is compiled once.
    fn sort(leaves: &mut [Self]) {
        leaves.sort_by_key(|leaf| leaf.ancestor);
    }
}

/// In the place of a boundary facet: the facet lies in the interior.
const INTERIOR: u32 = u32::MAX;

/// Largest relative change of the volume of half a cell by the rounding of its new vertex.
const VOLUME_CHANGE: f64 = 1e-2;

/// A mesh that is being refined.
struct Division<const D: usize> {
    vertices: Vec<Point<D>>,
    midpoints: Midpoints,
    leaves: Vec<Leaf>,
}

impl<const D: usize> Division<D> {
    fn new(BisectedMesh { mesh, cells }: &BisectedMesh<D>) -> Self {
        let leaf = |(ancestor, &cell)| Leaf { cell, facets: [INTERIOR; 4], ancestor };
        let mut leaves: Vec<Leaf> = (0..).zip(cells).map(leaf).collect();
        for (k, f) in (0..).zip(&mesh.boundary) {
            let opposite = mesh.cell(f.cell as usize)[f.local as usize];
            let Leaf { cell, facets, .. } = &mut leaves[f.cell as usize];
            for (facet, _) in facets.iter_mut().zip(cell.vertices).filter(|&(_, v)| v == opposite) {
                *facet = k;
            }
        }
        let midpoints = Midpoints::new(mesh.vertices.len());
        Self { vertices: mesh.vertices.clone(), midpoints, leaves }
    }

    /// Divides a leaf. The first child takes its place, the second one is the last leaf.
    fn divide(&mut self, at: usize) -> Result<(), MeshError> {
        check_size(self.leaves.len() + 1, self.vertices.len() + 1)?;
        let Leaf { cell, facets, ancestor } = self.leaves[at];
        let [a, b, ..] = cell.vertices;
        let midpoint = self.midpoints.get(a, b).unwrap_or_else(|| {
            let sum = self.vertices[a as usize] + self.vertices[b as usize];
            self.vertices.push(sum * 0.5);
            self.midpoints.add(a, b)
        });
        self.check_halves(&cell, midpoint, ancestor)?;
        let child = |k: usize| {
            let (child, positions) = cell.child::<D>(k, midpoint);
            // the facets opposite the vertices of the cell lie in its facets, but for the one between
            // the children; the facet opposite the midpoint is one of the cell
            let mut of_child = [INTERIOR; 4];
            for (facet, &position) in of_child[..D].iter_mut().zip(&positions) {
                *facet = if position == k { INTERIOR } else { facets[position] };
            }
            of_child[D] = facets[1 - k];
            Leaf { cell: child, facets: of_child, ancestor }
        };
        self.leaves[at] = child(0);
        self.leaves.push(child(1));
        Ok(())
    }

    /// Checks that both halves of a cell have half its volume, up to rounding.
    fn check_halves(
        &self,
        cell: &OrderedCell,
        midpoint: u32,
        ancestor: u32,
    ) -> Result<(), MeshError> {
        let vertex = |v: u32| self.vertices[v as usize];
        let whole = CellGeometry::new(|k| vertex(cell.vertices[k]));
        let is_half = |k: usize| {
            let mut vertices = cell.vertices;
            vertices[1 - k] = midpoint;
            let half = CellGeometry::new(|k| vertex(vertices[k]));
            let change = (2.0 * half.volume - whole.volume).abs();
            half.is_positive() == whole.is_positive() && change < VOLUME_CHANGE * whole.volume
        };
        if is_half(0) && is_half(1) {
            return Ok(());
        }
        let message = format!(
            "cell {ancestor} cannot be bisected at {}: rounding changes the volume of its halves; mark no cell there",
            describe_point(&vertex(midpoint))
        );
        let error = MeshError::new(MeshErrorKind::TooSmallToBisect, message);
        Err(error.of_cells([ancestor as usize]))
    }

    /// Divides leaves until none has a vertex in the middle of an edge.
    ///
    /// Every conforming refinement divides these leaves, so their order has no influence on the cells.
    fn make_conforming(&mut self) -> Result<(), MeshError> {
        let mut n_before = 0;
        while n_before < self.leaves.len() {
            n_before = self.leaves.len();
            let mut at = 0;
            while at < self.leaves.len() {
                let vertices = &self.leaves[at].cell.vertices;
                let is_divided =
                    |&[i, j]: &[usize; 2]| self.midpoints.get(vertices[i], vertices[j]).is_some();
                if edge_vertices(D).iter().any(is_divided) {
                    self.divide(at)?;
                } else {
                    at += 1;
                }
            }
        }
        Ok(())
    }

    /// The refined mesh of a mesh.
    fn finish(mut self, old: &Mesh<D>) -> Result<(BisectedMesh<D>, Bisection), MeshError> {
        Leaf::sort(&mut self.leaves);
        let mut cells = Vec::with_capacity(self.leaves.len() * (D + 1));
        let mut boundary = Vec::with_capacity(old.boundary.len());
        for (cell, leaf) in (0..).zip(&self.leaves) {
            let vertices = &leaf.cell.vertices[..=D];
            let start = cells.len();
            cells.extend_from_slice(vertices);
            cells[start..].sort_unstable();
            for (&facet, &opposite) in leaf.facets.iter().zip(vertices) {
                if facet != INTERIOR {
                    let local = vertices.iter().filter(|&&v| v < opposite).count() as u8;
                    boundary.push(BoundaryFacet { cell, local, ..old.boundary[facet as usize] });
                }
            }
        }
        BoundaryFacet::sort(&mut boundary);
        let ancestors: Vec<u32> = self.leaves.iter().map(|leaf| leaf.ancestor).collect();
        // a mesh with one region has no list of them
        let region = |&ancestor: &u32| old.cell_regions.get(ancestor as usize).copied();
        let mut mesh = Mesh {
            vertices: self.vertices,
            cells,
            boundary,
            is_supported: old.is_supported,
            groups: old.groups.clone(),
            cell_regions: ancestors.iter().filter_map(region).collect(),
            whole: old.whole.map(Extent::refined),
            shapes: old.shapes.clone(),
        };
        let parents = self.midpoints.parents;
        if old.has_shapes() {
            mesh.follow_shapes(&parents, |cell| ancestors[cell] as usize)?;
        }
        let cells = self.leaves.iter().map(|leaf| leaf.cell).collect();
        Ok((BisectedMesh { mesh, cells }, Bisection { ancestors, parents }))
    }
}
