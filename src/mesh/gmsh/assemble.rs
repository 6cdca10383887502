//! The mesh of a file, from its contents.

use super::contents::{Contents, Membership};
use super::element_types::Shape;
use super::error::{GmshError, GmshWarning};
use super::node_index::NodeIndex;
use crate::input::excerpt;
use crate::mesh::boundary::BoundaryPart;
use crate::mesh::error::MeshError;
use crate::mesh::simplicial::Mesh;
use crate::mesh::validate::TaggedFacet;
use crate::real::{Point, Real};

/// A mesh read from a file, and the warnings of the reader.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct GmshMesh<T, const D: usize> {
    /// The mesh.
    pub mesh: Mesh<T, D>,
    /// Contents of the file that the mesh does not represent exactly.
    pub warnings: Vec<GmshWarning>,
}

/// A mesh of dimension `D` from the contents of a file.
pub(super) fn assemble<T: Real, const D: usize>(
    contents: &Contents,
) -> Result<GmshMesh<T, D>, GmshError> {
    check_dimension(contents, D)?;
    check_group_names(contents, D - 1)?;
    let index = NodeIndex::new(contents)?;
    let (cells, elements) = cells_of::<D>(contents, &index)?;
    check_flat::<D>(contents, &cells)?;
    let (boundary, facets) = tagged_facets::<D>(contents, &index)?;
    let vertices = contents.nodes.points.iter().map(|x| Point::from_fn(|k, _| x[k])).collect();
    let mesh = Mesh::new(vertices, cells, &boundary).map_err(|source| {
        let cells =
            source.cells().into_iter().filter_map(|cell| contents.element(D, *elements.get(cell)?));
        let facet =
            source.tagged_facet().and_then(|tag| contents.element(D - 1, *facets.get(tag)?));
        let nodes = vertices_of(&source)
            .iter()
            .filter_map(|&v| contents.nodes.tags.get(v).copied())
            .collect();
        GmshError::Mesh { elements: cells.chain(facet).collect(), nodes, source }
    })?;
    Ok(GmshMesh { mesh, warnings: warnings(contents, D) })
}

fn check_dimension(contents: &Contents, asked: usize) -> Result<(), GmshError> {
    let found = contents.dimension()?;
    if found == asked {
        return Ok(());
    }
    let advice = if found < asked {
        "mesh in the dimension asked for, and put the domain in a physical group too: Gmsh saves only elements of groups"
    } else {
        "ask for the dimension it has, or remove the larger elements"
    };
    Err(GmshError::WrongDimension { asked, found, advice })
}

/// An error if a named group of boundary elements does not name a part of the boundary.
fn check_group_names(contents: &Contents, dimension: usize) -> Result<(), GmshError> {
    for (&(of, tag), group) in &contents.groups {
        if of != dimension || BoundaryPart::from_name(&group.name).is_some() {
            continue;
        }
        let meant = BoundaryPart::from_name(&group.name.trim().to_lowercase());
        let hint = meant.map_or(String::new(), |part| format!(": write {}", part.name()));
        let (position, name) = (group.position, excerpt(&group.name));
        return Err(GmshError::UnknownGroup { position, dimension, tag, name, hint });
    }
    Ok(())
}

/// The vertices of the cells, and the index of the element of each cell.
fn cells_of<const D: usize>(
    contents: &Contents,
    index: &NodeIndex,
) -> Result<(Vec<u32>, Vec<usize>), GmshError> {
    let simplices = &contents.simplices[D];
    let mut cells: Vec<u32> = Vec::with_capacity(simplices.corners.len());
    let mut elements = Vec::with_capacity(simplices.tags.len());
    for (run, membership) in simplices.runs() {
        for element in run.clone() {
            let corners = &simplices.corners[element * (D + 1)..(element + 1) * (D + 1)];
            // MSH 2.2 lists an element that is in several groups once for each of them.
            if let Membership::Group(_) = membership
                && element == run.start
                && element > 0
                && simplices.corners[(element - 1) * (D + 1)..element * (D + 1)] == *corners
            {
                continue;
            }
            for &node in corners {
                cells.push(
                    index.find(node).ok_or_else(|| unknown_node(contents, D, element, node))?,
                );
            }
            elements.push(element);
        }
    }
    Ok((cells, elements))
}

fn unknown_node(contents: &Contents, dimension: usize, element: usize, node: u64) -> GmshError {
    let simplices = &contents.simplices[dimension];
    let position = contents.position_of(simplices.marks[element]);
    GmshError::UnknownNode { position, element: simplices.tags[element], node }
}

