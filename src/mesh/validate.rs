//! The construction of a mesh from lists of vertices, cells and boundary facets, with all checks.

use std::sync::Arc;

use super::boundary::{BoundaryCondition, BoundaryFacet};
use super::components::Components;
use super::error::{MeshError, MeshErrorKind};
use super::facets::{CELL_LIMIT, HalfFacet, Neighbours, facet_of};
use super::geometry::describe_point;
use super::groups::{BoundaryGroup, Groups};
use super::overlap::UNITE;
use super::shapes::shape::Shapes;
use super::simplicial::Mesh;
use crate::input::excerpt;
use crate::instances::compiled;
use crate::parallel::cells;
use crate::real::Point;

/// A facet of the boundary by its `D` vertices, in any order, and the condition that holds on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaggedFacet<const D: usize> {
    /// The vertices.
    pub vertices: [u32; D],
    /// The condition.
    pub condition: BoundaryCondition,
}

/// A facet of the boundary by its `D` vertices, in any order, and the number of a named group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupedFacet<const D: usize> {
    /// The vertices.
    pub vertices: [u32; D],
    /// Number of the group.
    pub group: u16,
}

impl<const D: usize> Mesh<D> {
    /// A mesh from vertices, cells (`D + 1` vertices each, in any order) and the conditions on its
    /// boundary facets.
    ///
    /// Vertices that no cell uses are dropped and the others renumbered in their order. Cells keep
    /// their order.
    ///
    /// # Errors
    /// [`MeshError`]. Vertices in errors are numbered as given. Folds across a facet are always found, overlaps of
    /// bodies where the middle of a facet of the boundary, or of its cell, lies in a cell of another body.
    pub fn new(
        vertices: Vec<Point<D>>,
        cells: Vec<u32>,
        boundary: &[TaggedFacet<D>],
    ) -> Result<Self, MeshError> {
        let grouped =
            |f: &TaggedFacet<D>| GroupedFacet { vertices: f.vertices, group: f.condition as u16 };
        let facets: Vec<_> = boundary.iter().map(grouped).collect();
        Self::with_groups(
            vertices,
            cells,
            &facets,
            &BoundaryCondition::ALL.map(|p| p.name().to_owned()),
        )
    }

    /// A mesh as [`Mesh::new`] makes it, with boundary facets in named groups, of which each may be in
    /// several. The names `dirichlet`, `neumann` and `contact` say which condition holds on their facets; the
    /// condition of other groups is decided by [`Mesh::with_boundary_conditions`]. Facets between two cells are
    /// left out of groups with other names.
    ///
    /// # Errors
    /// As [`Mesh::new`], and [`MeshErrorKind::Parameter`] for a number of a group without a name.
    pub fn with_groups(
        vertices: Vec<Point<D>>,
        cells: Vec<u32>,
        boundary: &[GroupedFacet<D>],
        names: &[String],
    ) -> Result<Self, MeshError> {
        compiled!(const D: fn(
                Vec<Point<D>>,
                Vec<u32>,
                &[GroupedFacet<D>],
                &[String],
            ) -> Result<Mesh<D>, MeshError>
                = Mesh::from_lists
        )(vertices, cells, boundary, names)
    }
    fn from_lists(
        vertices: Vec<Point<D>>,
        mut cells: Vec<u32>,
        boundary: &[GroupedFacet<D>],
        names: &[String],
    ) -> Result<Self, MeshError> {
        check_lists(&vertices, &cells)?;
        cells.chunks_exact_mut(D + 1).for_each(<[u32]>::sort_unstable);
        let mut mesh = Self::without_boundary(vertices, cells);
        let is_positive = mesh.check_volumes()?;
        let neighbours = Neighbours::match_facets::<D>(&mesh.cells, mesh.vertices.len())?;
        mesh.check_folds(&neighbours, &is_positive)?;
        let open: Vec<HalfFacet> =
            mesh.half_facets().filter(|&(c, local)| neighbours.is_unmatched(c, local)).collect();
        let mut components = Components::of_cells(&neighbours);
        let coincident = mesh.lie_on_others(&open, &mut components)?;
        let (boundary, groups) = mesh.match_boundary(&open, &coincident, (boundary, names))?;
        mesh.is_supported = is_supported(&mut components, &boundary);
        (mesh.boundary, mesh.groups) = (boundary, Arc::new(groups));
        mesh.drop_unused();
        Ok(mesh)
    }

    /// A mesh of cells with ascending vertices, one region, and no facets of the boundary.
    pub(super) fn without_boundary(vertices: Vec<Point<D>>, cells: Vec<u32>) -> Self {
        Self {
            vertices,
            cells,
            boundary: Vec::new(),
            is_supported: false,
            groups: Arc::default(),
            cell_regions: Vec::new(),
            whole: None,
            shapes: Shapes::default(),
        }
    }

    fn half_facets(&self) -> impl Iterator<Item = HalfFacet> + use<D> {
        (0..self.cells.len()).map(|k| (k / (D + 1), k % (D + 1)))
    }

