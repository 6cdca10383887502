//! Boundary groups with a shape: refinement moves new vertices of their facets onto it.

pub(in crate::mesh) mod shape;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::input::excerpt;
use crate::mesh::boundary::BoundaryFacet;
use crate::mesh::error::{MeshError, MeshErrorKind};
use crate::mesh::geometry::{CellGeometry, describe_point};
use crate::mesh::part::extent::Extent;
use crate::mesh::simplicial::Mesh;
use crate::real::Point;
use shape::{Shape, Shapes, ascending, normal_of, to_zero};

/// Vertices of a group are nearer to the zero of its shape than this share of their facets: files round them.
const ROUNDED: f64 = 1e-3;
/// A new vertex moves by at most this share of the edge whose middle it is: the arc is at most half a circle.
const FARTHEST: f64 = 0.5;
/// A cell keeps at least this share of its volume.
const COLLAPSED: f64 = 1e-3;

impl<const D: usize> Mesh<D> {
    /// The mesh with the shape of a boundary group: a function that is zero on the curve or surface on which the vertices
    /// of the group lie. Uniform refinement and bisection move new vertices of its facets there, from the middles of
    /// edges along the gradient. A second shape of a group takes the place of the first.
    ///
    /// A new vertex on an edge in space between two groups with a shape moves to where both are zero; beside a group
    /// without one it leaves the plane of that group, unless the gradient lies in it. A cell with two facets on one curve
    /// becomes flatter with each refinement: a mesh without such cells keeps its angles.
    ///
    /// ```
    /// use unilateral::prelude::*;
    ///
    /// let hexagon = Mesh::<2>::disc(1.0, 1)?;
    /// let (fine, _) = hexagon.with_shape("dirichlet", |x| x.norm_squared() - 1.0)?.refine()?;
    /// let on_circle = |x: &&Point<2>| (x.norm() - 1.0).abs() < 1e-15;
    /// assert_eq!(fine.vertices().iter().filter(on_circle).count(), 12);
    /// # Ok::<(), unilateral::mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshErrorKind::Shape`] in one dimension, on a part, for a group that the mesh does not have and for a shape that
    /// is not zero near the vertices of the group. Refinement gives it for a new vertex without a zero within half the
    /// length of its edge and for a cell that turns over.
    pub fn with_shape(
        mut self,
        group: &str,
        shape: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Result<Self, MeshError> {
        let shape: Shape<D> = Arc::new(shape);
        self.check_shape(group, &shape)?;
        self.shapes.named.retain(|(name, _)| name != group);
        self.shapes.named.push((group.to_owned(), shape));
        Ok(self)
    }
    /// Whether some boundary group has a shape, so that refinements are not nested.
    pub fn has_shapes(&self) -> bool {
        !self.shapes.named.is_empty()
    }
    /// The middle of a facet of the boundary and the outward normal there, both on the shape of its group if it has one.
    pub(crate) fn middle_of(&self, facet: &BoundaryFacet) -> (Point<D>, Point<D>) {
        let (cell, local) = (facet.cell as usize, usize::from(facet.local));
        let (x, normal) = (self.facet_barycentre(cell, local), self.geometry(cell).normal(local));
        let length = self.facet_diameter(cell, local);
        let shapes: Vec<_> = self.shapes.of(self.names_of(facet)).collect();
        let Some((shape, x)) = shapes.first().zip(to_zero(&shapes, &x, length)) else {
            return (x, normal);
        };
        let along = normal_of(shape, &x, length);
        (x, along * along.dot(&normal).signum())
    }
    fn names_of(&self, facet: &BoundaryFacet) -> &[String] {
        &self.groups.boundary[usize::from(facet.group)].names
    }
    fn is_shaped(&self, facet: &BoundaryFacet) -> bool {
        self.shapes.of(self.names_of(facet)).next().is_some()
    }

    fn check_shape(&self, group: &str, shape: &Shape<D>) -> Result<(), MeshError> {
        let refuse = |why: &str| {
            let message = format!("the shape of boundary group {}: {why}", excerpt(group));
            Err(MeshError::new(MeshErrorKind::Shape, message))
        };
        if D == 1 {
            return refuse("in one dimension a boundary is points, which have none");
        }
        if self.is_part() {
            return refuse("give it to the whole mesh, of which this one is a part");
        }
        let is_meant = |facet: &&BoundaryFacet| self.names_of(facet).iter().any(|n| n == group);
        let mut facets = self.boundary.iter().filter(is_meant).peekable();
        if facets.peek().is_none() {
            return refuse("the mesh has no such group");
        }
        for facet in facets {
            let (cell, local) = (facet.cell as usize, usize::from(facet.local));
            let length = self.facet_diameter(cell, local);
            for v in self.facet_vertices(cell, local) {
                let x = &self.vertices[v as usize];
                let distance = to_zero(&[shape], x, length).map(|zero| (zero - x).norm());
                if distance.is_none_or(|distance| distance > ROUNDED * length) {
                    let place = describe_point(x);
                    let found = distance.map_or("not near".to_owned(), |d| format!("{d:.1e} from"));
                    return refuse(&format!(
                        "it must be zero at the vertices of the group, but its zero is {found} vertex {v} at {place}"
                    ));
                }
            }
        }
        Ok(())
    }

    /// The shapes on a part of the mesh, of the cells that are taken and the vertices that have a number.
    pub(in crate::mesh) fn shapes_of_part(
        &self,
        is_taken: impl Fn(u32) -> bool,
        numbers: &[u32],
    ) -> Shapes<D> {
        let mut shapes = self.shapes.renumbered(numbers);
        let is_beyond = |f: &&BoundaryFacet| D == 3 && !is_taken(f.cell) && self.is_shaped(f);
        for facet in self.boundary.iter().filter(is_beyond) {
            let vertices = self.facet_vertices(facet.cell as usize, usize::from(facet.local));
            let here = vertices.map(|v| numbers[v as usize]).filter(|&v| v != u32::MAX);
            let here: Vec<u32> = here.collect();
            let pairs = here.iter().flat_map(|&a| here.iter().map(move |&b| [a, b]));
            let edges = pairs.filter(|[a, b]| a < b).map(|edge| (edge, facet.group));
            shapes.cut_edges.extend(edges);
        }
        shapes
    }

    /// Moves the new vertices of a refined mesh, which are the middles of their parents, two vertices of this mesh; twice
    /// the same for one that is not new. Parents that are new come before their children. `ancestor` is the cell of the
    /// coarse mesh.
    pub(in crate::mesh) fn follow_shapes(
        &mut self,
        parents: &[[u32; 2]],
        ancestor: impl Fn(usize) -> usize,
    ) -> Result<(), MeshError> {
        let is_new = |v: u32| parents[v as usize][0] != parents[v as usize][1];
        let mut groups: BTreeSet<(u32, u16)> = BTreeSet::new();
        for facet in self.boundary.iter().filter(|facet| self.is_shaped(facet)) {
            let vertices = self.facet_vertices(facet.cell as usize, usize::from(facet.local));
            groups.extend(vertices.filter(|&v| is_new(v)).map(|v| (v, facet.group)));
        }
        let flat = self.vertices.clone();
        for (v, &[a, b]) in (0..).zip(parents).filter(|&(v, _)| is_new(v)) {
            let (edge, edges) = (ascending(a, b), &mut self.shapes.cut_edges);
            while let Some(&(_, group)) = edges.range((edge, 0)..=(edge, u16::MAX)).next() {
                edges.remove(&(edge, group));
                edges.extend([(ascending(a, v), group), (ascending(v, b), group)]);
                groups.insert((v, group));
            }
            let ends = [a, b].map(|v| self.vertices[v as usize]);
            let on = groups.range((v, 0)..=(v, u16::MAX)).map(|(_, group)| *group);
            self.vertices[v as usize] = self.middle_on(on, ends)?;
        }
        self.whole = self.whole.map(Extent::moved);
        self.check_orientation(&flat, ancestor)
    }

    /// The zero of the shapes of boundary groups near the middle of an edge between two points; the middle without groups.
    fn middle_on(
        &self,
        groups: impl Iterator<Item = u16>,
        [x, y]: [Point<D>; 2],
    ) -> Result<Point<D>, MeshError> {
        let middle = (x + y) * 0.5;
        let names = groups.flat_map(|group| &self.groups.boundary[usize::from(group)].names);
        let names: Vec<&String> = names.collect();
        if names.is_empty() {
            return Ok(middle);
        }
        let named = self.shapes.named.iter().filter(|(name, _)| names.contains(&name));
        let (names, shapes): (Vec<_>, Vec<_>) = named.map(|(n, shape)| (excerpt(n), shape)).unzip();
        let (length, farthest) = ((x - y).norm(), FARTHEST * (x - y).norm());
        let zero = to_zero(&shapes, &middle, length).filter(|z| (z - middle).norm() <= farthest);
        zero.ok_or_else(|| {
            let message = format!(
                "the shape of boundary group {} has no zero within {farthest:.1e} of {}, half the length of the edge in whose middle a new vertex is: correct the shape, or make smaller cells there",
                names.join(", "),
                describe_point(&middle)
            );
            MeshError::new(MeshErrorKind::Shape, message)
        })
    }

    /// Checks that no cell turned over when its vertices moved.
    fn check_orientation(
        &self,
        before: &[Point<D>],
        ancestor: impl Fn(usize) -> usize,
    ) -> Result<(), MeshError> {
        for c in 0..self.n_cells() {
            let cell = self.cell(c);
            if cell.iter().all(|&v| self.vertices[v as usize] == before[v as usize]) {
                continue;
            }
            let (old, new) = (CellGeometry::new(|k| before[cell[k] as usize]), self.geometry(c));
            let is_kept = new.is_positive() == old.is_positive();
            if !(is_kept && new.volume >= COLLAPSED * old.volume) {
                let cell = ancestor(c);
                let message = format!(
                    "a cell within cell {cell} turns over at {}, where new vertices move onto the shape of their boundary group: make smaller cells there, or a mesh that follows the shape more closely",
                    describe_point(&self.barycentre(c))
                );
                return Err(MeshError::new(MeshErrorKind::Shape, message).of_cells([cell]));
            }
        }
        Ok(())
    }
}
