//! The mesh of a file, from its contents.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::contents::Contents;
use super::error::{GmshError, GmshErrorKind};
use crate::arrays::array_of;
use crate::input::excerpt;
use crate::mesh::error::MeshError;
use crate::mesh::overlap::UNITE;
use crate::mesh::simplicial::Mesh;
use crate::mesh::validate::GroupedFacet;
use crate::real::Point;

/// A mesh read from a file, and the warnings of the reader.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct GmshMesh<const D: usize> {
    /// The mesh, with its cells along a Hilbert curve and its vertices in the order in which cells name them
    /// first: whatever the order of the file, what is near in space is near in memory.
    pub mesh: Mesh<D>,
    /// The tag in the file of each vertex of the mesh.
    pub node_tags: Vec<u64>,
    /// The tag in the file of each cell of the mesh.
    pub element_tags: Vec<u64>,
    /// Contents of the file that the mesh does not represent exactly, in sentences.
    pub warnings: Vec<String>,
}

/// The number of the node with each tag.
type Numbers = HashMap<u64, u32>;

/// A mesh of dimension `D` from the contents of a file.
pub(super) fn assemble<const D: usize>(contents: &Contents) -> Result<GmshMesh<D>, GmshError> {
    let numbers = contents.node_numbers()?;
    let Cells { vertices: corners, elements, regions, of_cells } =
        cells_of::<D>(contents, &numbers)?;
    check_flat::<D>(contents, &corners)?;
    let boundary = grouped_facets::<D>(contents, &numbers)?;
    let vertices = contents.nodes.points.iter().map(|x| Point::from_fn(|k, _| x[k])).collect();
    let mut is_used = vec![false; contents.nodes.tags.len()];
    corners.iter().for_each(|&v| is_used[v as usize] = true);
    let mesh = Mesh::with_groups(vertices, corners, &boundary.facets, &boundary.names);
    let mesh = mesh
        .and_then(|mesh| mesh.with_regions(regions, of_cells))
        .map_err(|error| in_file::<D>(error, contents, (&elements, &boundary.elements)))?;
    let (mesh, order, numbers) = mesh.along_curve();
    // vertices are the nodes that a cell uses
    let used = contents.nodes.tags.iter().zip(is_used).filter(|(_, is_used)| *is_used);
    let mut node_tags = vec![0; numbers.len()];
    used.zip(numbers).for_each(|((&tag, _), number)| node_tags[number as usize] = tag);
    let tags = &contents.simplices[D].tags;
    let element_tags = order.iter().map(|&cell| tags[elements[cell as usize]]).collect();
    let warnings = warnings(contents, &mesh);
    Ok(GmshMesh { mesh, node_tags, element_tags, warnings })
}

/// The error of a mesh by the elements and nodes of the file, given the elements of cells and of facets.
fn in_file<const D: usize>(
    error: MeshError,
    contents: &Contents,
    (cells, facets): (&[usize], &[usize]),
) -> GmshError {
    let element = |dimension: usize, index: usize| {
        let simplices = &contents.simplices[dimension];
        let place = contents.place(simplices.offsets[index]);
        format!("element {} ({place})", simplices.tags[index])
    };
    let of_cells = error.cells.iter().map(|&cell| element(D, cells[cell]));
    let of_facet = error.tagged_facet.map(|tag| element(D - 1, facets[tag]));
    let mut names: Vec<String> = of_cells.chain(of_facet).collect();
    let nodes: Vec<String> =
        error.vertices.iter().map(|&v| contents.nodes.tags[v].to_string()).collect();
    if !nodes.is_empty() {
        names.push(format!("nodes {}", nodes.join(", ")));
    }
    GmshError::of_mesh(error, &names)
}

/// An error if the mesh has another dimension than asked for.
pub(super) fn check_dimension(found: usize, asked: usize) -> Result<(), GmshError> {
    if found == asked {
        return Ok(());
    }
    let advice = if found < asked {
        "mesh in the dimension asked for, and put the domain in a physical group too: Gmsh saves only elements of groups"
    } else {
        "ask for the dimension it has, or remove the larger elements"
    };
    let message = format!(
        "the mesh has dimension {found} (its largest elements), but dimension {asked} was asked for; {advice}"
    );
    Err(GmshError::new(GmshErrorKind::WrongDimension, message))
}

