//! The construction of a mesh from lists of vertices, cells and boundary facets, with all checks.

use std::sync::Arc;

use super::boundary::{BoundaryCondition, BoundaryFacet};
use super::components::Components;
use super::error::{MeshError, MeshErrorKind, UNITE};
use super::facets::{CELL_LIMIT, Neighbours, facet_of};
use super::geometry::simplex::longest_edge;
use super::geometry::{CellGeometry, describe_point};
use super::groups::{BoundaryGroup, Groups, NameSets};
use super::overlap::{check_folds, check_overlaps, lie_on_others};
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
    /// [`MeshError`]. Vertices in errors are numbered as given. Folds across a facet are always found, other
    /// overlaps where one of the lines through boundary facets meets them: through all up to 64, through eight
    /// from 512 facets on.
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
        for cell in cells.chunks_exact_mut(D + 1) {
            cell.sort_unstable();
        }
        let is_positive = check_volumes::<D>(&vertices, &cells)?;
        let neighbours = Neighbours::match_facets::<D>(&cells, vertices.len())?;
        check_folds::<D>(&cells, &neighbours, &is_positive)?;
        let (boundary, groups) = match_boundary(&vertices, &cells, &neighbours, (boundary, names))?;
        check_overlaps(&vertices, &cells, &boundary)?;
        let is_supported = is_supported(&neighbours, &boundary);
        let (vertices, cells) = drop_unused(vertices, cells);
        let groups = Arc::new(groups);
        let cell_regions = Vec::new();
        let (whole, shapes) = (None, Shapes::default());
        Ok(Self { vertices, cells, boundary, is_supported, groups, cell_regions, whole, shapes })
    }
}

