//! Another reader as an oracle, and the meshes of a folder that the variable `UNILATERAL_MESHES` names.

use super::forms::{conditions, parse, volume};
use super::writer::{FORMS, square, tetrahedron};
use std::collections::HashMap;
use std::path::PathBuf;
use unilateral::mesh::Mesh;
use unilateral::mesh::gmsh;
use unilateral::mesh::gmsh::GmshFile;

/// The folder of meshes.
fn folder() -> PathBuf {
    let folder = std::env::var_os("UNILATERAL_MESHES");
    folder.expect("UNILATERAL_MESHES names the folder of meshes").into()
}

fn boundary_length(mesh: &Mesh<2>) -> f64 {
    let facet_length = |cell: u32, local: u8| {
        let v: Vec<u32> = mesh.facet_vertices(cell as usize, local as usize).collect();
        (mesh.vertices()[v[0] as usize] - mesh.vertices()[v[1] as usize]).norm()
    };
    mesh.boundary().iter().map(|f| facet_length(f.cell, f.local)).sum()
}

fn check<const D: usize>(name: &str, bytes: &[u8]) {
    let read = parse::<D>(bytes);
    assert!(read.mesh.n_cells() > 0, "{name}");
    let curved = name.contains("quadratic");
    assert_eq!(!read.warnings.is_empty(), curved, "{name}");
    for warning in &read.warnings {
        assert!(warning.contains(" elements of order two are read"), "{name}: {warning}");
    }
    eprintln!(
        "{name}: {} cells, volume {}, conditions {:?}",
        read.mesh.n_cells(),
        volume(&read.mesh),
        conditions(&read.mesh)
    );
}

/// Nodes, and cells of dimension `D` by the tags of their corners, as another reader of MSH 4.1 has them, both
/// by tag.
type Oracle<const D: usize> = (HashMap<u64, [f64; D]>, HashMap<u64, Vec<u64>>);

fn oracle<const D: usize>(bytes: &[u8]) -> Oracle<D> {
    let file = mshio::parse_msh_bytes(bytes).unwrap_or_else(|e| panic!("{e}"));
    let nodes = file.data.nodes.unwrap();
    let mut points = HashMap::new();
    let mut next = nodes.min_node_tag;
    for block in &nodes.node_blocks {
        for (at, x) in block.nodes.iter().enumerate() {
            let tag = match &block.node_tags {
                Some(tags) => *tags.iter().find(|(_, k)| **k == at).unwrap().0,
                None => next,
            };
            next += 1;
            let x = [x.x, x.y, x.z];
            points.insert(tag, std::array::from_fn(|k| x[k]));
        }
    }
    let blocks = file.data.elements.unwrap().element_blocks;
    let cells = blocks.iter().filter(|b| b.entity_dim as usize == D).flat_map(|b| &b.elements);
    let cells = cells.map(|e| (e.element_tag, e.nodes[..=D].to_vec())).collect();
    (points, cells)
}

fn agrees_with_oracle<const D: usize>(bytes: &[u8]) {
    let read = parse::<D>(bytes);
    let (nodes, mut cells) = oracle::<D>(bytes);
    assert_eq!(read.node_tags.len(), read.mesh.vertices().len());
    for (x, tag) in read.mesh.vertices().iter().zip(&read.node_tags) {
        for (found, expected) in x.iter().zip(nodes[tag]) {
            // Text is rounded by two different readers.
            assert!((found - expected).abs() < 1e-14, "node {tag}");
        }
    }
    assert_eq!(read.element_tags.len(), read.mesh.n_cells());
    for (c, tag) in read.element_tags.iter().enumerate() {
        let mut expected = cells.remove(tag).unwrap();
        let tag_of = |&v: &u32| read.node_tags[v as usize];
        let mut found: Vec<u64> = read.mesh.cell(c).iter().map(tag_of).collect();
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected, "element {tag}");
    }
    assert!(cells.is_empty());
}

#[test]
fn another_reader_finds_the_same_cells() {
    for form in FORMS {
        agrees_with_oracle::<2>(&square().four(form));
        agrees_with_oracle::<3>(&tetrahedron().four(form));
    }
    let file = |name: &str| {
        let data = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data"));
        std::fs::read(data.join(name)).unwrap()
    };
    agrees_with_oracle::<2>(&file("unstructured_square.msh"));
    agrees_with_oracle::<3>(&file("unstructured_half_cube.msh"));
}

