//! The mesh of a file, from its contents.

use super::contents::{Contents, Membership, Simplices};
use super::element_types::SIMPLICES;
use super::error::{GmshError, GmshErrorKind, GmshWarning};
use super::node_index::NodeIndex;
use crate::input::excerpt;
use crate::mesh::error::{MeshError, UNITE};
use crate::mesh::facets::facet_of;
use crate::mesh::overlap::lie_on_others;
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
    /// Contents of the file that the mesh does not represent exactly.
    pub warnings: Vec<GmshWarning>,
}

/// A mesh of dimension `D` from the contents of a file.
pub(super) fn assemble<const D: usize>(contents: &Contents) -> Result<GmshMesh<D>, GmshError> {
    let index = NodeIndex::new(contents)?;
    let cells = cells_of::<D>(contents, &index)?;
    check_flat::<D>(contents, &cells.vertices)?;
    let boundary = grouped_facets::<D>(contents, &index)?;
    let vertices = contents.nodes.points.iter().map(|x| Point::from_fn(|k, _| x[k])).collect();
    let Cells { vertices: corners, elements, regions, of_cells } = cells;
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
        let position = contents.position(simplices.offsets[index]);
        format!("element {} ({position})", simplices.tags[index])
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
    u16::try_from(number).map_err(|_| GmshError::too_many_groups())
}

/// The cells, their elements and their regions.
fn cells_of<const D: usize>(contents: &Contents, index: &NodeIndex) -> Result<Cells, GmshError> {
    let simplices = &contents.simplices[D];
    let mut cells = Cells {
        vertices: Vec::with_capacity(simplices.corners.len()),
        elements: Vec::with_capacity(simplices.tags.len()),
        regions: Vec::new(),
        of_cells: Vec::with_capacity(simplices.tags.len()),
    };
    let first = first_listings::<D>(simplices);
    for (run, membership) in simplices.runs() {
        let names = contents.names_of(D, membership);
        let region = number_of(&mut cells.regions, names.clone())?;
        for element in run {
            if let Some(cell) =
                first.get(element).and_then(|e| cells.elements.binary_search(e).ok())
            {
                let known = usize::from(cells.of_cells[cell]);
                // a cell that is listed twice in one group is an error of the mesh
                if !names.iter().all(|name| cells.regions[known].contains(name)) {
                    let both = [&cells.regions[known][..], &names].concat();
                    cells.of_cells[cell] = number_of(&mut cells.regions, both)?;
                    continue;
                }
            }
            for &node in &simplices.corners[element * (D + 1)..(element + 1) * (D + 1)] {
                let vertex =
                    index.find(node).ok_or_else(|| unknown_node(contents, D, element, node))?;
                cells.vertices.push(vertex);
            }
            cells.elements.push(element);
            cells.of_cells.push(region);
        }
    }
    Ok(cells)
}

/// For each element the first with the same corners, in MSH 2.2, which lists an element of several groups once
/// for each of them; nothing if all elements have the same groups.
fn first_listings<const D: usize>(simplices: &Simplices) -> Vec<usize> {
    let is_listed_by_group =
        matches!(simplices.memberships[..], [(_, Membership::Group(_)), _, ..]);
    if !is_listed_by_group {
        return Vec::new();
    }
    let mut elements: Vec<([u64; 4], usize)> = Vec::with_capacity(simplices.tags.len());
    for (element, corners) in simplices.corners.chunks_exact(D + 1).enumerate() {
        let mut sorted = [0; 4];
        sorted[..=D].copy_from_slice(corners);
        sorted[..=D].sort_unstable();
        elements.push((sorted, element));
    }
    elements.sort_unstable();
    let mut first: Vec<usize> = (0..elements.len()).collect();
    for same in elements.chunk_by(|(a, _), (b, _)| a == b) {
        same.iter().for_each(|&(_, element)| first[element] = same[0].1);
    }
    first
}

fn unknown_node(contents: &Contents, dimension: usize, element: usize, node: u64) -> GmshError {
    let simplices = &contents.simplices[dimension];
    let message = format!(
        "element {} names node {node}, which section $Nodes does not have; save the mesh again",
        simplices.tags[element]
    );
    contents.error(simplices.offsets[element], GmshErrorKind::UnknownNode, message)
}

/// The boundary facets that are in a group, the index of the element of each, and the names of the groups.
struct GroupedFacets<const D: usize> {
    facets: Vec<GroupedFacet<D>>,
    elements: Vec<usize>,
    names: Vec<String>,
}

