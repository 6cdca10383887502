//! Writer of Gmsh meshes: MSH 4.1 as text, with the names of regions and boundary groups.

use std::fmt::Write;
use std::path::Path;

use super::error::{GmshError, GmshErrorKind};
use crate::mesh::geometry::simplex::with_zeros;
use crate::mesh::simplicial::Mesh;

/// Element types of points, lines, triangles and tetrahedra.
const ELEMENT_TYPES: [u8; 4] = [15, 1, 2, 4];

/// A geometric entity of the file: elements that are in the same physical groups.
struct Entity<'m> {
    names: &'m [String],
    /// The vertices of its elements.
    elements: Vec<Vec<u32>>,
}

/// A mesh as the text of a Gmsh file. What a [`GmshFile`](super::GmshFile) reads from it has the vertices of the mesh,
/// bit by bit, its cells, and the names of regions and boundary groups, in the order of every mesh that is read; the tag
/// of a node is the number of its vertex from one on. Only the boundary conditions that are names of groups are kept:
/// on any other group a problem says what holds.
#[must_use]
pub fn to_text<const D: usize>(mesh: &Mesh<D>) -> String {
    let mut regions: Vec<Entity<'_>> =
        mesh.regions().iter().map(|names| Entity { names, elements: Vec::new() }).collect();
    for cell in 0..mesh.n_cells() {
        regions[mesh.region(cell)].elements.push(mesh.cell(cell).to_vec());
    }
    let facets = |group: Option<usize>| {
        let of =
            mesh.boundary().iter().filter(move |f| group.is_none_or(|g| usize::from(f.group) == g));
        of.map(|f| {
            let names = &mesh.boundary_groups()[usize::from(f.group)].names[..];
            (names, mesh.facet_vertices(f.cell as usize, f.local as usize).collect::<Vec<u32>>())
        })
    };
    let boundary: Vec<Entity<'_>> = match D {
        // a geometric point has one element
        1 => facets(None).map(|(names, v)| Entity { names, elements: vec![v] }).collect(),
        _ => mesh
            .boundary_groups()
            .iter()
            .enumerate()
            .map(|(k, group)| Entity {
                names: &group.names,
                elements: facets(Some(k)).map(|(_, vertices)| vertices).collect(),
            })
            .collect(),
    };
    let blocks = [(D - 1, boundary), (D, regions)];
    let mut text = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    let names = write_names(&mut text, &blocks);
    // missing coordinates are zero
    let points: Vec<[f64; 3]> = mesh.vertices().iter().map(|x| with_zeros(*x)).collect();
    write_entities(&mut text, &blocks, &names, &points);
    write_nodes(&mut text, D, &points);
    write_elements(&mut text, &blocks);
    text
}

/// Writes a mesh to a file, as [`to_text`] makes it.
///
/// # Errors
/// [`GmshErrorKind::Unwritable`].
pub fn write<const D: usize>(mesh: &Mesh<D>, path: &Path) -> Result<(), GmshError> {
    std::fs::write(path, to_text(mesh)).map_err(|error| {
        let message = format!("cannot write {}: {error}", path.display());
        GmshError::new(GmshErrorKind::Unwritable, message).caused_by(error)
    })
}

// writing to a text does not fail: results of `write!` are ignored below

/// Writes the physical groups; returns their names, by dimension of the blocks.
fn write_names<'m>(text: &mut String, blocks: &[(usize, Vec<Entity<'m>>)]) -> [Vec<&'m str>; 2] {
    let names = |entities: &[Entity<'m>]| {
        let mut names: Vec<&'m str> = Vec::new();
        for name in entities.iter().flat_map(|entity| entity.names) {
            if !names.contains(&&name[..]) {
                names.push(name);
            }
        }
        names
    };
    let all = [names(&blocks[0].1), names(&blocks[1].1)];
    let _ = writeln!(text, "$PhysicalNames\n{}", all[0].len() + all[1].len());
    for ((dimension, _), names) in blocks.iter().zip(&all) {
        for (k, name) in names.iter().enumerate() {
            let _ = writeln!(text, "{dimension} {} \"{name}\"", k + 1);
        }
    }
    text.push_str("$EndPhysicalNames\n");
    all
}

fn write_entities(
    text: &mut String,
    blocks: &[(usize, Vec<Entity<'_>>)],
    names: &[Vec<&str>; 2],
    points: &[[f64; 3]],
) {
    let count = |dimension: usize| {
        blocks.iter().find(|(d, _)| *d == dimension).map_or(0, |(_, entities)| entities.len())
    };
    let _ = writeln!(text, "$Entities\n{} {} {} {}", count(0), count(1), count(2), count(3));
    for ((dimension, entities), names) in blocks.iter().zip(names) {
        for (k, entity) in entities.iter().enumerate() {
            let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
            for x in entity.elements.iter().flatten().map(|&v| points[v as usize]) {
                for axis in 0..3 {
                    bounds[0][axis] = bounds[0][axis].min(x[axis]);
                    bounds[1][axis] = bounds[1][axis].max(x[axis]);
                }
            }
            let _ = write!(text, "{}", k + 1);
            let corners = if *dimension == 0 { &bounds[..1] } else { &bounds[..] };
            for x in corners.iter().flatten() {
                // a region without cells has no extent
                let _ = write!(text, " {:?}", if x.is_finite() { *x } else { 0.0 });
            }
            let _ = write!(text, " {}", entity.names.len());
            for name in entity.names {
                let known = names.iter().position(|known| known == name);
                let _ = write!(text, " {}", 1 + known.expect("every name has been written"));
            }
            text.push_str(if *dimension == 0 { "\n" } else { " 0\n" });
        }
    }
    text.push_str("$EndEntities\n");
}

fn write_nodes(text: &mut String, dimension: usize, points: &[[f64; 3]]) {
    let n = points.len();
    let _ = writeln!(text, "$Nodes\n1 {n} 1 {n}\n{dimension} 1 0 {n}");
    for tag in 1..=n {
        let _ = writeln!(text, "{tag}");
    }
    for [x, y, z] in points {
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    text.push_str("$EndNodes\n");
}

fn write_elements(text: &mut String, blocks: &[(usize, Vec<Entity<'_>>)]) {
    let filled = || {
        blocks.iter().flat_map(|(dimension, entities)| {
            let entities = entities.iter().enumerate().filter(|(_, e)| !e.elements.is_empty());
            entities.map(move |(k, entity)| (*dimension, k + 1, &entity.elements))
        })
    };
    let n: usize = filled().map(|(_, _, elements)| elements.len()).sum();
    let _ = writeln!(text, "$Elements\n{} {n} 1 {n}", filled().count());
    let mut tag = 0;
    for (dimension, entity, elements) in filled() {
        let element_type = ELEMENT_TYPES[dimension];
        let _ = writeln!(text, "{dimension} {entity} {element_type} {}", elements.len());
        for vertices in elements {
            tag += 1;
            let _ = write!(text, "{tag}");
            for v in vertices {
                let _ = write!(text, " {}", v + 1);
            }
            text.push('\n');
        }
    }
    text.push_str("$EndElements\n");
}