/// The facets of the boundary that are in a group, and the index of the element of each facet.
fn tagged_facets<const D: usize>(
    contents: &Contents,
    index: &NodeIndex,
) -> Result<(Vec<TaggedFacet<D>>, Vec<usize>), GmshError> {
    let simplices = &contents.simplices[D - 1];
    let mut boundary = Vec::new();
    let mut elements = Vec::new();
    for (run, membership) in simplices.runs() {
        let of_element;
        let groups: &[i64] = match membership {
            Membership::Entity(entity) => {
                contents.entities.get(&(D - 1, entity)).map_or(&[], Vec::as_slice)
            }
            Membership::Group(0) => &[],
            Membership::Group(group) => {
                of_element = [group];
                &of_element
            }
        };
        let mut parts = Vec::new();
        for &tag in groups {
            // Other names are refused by `check_group_names`.
            let named = contents
                .groups
                .get(&(D - 1, tag))
                .and_then(|group| BoundaryPart::from_name(&group.name));
            let part = named.ok_or_else(|| GmshError::UnnamedGroup {
                position: contents.position_of(simplices.marks[run.start]),
                element: simplices.tags[run.start],
                dimension: D - 1,
                tag,
            })?;
            if !parts.contains(&part) {
                parts.push(part);
            }
        }
        for element in run.filter(|_| !parts.is_empty()) {
            let mut vertices = [0; D];
            for (vertex, &node) in vertices.iter_mut().zip(&simplices.corners[element * D..]) {
                *vertex =
                    index.find(node).ok_or_else(|| unknown_node(contents, D - 1, element, node))?;
            }
            for &part in &parts {
                boundary.push(TaggedFacet { vertices, part });
                elements.push(element);
            }
        }
    }
    if boundary.is_empty() {
        let (elements, entity) =
            [("point", "Point"), ("line", "Curve"), ("triangle", "Surface")][D - 1];
        return Err(GmshError::NoPhysicalGroups { elements, entity });
    }
    Ok((boundary, elements))
}

/// An error unless a mesh of lines lies in a line along x, a mesh of triangles in a plane of constant z.
fn check_flat<const D: usize>(contents: &Contents, cells: &[u32]) -> Result<(), GmshError> {
    let points = &contents.nodes.points;
    let Some(&first) = cells.first() else {
        return Ok(());
    };
    let reference = points[first as usize];
    let extent = cells.iter().fold(0.0, |largest: f64, &v| {
        (0..D).fold(largest, |largest, k| largest.max((points[v as usize][k] - reference[k]).abs()))
    });
    for axis in D..3 {
        // Rounding errors of the geometry, relative to the extent of the mesh and to its offset.
        let tolerance = (1e-9 * extent).max(1e-14 * reference[axis].abs());
        for &v in cells {
            let value = points[v as usize][axis];
            // The comparison is false for an infinite difference, which is refused.
            if (value - reference[axis]).abs() <= tolerance {
                continue;
            }
            return Err(GmshError::NotFlat {
                position: contents.position_of(contents.nodes.marks[v as usize]),
                node: contents.nodes.tags[v as usize],
                axis: ['x', 'y', 'z'][axis],
                value,
                constant: reference[axis],
                dimension: D,
                within: if D == 1 { "a line of constant y and z" } else { "a plane of constant z" },
            });
        }
    }
    Ok(())
}

/// The vertices in the message of a mesh error.
fn vertices_of(error: &MeshError) -> Vec<usize> {
    match error {
        MeshError::DegenerateCell { vertices, .. }
        | MeshError::RepeatedCell { vertices, .. }
        | MeshError::FacetOfThreeCells { vertices, .. }
        | MeshError::UntaggedFacet { vertices, .. }
        | MeshError::FacetInTwoParts { vertices, .. }
        | MeshError::NotABoundaryFacet { vertices, .. } => {
            vertices.iter().map(|&v| v as usize).collect()
        }
        MeshError::NotFinite { vertex, .. } => vec![*vertex],
        _ => Vec::new(),
    }
}

fn warnings(contents: &Contents, dimension: usize) -> Vec<GmshWarning> {
    let name = [Shape::Point, Shape::Line, Shape::Triangle, Shape::Tetrahedron].map(Shape::name);
    let straightened = |d: usize| {
        let curved = contents.simplices[d].curved.iter();
        curved.map(move |(&order, &count)| GmshWarning::Straightened {
            name: name[d],
            order,
            count,
        })
    };
    straightened(dimension).chain(straightened(dimension - 1)).collect()
}