/// Whether every component of a mesh, connected through facets, has a Dirichlet facet.
pub(super) fn is_supported(neighbours: &Neighbours, boundary: &[BoundaryFacet]) -> bool {
    let mut components = Components::of_cells(neighbours);
    let mut has_dirichlet = vec![false; neighbours.n_cells()];
    for facet in boundary.iter().filter(|facet| facet.condition == BoundaryCondition::Dirichlet) {
        has_dirichlet[components.find(facet.cell as usize)] = true;
    }
    (0..neighbours.n_cells()).all(|cell| has_dirichlet[components.find(cell)])
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

/// Refuses cells whose volume is at the rounding level of its diameter: their gradients are lost.
/// Returns whether the determinant of the edges of each cell is positive.
fn check_volumes<const D: usize>(
    vertices: &[Point<D>],
    cells: &[u32],
) -> Result<Vec<bool>, MeshError> {
    let check = |c: usize| {
        let cell = &cells[c * (D + 1)..][..D + 1];
        let corner = |k: usize| vertices[cell[k] as usize];
        let geometry = CellGeometry::new(corner);
        let volume = geometry.volume;
        let diameter = longest_edge(corner, None);
        let scaled = volume / diameter.powi(D as i32);
        // overflow and underflow count as degenerate
        if scaled.is_nan() || scaled <= 8.0 * f64::EPSILON {
            let message = format!(
                "cell {c} is degenerate: volume {volume:e} against diameter {diameter:e} (vertices {cell:?})"
            );
            let error = MeshError::new(MeshErrorKind::DegenerateCell, message);
            return Err(error.of_cells([c]).of_vertices(cell));
        }
        Ok(geometry.is_positive())
    };
    let groups = cells::map(cells.len() / (D + 1), &|range| {
        range.map(check).collect::<Result<Vec<bool>, MeshError>>()
    });
    let mut is_positive = Vec::with_capacity(cells.len() / (D + 1));
    for group in groups {
        is_positive.extend(group?);
    }
    Ok(is_positive)
}

/// A boundary facet by its ascending vertices, its cell and its number in the cell.
type OpenFacet<const D: usize> = ([u32; D], usize, usize);

/// The condition that one of the names of a group stands for.
fn condition_of(names: &[String]) -> Option<BoundaryCondition> {
    names.iter().find_map(|name| BoundaryCondition::from_name(name))
}

/// Gives every facet of the boundary its group and condition.
fn match_boundary<const D: usize>(
    vertices: &[Point<D>],
    cells: &[u32],
    neighbours: &Neighbours,
    (grouped, names): (&[GroupedFacet<D>], &[String]),
) -> Result<(Vec<BoundaryFacet>, Groups), MeshError> {
    let facet = |c: usize, local: usize| facet_of::<D>(&cells[c * (D + 1)..][..D + 1], local);
    let half_facets = || (0..cells.len()).map(|k| (k / (D + 1), k % (D + 1)));
    let mut open: Vec<OpenFacet<D>> = half_facets()
        .filter(|&(c, local)| neighbours.is_unmatched(c, local))
        .map(|(c, local)| (facet(c, local), c, local))
        .collect();
    open.sort_unstable();
    let mut sets = NameSets::new(names);
    let mut set_of: Vec<Option<usize>> = vec![None; open.len()];
    let mut inside: Option<Vec<[u32; D]>> = None;
    let mut has_inner = vec![false; names.len()];
    for (tag, t) in grouped.iter().enumerate() {
        let group = usize::from(t.group);
        let Some(name) = names.get(group) else {
            let allowed = format!("less than {}, the number of names", names.len());
            return Err(MeshError::parameter("group of a facet", group, allowed));
        };
        let mut key = t.vertices;
        key.sort_unstable();
        let Ok(k) = open.binary_search_by(|o| o.0.cmp(&key)) else {
            let inside = inside.get_or_insert_with(|| {
                let mut all: Vec<_> = half_facets().map(|(c, local)| facet(c, local)).collect();
                all.sort_unstable();
                all
            });
            let is_inside = inside.binary_search(&key).is_ok();
            if is_inside && BoundaryCondition::from_name(name).is_none() {
                has_inner[group] = true;
                continue;
            }
            let why = if is_inside { "lies between two cells" } else { "belongs to no cell" };
            let message = format!("facet {key:?} is in group {} but {why}", excerpt(name));
            let error = MeshError::new(MeshErrorKind::NotABoundaryFacet, message);
            return Err(error.of_vertices(&key).of_tagged_facet(tag));
        };
        let Some(first) = set_of[k] else {
            set_of[k] = Some(group);
            continue;
        };
        if let (Some(one), Some(two)) =
            (condition_of(sets.names(first)), BoundaryCondition::from_name(name))
            && one != two
        {
            let message = format!(
                "facet {key:?} is in two groups, {} and {}, with different boundary conditions",
                one.name(),
                two.name()
            );
            let error = MeshError::new(MeshErrorKind::FacetWithTwoConditions, message);
            return Err(error.of_vertices(&key).of_tagged_facet(tag));
        }
        set_of[k] = Some(sets.union(first, group));
    }
    let mut boundary = Vec::with_capacity(open.len());
    // sets without a facet are left out
    let mut sets_used: Vec<Option<u16>> = Vec::new();
    let mut groups = Vec::new();
    for (&(key, cell, local), set) in open.iter().zip(set_of) {
        let Some(set) = set else {
            let sum = key.iter().fold(Point::<D>::zeros(), |s, &v| s + vertices[v as usize]);
            let message = format!(
                "boundary facet {key:?} of cell {cell}, at {}, is in no group: {}",
                describe_point(&(sum / D as f64)),
                remedy(coincident(vertices, &open, key))
            );
            let error = MeshError::new(MeshErrorKind::UntaggedFacet, message);
            return Err(error.of_cells([cell]).of_vertices(&key));
        };
        sets_used.resize(sets_used.len().max(set + 1), None);
        let group = *sets_used[set].get_or_insert_with(|| {
            let names = sets.names(set).to_vec();
            groups.push(BoundaryGroup { condition: condition_of(&names), names });
            (groups.len() - 1) as u16
        });
        let condition = groups[usize::from(group)].condition.unwrap_or(BoundaryCondition::Neumann);
        boundary.push(BoundaryFacet { cell: cell as u32, local: local as u8, condition, group });
    }
    if groups.len() > usize::from(u16::MAX) {
        let limit = usize::from(u16::MAX);
        return Err(MeshError::too_large("boundary groups", groups.len(), limit));
    }
    BoundaryFacet::sort(&mut boundary);
    let inside = names.iter().zip(has_inner).filter(|(_, has)| *has).map(|(name, _)| name.clone());
    let inside = inside.collect();
    Ok((boundary, Groups { regions: vec![Vec::new()], boundary: groups, inside }))
}

/// What to do with a boundary facet in no group, given how many facets of the boundary lie on others; zero if it does
/// not.
fn remedy(coincident: usize) -> String {
    match coincident {
        0 => "put it in one; the names dirichlet, neumann, contact say what holds there, for other names a problem does".to_owned(),
        n => format!(
            "it lies on another one, with nodes of its own, as {n} facets do; {UNITE}, or put both sides of a slit in groups"
        ),
    }
}

/// How many facets of the boundary lie on others, if this one does.
fn coincident<const D: usize>(
    vertices: &[Point<D>],
    open: &[OpenFacet<D>],
    facet: [u32; D],
) -> usize {
    let facets: Vec<[u32; D]> = open.iter().map(|(vertices, ..)| *vertices).collect();
    let lie_on_others = lie_on_others(vertices, &facets);
    match facets.iter().zip(&lie_on_others).any(|(other, lies)| *other == facet && *lies) {
        true => lie_on_others.iter().filter(|lies| **lies).count(),
        false => 0,
    }
}

fn drop_unused<const D: usize>(
    mut vertices: Vec<Point<D>>,
    mut cells: Vec<u32>,
) -> (Vec<Point<D>>, Vec<u32>) {
    let mut number = vec![0_u32; vertices.len()];
    for &v in &cells {
        number[v as usize] = 1;
    }
    let mut used = 0;
    for v in 0..vertices.len() {
        if number[v] == 1 {
            vertices[used as usize] = vertices[v];
            number[v] = used;
            used += 1;
        }
    }
    vertices.truncate(used as usize);
    // renumbering keeps the order, so the vertices of a cell stay ascending
    for v in &mut cells {
        *v = number[*v as usize];
    }
    (vertices, cells)
}