fn grouped_facets<const D: usize>(
    contents: &Contents,
    index: &NodeIndex,
) -> Result<GroupedFacets<D>, GmshError> {
    let simplices = &contents.simplices[D - 1];
    let (mut facets, mut elements, mut names) = (Vec::new(), Vec::new(), Vec::<String>::new());
    for (run, membership) in simplices.runs() {
        let mut groups = Vec::new();
        for name in contents.names_of(D - 1, membership) {
            groups.push(number_of(&mut names, name)?);
        }
        for element in run.filter(|_| !groups.is_empty()) {
            let mut vertices = [0; D];
            for (vertex, &node) in vertices.iter_mut().zip(&simplices.corners[element * D..]) {
                *vertex =
                    index.find(node).ok_or_else(|| unknown_node(contents, D - 1, element, node))?;
            }
            for &group in &groups {
                facets.push(GroupedFacet { vertices, group });
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
        return Err(GmshError::new(GmshErrorKind::NoPhysicalGroups, message));
    }
    Ok(GroupedFacets { facets, elements, names })
}

/// An error unless a mesh of lines lies in a line along x, a mesh of triangles in a plane of constant z.
fn check_flat<const D: usize>(contents: &Contents, cells: &[u32]) -> Result<(), GmshError> {
    let nodes = &contents.nodes;
    let points = &nodes.points;
    let reference = points[cells[0] as usize];
    if points.iter().all(|point| point[D..] == reference[D..]) {
        return Ok(());
    }
    let extent = cells.iter().fold(0.0, |largest: f64, &v| {
        (0..D).fold(largest, |largest, k| largest.max((points[v as usize][k] - reference[k]).abs()))
    });
    // Gmsh leaves out a domain that is in no physical group: what is left may be its boundary
    let (found, missing, within, entity) = match D {
        1 => ("lines", "triangles", "a line of constant y and z", "Surface"),
        _ => ("triangles", "tetrahedra", "a plane of constant z", "Volume"),
    };
    for k in D..3 {
        // Rounding errors of the geometry, relative to the extent of the mesh and to its offset.
        let tolerance = (1e-9 * extent).max(1e-14 * reference[k].abs());
        for v in cells.iter().map(|&v| v as usize) {
            let value = points[v][k];
            // The comparison is false for an infinite difference, which is refused.
            if (value - reference[k]).abs() <= tolerance {
                continue;
            }
            let (node, axis, constant) = (nodes.tags[v], ['x', 'y', 'z'][k], reference[k]);
            let message = format!(
                "the file has {found} and no {missing}, and they do not lie in {within}: node {node} has {axis} = {value}, another node {axis} = {constant}; if they bound the domain, put that in a physical group too, e.g. `Physical {entity}(\"domain\") = {{1}};`, and mesh it: Gmsh saves only elements of groups; otherwise turn them there"
            );
            return Err(contents.error(nodes.offsets[v], GmshErrorKind::NotFlat, message));
        }
    }
    Ok(())
}

fn warnings<const D: usize>(contents: &Contents, mesh: &Mesh<D>) -> Vec<GmshWarning> {
    let straightened = |d: usize| {
        let curved = contents.simplices[d].curved.iter();
        let name = SIMPLICES[d];
        curved.map(move |(order, count)| {
            GmshWarning::Straightened(format!(
                "{count} elements of type {name} of order {order} are read as straight ones by their corner nodes"
            ))
        })
    };
    let mut warnings: Vec<GmshWarning> = straightened(D).chain(straightened(D - 1)).collect();
    let facets = mesh.boundary().iter();
    let facets = facets.map(|f| facet_of(mesh.cell(f.cell as usize), usize::from(f.local)));
    let coincident = lie_on_others(mesh.vertices(), &facets.collect::<Vec<[u32; D]>>());
    let count = coincident.iter().filter(|lies| **lies).count();
    if count > 0 {
        warnings.push(GmshWarning::Coincident(format!(
            "{count} facets of the boundary lie on others with different nodes, so the two sides are not connected there: {UNITE}, unless a slit is meant"
        )));
    }
    let on_boundary =
        |name: &&String| mesh.boundary_groups().iter().any(|g| g.names.contains(name));
    let inside = mesh.groups_inside().iter().filter(on_boundary);
    warnings.extend(inside.map(|name| {
        GmshWarning::Inside(format!(
            "some facets of group {} lie inside the domain, between two cells, and are left out: data are given on the boundary only",
            excerpt(name)
        ))
    }));
    warnings.extend(contents.is_periodic.then_some(GmshWarning::Periodic));
    warnings
}