    /// Refuses cells whose volume is at the rounding level of its diameter: their gradients are lost.
    /// Returns whether the determinant of the edges of each cell is positive.
    fn check_volumes(&self) -> Result<Vec<bool>, MeshError> {
        let check = |c: usize| {
            let geometry = self.geometry(c);
            let (volume, diameter) = (geometry.volume, self.cell_diameter(c));
            let scaled = volume / diameter.powi(D as i32);
            // overflow and underflow count as degenerate
            if scaled.is_nan() || scaled <= 8.0 * f64::EPSILON {
                let cell = self.cell(c);
                let message = format!(
                    "cell {c} is degenerate: volume {volume:e} against diameter {diameter:e} (vertices {cell:?})"
                );
                let error = MeshError::new(MeshErrorKind::DegenerateCell, message);
                return Err(error.of_cells([c]).of_vertices(cell));
            }
            Ok(geometry.is_positive())
        };
        let groups = cells::map(self.n_cells(), &|range| {
            range.map(check).collect::<Result<Vec<bool>, MeshError>>()
        });
        Ok(groups.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// Gives every facet of the boundary its group and condition.
    fn match_boundary(
        &self,
        open: &[HalfFacet],
        coincident: &[usize],
        (grouped, names): (&[GroupedFacet<D>], &[String]),
    ) -> Result<(Vec<BoundaryFacet>, Groups), MeshError> {
        let sorted = self.by_vertices(&mut open.iter().copied());
        let GroupSets { sets, of_facets, has_inner } = self.group_sets(&sorted, grouped, names)?;
        let mut boundary = Vec::with_capacity(open.len());
        // sets without a facet are left out
        let mut sets_used: Vec<Option<u16>> = vec![None; sets.len()];
        let mut groups: Vec<BoundaryGroup> = Vec::new();
        for (key, k) in sorted {
            let (cell, local) = open[k];
            let Some(set) = of_facets[k] else {
                let message = format!(
                    "boundary facet {key:?} of cell {cell}, at {}, is in no group: {}",
                    describe_point(&self.facet_barycentre(cell, local)),
                    remedy(coincident.contains(&k).then_some(coincident.len()))
                );
                let error = MeshError::new(MeshErrorKind::UntaggedFacet, message);
                return Err(error.of_cells([cell]).of_vertices(&key));
            };
            let group = *sets_used[set].get_or_insert_with(|| {
                let of_set = sets[set].iter().map(|&group| names[group].clone()).collect();
                let condition = condition_of(&sets[set], names);
                groups.push(BoundaryGroup { condition, names: of_set });
                (groups.len() - 1) as u16
            });
            let condition =
                groups[usize::from(group)].condition.unwrap_or(BoundaryCondition::Neumann);
            boundary.push(BoundaryFacet {
                cell: cell as u32,
                local: local as u8,
                condition,
                group,
            });
        }
        if groups.len() > usize::from(u16::MAX) {
            let limit = usize::from(u16::MAX);
            return Err(MeshError::too_large("boundary groups", groups.len(), limit));
        }
        BoundaryFacet::sort(&mut boundary);
        let inside = names.iter().zip(has_inner).filter(|(_, has)| *has);
        let inside = inside.map(|(name, _)| name.clone()).collect();
        Ok((boundary, Groups { regions: vec![Vec::new()], boundary: groups, inside }))
    }

    /// Facets by their vertices, sorted, with their positions.
    fn by_vertices(&self, facets: &mut dyn Iterator<Item = HalfFacet>) -> Vec<([u32; D], usize)> {
        let vertices = |(c, local): HalfFacet| facet_of::<D>(self.cell(c), local);
        let mut all: Vec<_> = facets.enumerate().map(|(k, f)| (vertices(f), k)).collect();
        all.sort_unstable();
        all
    }

    /// The sets of groups of the facets of the boundary, which are sorted by their vertices.
    fn group_sets(
        &self,
        open: &[([u32; D], usize)],
        grouped: &[GroupedFacet<D>],
        names: &[String],
    ) -> Result<GroupSets, MeshError> {
        let find = |all: &[([u32; D], usize)], facet: &[u32; D]| {
            all.binary_search_by(|(vertices, _)| vertices.cmp(facet)).ok().map(|k| all[k].1)
        };
        let mut all: Option<Vec<_>> = None;
        let mut sets: Vec<Vec<usize>> = (0..names.len()).map(|group| vec![group]).collect();
        let mut of_facets: Vec<Option<usize>> = vec![None; open.len()];
        let mut has_inner = vec![false; names.len()];
        for (tag, t) in grouped.iter().enumerate() {
            let group = usize::from(t.group);
            let Some(name) = names.get(group) else {
                let allowed = format!("less than {}, the number of names", names.len());
                return Err(MeshError::parameter("group of a facet", group, allowed));
            };
            let mut key = t.vertices;
            key.sort_unstable();
            let refused = |kind: MeshErrorKind, why: String| {
                let error = MeshError::new(kind, format!("facet {key:?} is in {why}"));
                Err(error.of_vertices(&key).of_tagged_facet(tag))
            };
            let Some(k) = find(open, &key) else {
                let all = all.get_or_insert_with(|| self.by_vertices(&mut self.half_facets()));
                let is_inside = find(all, &key).is_some();
                if is_inside && BoundaryCondition::from_name(name).is_none() {
                    has_inner[group] = true;
                    continue;
                }
                let why = if is_inside { "lies between two cells" } else { "belongs to no cell" };
                let why = format!("group {} but {why}", excerpt(name));
                return refused(MeshErrorKind::NotABoundaryFacet, why);
            };
            let Some(first) = of_facets[k] else {
                of_facets[k] = Some(group);
                continue;
            };
            let conditions =
                (condition_of(&sets[first], names), BoundaryCondition::from_name(name));
            if let (Some(one), Some(two)) = conditions
                && one != two
            {
                let (one, two) = (one.name(), two.name());
                let why =
                    format!("two groups, {one} and {two}, with different boundary conditions");
                return refused(MeshErrorKind::FacetWithTwoConditions, why);
            }
            let mut union = [&sets[first][..], &[group]].concat();
            union.sort_unstable();
            union.dedup();
            let known = sets.iter().position(|set| *set == union);
            of_facets[k] = known.or(Some(sets.len()));
            if known.is_none() {
                sets.push(union);
            }
        }
        Ok(GroupSets { sets, of_facets, has_inner })
    }

    /// Drops vertices that no cell has. The others keep their order, and so the vertices of a cell ascend.
    fn drop_unused(&mut self) {
        let mut number = vec![0_u32; self.vertices.len()];
        self.cells.iter().for_each(|&v| number[v as usize] = 1);
        let mut used = 0;
        for v in 0..self.vertices.len() {
            if number[v] == 1 {
                self.vertices[used as usize] = self.vertices[v];
                number[v] = used;
                used += 1;
            }
        }
        self.vertices.truncate(used as usize);
        self.cells.iter_mut().for_each(|v| *v = number[*v as usize]);
    }
}

/// Whether every component of a mesh, connected through facets, has a Dirichlet facet.
pub(super) fn is_supported(components: &mut Components, boundary: &[BoundaryFacet]) -> bool {
    let mut has_dirichlet = vec![false; components.len()];
    for facet in boundary.iter().filter(|facet| facet.condition == BoundaryCondition::Dirichlet) {
        has_dirichlet[components.find(facet.cell as usize)] = true;
    }
    (0..components.len()).all(|cell| has_dirichlet[components.find(cell)])
}

fn check_lists<const D: usize>(vertices: &[Point<D>], cells: &[u32]) -> Result<(), MeshError> {
    let per_cell = D + 1;
    if cells.is_empty() {
        let message = format!("the mesh has no cells of dimension {D}");
        return Err(MeshError::new(MeshErrorKind::NoCells, message));
    }
    if !cells.len().is_multiple_of(per_cell) {
        let message = format!("{} cell vertices do not make cells of {per_cell}", cells.len());
        return Err(MeshError::new(MeshErrorKind::IncompleteCell, message));
    }
    check_size(cells.len() / per_cell, vertices.len())?;
    for (vertex, x) in vertices.iter().enumerate() {
        if let Some(axis) = (0..D).find(|&k| !x[k].is_finite()) {
            let message = format!(
                "coordinate {axis} of vertex {vertex} is {}: coordinates must be finite",
                x[axis]
            );
            let error = MeshError::new(MeshErrorKind::NotFinite, message);
            return Err(error.of_vertices(&[vertex as u32]));
        }
    }
    if let Some(k) = cells.iter().position(|&v| v as usize >= vertices.len()) {
        let (cell, vertex) = (k / per_cell, cells[k]);
        let message =
            format!("cell {cell} names vertex {vertex}, but there are only {}", vertices.len());
        return Err(MeshError::new(MeshErrorKind::VertexOutOfRange, message).of_cells([cell]));
    }
    Ok(())
}

/// Refuses meshes that 32-bit numbers cannot address.
pub(super) fn check_size(cells: usize, vertices: usize) -> Result<(), MeshError> {
    for (what, count, limit) in
        [("cells", cells, CELL_LIMIT), ("vertices", vertices, u32::MAX as usize - 1)]
    {
        if count > limit {
            return Err(MeshError::too_large(what, count, limit));
        }
    }
    Ok(())
}

/// Sets of groups by number.
struct GroupSets {
    /// First a set with each group alone.
    sets: Vec<Vec<usize>>,
    /// The set of each facet of the boundary.
    of_facets: Vec<Option<usize>>,
    /// Whether each group has facets between two cells.
    has_inner: Vec<bool>,
}

/// The condition that one of the names of a set of groups stands for.
fn condition_of(set: &[usize], names: &[String]) -> Option<BoundaryCondition> {
    set.iter().find_map(|&group| BoundaryCondition::from_name(&names[group]))
}

/// What to do with a boundary facet in no group; where it lies on another one, given how many facets do.
fn remedy(coincident: Option<usize>) -> String {
    match coincident {
        None => "put it in one; the names dirichlet, neumann, contact say what holds there, for other names a problem does".to_owned(),
        Some(n) => format!(
            "it lies on another one, with nodes of its own, as {n} facets do; {UNITE}, or put both sides of a slit in groups"
        ),
    }
}
