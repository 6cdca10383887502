//! Meshes that are written, and read again.

use super::forms::parse;
use unilateral::mesh::gmsh;
use unilateral::prelude::*;

/// The cells of a mesh with the names of their regions, sorted, with the vertices in another numbering.
fn cells<const D: usize>(mesh: &Mesh<D>, number: &[u64]) -> Vec<(Vec<u64>, Vec<String>)> {
    let of = |c: usize| {
        (sorted(mesh.cell(c).iter().copied(), number), mesh.regions()[mesh.region(c)].clone())
    };
    let mut cells: Vec<_> = (0..mesh.n_cells()).map(of).collect();
    cells.sort();
    cells
}

/// The boundary facets of a mesh with names, sorted, with the vertices in another numbering.
fn facets<const D: usize>(mesh: &Mesh<D>, number: &[u64]) -> Vec<(Vec<u64>, Vec<String>)> {
    let mut facets: Vec<_> = mesh
        .boundary()
        .iter()
        .map(|f| {
            let group = &mesh.boundary_groups()[usize::from(f.group)];
            let vertices = mesh.facet_vertices(f.cell as usize, f.local as usize);
            (sorted(vertices, number), group.names.clone())
        })
        .collect();
    facets.sort();
    facets
}

fn sorted(vertices: impl Iterator<Item = u32>, number: &[u64]) -> Vec<u64> {
    let mut vertices: Vec<u64> = vertices.map(|v| number[v as usize]).collect();
    vertices.sort_unstable();
    vertices
}

fn survives<const D: usize>(mesh: &Mesh<D>) {
    let text = gmsh::to_text(mesh);
    let read = parse::<D>(text.as_bytes());
    assert!(read.warnings.is_empty());
    assert_eq!(read.mesh.vertices().len(), mesh.vertices().len());
    for (x, tag) in read.mesh.vertices().iter().zip(&read.node_tags) {
        assert_eq!(x, &mesh.vertices()[*tag as usize - 1]);
    }
    let numbers: Vec<u64> = (1..=mesh.vertices().len() as u64).collect();
    assert_eq!(cells(&read.mesh, &read.node_tags), cells(mesh, &numbers));
    assert_eq!(facets(&read.mesh, &read.node_tags), facets(mesh, &numbers));
    // what another reader finds
    let other = mshio::parse_msh_bytes(text.as_bytes()).unwrap();
    assert_eq!(other.data.nodes.unwrap().num_nodes as usize, mesh.vertices().len());
    let elements = mesh.n_cells() + mesh.boundary().len();
    assert_eq!(other.data.elements.unwrap().num_elements as usize, elements);
}

#[test]
fn written_meshes_are_read_as_they_were() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems");
    let plate = gmsh::read::<2>(&folder.join("plate.msh")).unwrap().mesh;
    survives(&plate);
    survives(&plate.refine().unwrap().0);
    survives(&gmsh::read::<3>(&folder.join("bracket.msh")).unwrap().mesh);
    survives(&Mesh::kuhn_box(&BoxDomain::<1>::centred(0.3), [7]).unwrap());
    survives(&Mesh::kuhn_box(&BoxDomain::<3>::centred(0.3), [2; 3]).unwrap());
    // cells and facets in several groups
    let names = vec![vec!["a".to_owned()], vec!["a".to_owned(), "b \u{e9}".to_owned()], vec![]];
    let of_cells = (0..plate.n_cells()).map(|c| (c % 3) as u16).collect();
    survives(&plate.with_regions(names, of_cells).unwrap());
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let mesh = Mesh::<1>::kuhn_box(&BoxDomain::centred(1.0), [2]).unwrap();
    let error = gmsh::write(&mesh, std::path::Path::new("/nowhere/mesh.msh")).unwrap_err();
    assert!(error.to_string().contains("cannot write /nowhere/mesh.msh"), "{error}");
}
