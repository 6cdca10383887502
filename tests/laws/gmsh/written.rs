//! Meshes that are written, and read again.

use unilateral::mesh::gmsh;
use unilateral::prelude::*;

/// The cells of a mesh with the names of their regions, sorted.
fn cells<const D: usize>(mesh: &Mesh<f64, D>) -> Vec<(Vec<u32>, Vec<String>)> {
    let of = |c: usize| (mesh.cell(c).to_vec(), mesh.regions()[mesh.region(c)].clone());
    let mut cells: Vec<_> = (0..mesh.n_cells()).map(of).collect();
    cells.sort();
    cells
}

/// The boundary facets of a mesh with names and part, sorted.
fn facets<const D: usize>(
    mesh: &Mesh<f64, D>,
) -> Vec<(Vec<u32>, Vec<String>, Option<BoundaryPart>)> {
    let mut facets: Vec<_> = mesh
        .boundary()
        .iter()
        .map(|f| {
            let group = &mesh.boundary_groups()[usize::from(f.group)];
            let vertices = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
            (vertices, group.names.clone(), group.part)
        })
        .collect();
    facets.sort();
    facets
}

fn survives<const D: usize>(mesh: &Mesh<f64, D>) {
    let text = gmsh::to_text(mesh);
    let read = gmsh::parse::<f64, D>(text.as_bytes()).unwrap();
    assert!(read.warnings.is_empty());
    assert_eq!(read.mesh.vertices(), mesh.vertices());
    assert_eq!(cells(&read.mesh), cells(mesh));
    let without_part = |list: Vec<(Vec<u32>, Vec<String>, Option<BoundaryPart>)>| {
        list.into_iter().map(|(vertices, names, _)| (vertices, names)).collect::<Vec<_>>()
    };
    assert_eq!(without_part(facets(&read.mesh)), without_part(facets(mesh)));
    // what another reader finds
    let other = mshio::parse_msh_bytes(text.as_bytes()).unwrap();
    assert_eq!(other.data.nodes.unwrap().num_nodes as usize, mesh.vertices().len());
    let elements = mesh.n_cells() + mesh.boundary().len();
    assert_eq!(other.data.elements.unwrap().num_elements as usize, elements);
}

#[test]
fn written_meshes_are_read_as_they_were() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems");
    let plate = gmsh::read::<f64, 2>(&folder.join("plate.msh")).unwrap().mesh;
    survives(&plate);
    survives(&plate.refine().unwrap().0);
    survives(&gmsh::read::<f64, 3>(&folder.join("bracket.msh")).unwrap().mesh);
    survives(&Mesh::kuhn_box(&BoxDomain::<1>::centred(0.3), [7]).unwrap());
    survives(&Mesh::kuhn_box(&BoxDomain::<3>::centred(0.3), [2; 3]).unwrap());
    // cells and facets in several groups
    let names = vec![vec!["a".to_owned()], vec!["a".to_owned(), "b \u{e9}".to_owned()], vec![]];
    let of_cells = (0..plate.n_cells()).map(|c| (c % 3) as u16).collect();
    survives(&plate.with_regions(names, of_cells).unwrap());
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let mesh = Mesh::<f64, 1>::kuhn_box(&BoxDomain::centred(1.0), [2]).unwrap();
    let error = gmsh::write(&mesh, std::path::Path::new("/nowhere/mesh.msh")).unwrap_err();
    assert!(error.to_string().contains("cannot write /nowhere/mesh.msh"), "{error}");
}