/// The cells of a file.
struct Cells {
    vertices: Vec<u32>,
    /// The index of the element of each cell.
    elements: Vec<usize>,
    /// The names of each region.
    regions: Vec<Vec<String>>,
    /// The region of each cell.
    of_cells: Vec<u16>,
}

/// The number of an item in a list, to which it is added if it is new.
fn number_of<T: PartialEq>(all: &mut Vec<T>, item: T) -> Result<u16, GmshError> {
    let known = all.iter().position(|other| *other == item);
    let number = known.unwrap_or(all.len());
    if known.is_none() {
        all.push(item);
    }
    u16::try_from(number).map_err(|_| {
        let message = format!(
            "the file has more than {} groups, or intersections of groups, of one dimension; leave out those that are not needed",
            u16::MAX
        );
        GmshError::new(GmshErrorKind::Groups, message)
    })
}

/// The cells, their elements and their regions.
fn cells_of<const D: usize>(contents: &Contents, numbers: &Numbers) -> Result<Cells, GmshError> {
    let simplices = &contents.simplices[D];
    let mut cells = Cells {
        vertices: Vec::with_capacity(simplices.corners.len()),
        elements: Vec::with_capacity(simplices.tags.len()),
        regions: Vec::new(),
        of_cells: Vec::with_capacity(simplices.tags.len()),
    };
    let mut listed: HashMap<[u64; 4], usize> = HashMap::new();
    for (run, groups) in simplices.runs() {
        let names = contents.names_of(D, groups);
        let region = number_of(&mut cells.regions, names.clone())?;
        for element in run {
            if contents.lists_by_group {
                let mut corners = [0; 4];
                corners[..=D].copy_from_slice(&simplices.corners[element * (D + 1)..][..D + 1]);
                corners[..=D].sort_unstable();
                match listed.entry(corners) {
                    Entry::Vacant(new) => _ = new.insert(cells.elements.len()),
                    Entry::Occupied(first) => {
                        let region = &mut cells.of_cells[*first.get()];
                        let known = &cells.regions[usize::from(*region)];
                        // a cell that is listed twice in one group is an error of the mesh
                        if !names.iter().all(|name| known.contains(name)) {
                            let both = [&known[..], &names].concat();
                            *region = number_of(&mut cells.regions, both)?;
                            continue;
                        }
                    }
                }
            }
            push_corners(contents, numbers, (D, element), &mut cells.vertices)?;
            cells.elements.push(element);
            cells.of_cells.push(region);
        }
    }
    Ok(cells)
}

/// Appends the numbers of the corners of an element, given by its dimension and index.
fn push_corners(
    contents: &Contents,
    numbers: &Numbers,
    (dimension, element): (usize, usize),
    vertices: &mut Vec<u32>,
) -> Result<(), GmshError> {
    let simplices = &contents.simplices[dimension];
    for node in &simplices.corners[element * (dimension + 1)..][..dimension + 1] {
        let Some(number) = numbers.get(node) else {
            let message = format!(
                "element {} names node {node}, which section $Nodes does not have; save the mesh again",
                simplices.tags[element]
            );
            let offset = simplices.offsets[element];
            return Err(contents.error(offset, GmshErrorKind::Node, &message));
        };
        vertices.push(*number);
    }
    Ok(())
}

/// The boundary facets that are in a group, the index of the element of each, and the names of the groups.
struct GroupedFacets<const D: usize> {
    facets: Vec<GroupedFacet<D>>,
    elements: Vec<usize>,
    names: Vec<String>,
}