mod needs_meshes {
    use super::*;

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn the_disc_is_the_same_in_every_version() {
        let folder = folder();
        let read = |name: &str| {
            gmsh::read::<2>(&folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}")).mesh
        };
        let discs = [
            ("disc.msh", read("disc.msh")),
            ("disc_binary.msh", read("disc_binary.msh")),
            ("disc_v2.msh", read("disc_v2.msh")),
        ];
        // A polygon of n equal sides inscribed in a circle of radius 3/2.
        for (name, mesh) in &discs {
            let sides = mesh.boundary().len() as f64;
            let angle = std::f64::consts::TAU / sides;
            let (area, length) = (1.125 * sides * angle.sin(), 3.0 * sides * (angle / 2.0).sin());
            assert!((volume(mesh) - area).abs() < 1e-9, "{name}: area {} of {area}", volume(mesh));
            assert!((boundary_length(mesh) - length).abs() < 1e-9, "{name}");
            assert_eq!(conditions(mesh), [mesh.boundary().len(), 0, 0], "{name}");
            // Euler: vertices - edges + cells = 1
            let edges = (3 * mesh.n_cells() + mesh.boundary().len()) / 2;
            assert_eq!(mesh.vertices().len() + mesh.n_cells(), edges + 1, "{name}");
        }
        let [(_, text), _, (_, old)] = &discs;
        assert_eq!((text.n_cells(), text.vertices().len()), (old.n_cells(), old.vertices().len()));
        assert!((volume(text) - volume(old)).abs() < 1e-12);
        assert!((boundary_length(text) - boundary_length(old)).abs() < 1e-12);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn every_mesh_of_the_folder_reads() {
        let folder = folder();
        let mut files = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|e| e != "msh") {
                continue;
            }
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).unwrap();
            let file = GmshFile::parse(&bytes[..]).unwrap_or_else(|e| panic!("{name}: {e}"));
            match file.dimension() {
                1 => check::<1>(&name, &bytes),
                2 => check::<2>(&name, &bytes),
                _ => check::<3>(&name, &bytes),
            }
            files += 1;
        }
        assert!(files > 0);
    }

    #[test]
    #[ignore = "needs the folder of meshes"]
    fn another_reader_finds_the_same_cells() {
        for name in ["disc.msh", "disc_binary.msh", "plate_with_holes.msh"] {
            agrees_with_oracle::<2>(&std::fs::read(folder().join(name)).unwrap());
        }
        agrees_with_oracle::<3>(&std::fs::read(folder().join("block.msh")).unwrap());
    }
}

mod needs_meshes_and_time {
    use super::*;

    /// Prints the time per cell of a large mesh: run with `--ignored --nocapture`.
    #[test]
    #[ignore = "needs the folder of meshes; a measurement"]
    fn time_per_cell() {
        let folder = folder();
        for name in ["disc_fine.msh", "disc_binary.msh"] {
            let bytes = std::fs::read(folder.join(name)).unwrap();
            let time = |f: &dyn Fn() -> usize| {
                let mut best = f64::INFINITY;
                let mut cells = 0;
                for _ in 0..20 {
                    let start = std::time::Instant::now();
                    cells = f();
                    best = best.min(start.elapsed().as_secs_f64());
                }
                (best, cells)
            };
            let (seconds, cells) = time(&|| parse::<2>(&bytes).mesh.n_cells());
            let (scan, _) = time(&|| GmshFile::parse(&bytes[..]).unwrap().dimension());
            let mesh = parse::<2>(&bytes).mesh;
            let facets: Vec<_> = mesh
                .boundary()
                .iter()
                .map(|f| {
                    let v: Vec<u32> =
                        mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
                    unilateral::mesh::TaggedFacet { vertices: [v[0], v[1]], condition: f.condition }
                })
                .collect();
            let (new, _) = time(&|| {
                Mesh::<2>::new(mesh.vertices().to_vec(), mesh.cells().to_vec(), &facets)
                    .unwrap()
                    .n_cells()
            });
            let each = 1e9 / cells as f64;
            eprintln!(
                "{name}: {cells} cells, {:.0} ns a cell, of which Mesh::new {:.0}; parsing {:.0}",
                seconds * each,
                new * each,
                scan * each
            );
        }
    }
}