fn grouped_facets<const D: usize>(
    contents: &Contents,
    numbers: &Numbers,
) -> Result<GroupedFacets<D>, GmshError> {
    let simplices = &contents.simplices[D - 1];
    let (mut facets, mut elements, mut names) = (Vec::new(), Vec::new(), Vec::<String>::new());
    let mut vertices = Vec::with_capacity(D);
    for (run, of_run) in simplices.runs() {
        let mut groups = Vec::new();
        for name in contents.names_of(D - 1, of_run) {
            groups.push(number_of(&mut names, name)?);
        }
        for element in run.filter(|_| !groups.is_empty()) {
            vertices.clear();
            push_corners(contents, numbers, (D - 1, element), &mut vertices)?;
            for &group in &groups {
                facets.push(GroupedFacet { vertices: array_of(|k| vertices[k]), group });
                elements.push(element);
            }
        }
    }
    if facets.is_empty() {
        let (elements, entity) =
            [("point", "Point"), ("line", "Curve"), ("triangle", "Surface")][D - 1];
        let message = format!(
            "no {elements} of the file is in a physical group, so the boundary conditions are unknown; put the boundary in groups in Gmsh, e.g. `Physical {entity}(\"dirichlet\") = {{1, 2}};`, with the names dirichlet, neumann and contact or with others, for which the problem says what holds there; put the domain in a group too, and save without `Mesh.SaveAll`"
        );
        return Err(GmshError::new(GmshErrorKind::Groups, message));
    }
    Ok(GroupedFacets { facets, elements, names })
}

/// An error unless a mesh of lines lies in a line along x, a mesh of triangles in a plane of constant z.
fn check_flat<const D: usize>(contents: &Contents, cells: &[u32]) -> Result<(), GmshError> {
    let point = |v: u32| contents.nodes.points[v as usize];
    let reference = point(cells[0]);
    let distance = |v: u32, k: usize| (point(v)[k] - reference[k]).abs();
    let extent = cells.iter().flat_map(|&v| (0..D).map(move |k| distance(v, k)));
    let extent = extent.fold(0.0, f64::max);
    for k in D..3 {
        // rounding errors of the geometry, relative to the extent of the mesh and to its offset
        let rounding = (1e-9 * extent).max(1e-14 * reference[k].abs());
        let Some(&v) = cells.iter().find(|&&v| distance(v, k) > rounding) else { continue };
        // Gmsh leaves out a domain that is in no physical group: what is left may be its boundary
        let (found, missing, within, entity) = match D {
            1 => ("lines", "triangles", "a line of constant y and z", "Surface"),
            _ => ("triangles", "tetrahedra", "a plane of constant z", "Volume"),
        };
        let (node, offset) = (contents.nodes.tags[v as usize], contents.nodes.offsets[v as usize]);
        let (axis, value, constant) = (['x', 'y', 'z'][k], point(v)[k], reference[k]);
        let message = format!(
            "the file has {found} and no {missing}, and they do not lie in {within}: node {node} has {axis} = {value}, another node {axis} = {constant}; if they bound the domain, put that in a physical group too, e.g. `Physical {entity}(\"domain\") = {{1}};`, and mesh it: Gmsh saves only elements of groups; otherwise turn them there"
        );
        return Err(contents.error(offset, GmshErrorKind::NotFlat, &message));
    }
    Ok(())
}

fn warnings<const D: usize>(contents: &Contents, mesh: &Mesh<D>) -> Vec<String> {
    let mut warnings = Vec::new();
    let curved = contents.simplices[D].curved + contents.simplices[D - 1].curved;
    if curved > 0 {
        warnings.push(format!(
            "{curved} elements of order two are read as straight ones by their corner nodes"
        ));
    }
    let count = mesh.n_coincident_facets();
    if count > 0 {
        warnings.push(format!(
            "{count} facets of the boundary lie on others with different nodes, so the two sides are not connected there: {UNITE}, unless a slit is meant"
        ));
    }
    let on_boundary =
        |name: &&String| mesh.boundary_groups().iter().any(|g| g.names.contains(name));
    warnings.extend(mesh.groups_inside().iter().filter(on_boundary).map(|name| {
        format!(
            "some facets of group {} lie inside the domain, between two cells, and are left out: data are given on the boundary only",
            excerpt(name)
        )
    }));
    warnings
}
