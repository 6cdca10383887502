//! The order of a mesh does not depend on the order of its file.

use super::forms::parse;
use unilateral::mesh::BoundaryFacet;
use unilateral::prelude::*;

/// The numbers below `n` in a reproducible disorder.
fn shuffled(n: usize, seed: usize) -> Vec<usize> {
    let mut numbers: Vec<usize> = (0..n).collect();
    numbers.sort_by_key(|k| (k + seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20);
    numbers
}

/// A mesh as MSH 2.2, with nodes, corners, facets and cells in disorder and a node that no cell uses. Regions
/// and boundary groups have the number of their names plus one as name.
fn in_disorder<const D: usize>(mesh: &Mesh<D>, seed: usize) -> String {
    let tag = |v: u32| 3 * (v as usize + seed) + 1;
    let n = mesh.vertices().len();
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n2 9 9 9\n", n + 1);
    for v in shuffled(n, seed) {
        let x = mesh.vertices()[v];
        let [x, y, z] = [0, 1, 2].map(|k| if k < D { x[k] } else { 0.0 });
        text.push_str(&format!("{} {x:?} {y:?} {z:?}\n", tag(v as u32)));
    }
    let cell = |c: usize| (c, None, mesh.region(c), mesh.cell(c).to_vec());
    let facet = |f: &BoundaryFacet| {
        let vertices = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
        (f.cell as usize, Some(f.local), usize::from(f.group), vertices)
    };
    let cells = (0..mesh.n_cells()).map(cell);
    let elements: Vec<_> = mesh.boundary().iter().map(facet).chain(cells).collect();
    text.push_str(&format!("$EndNodes\n$Elements\n{}\n", elements.len()));
    for k in shuffled(elements.len(), seed) {
        let (_, local, group, vertices) = &elements[k];
        let of_type = [15, 1, 2, 4][D - usize::from(local.is_some())];
        text.push_str(&format!("{} {of_type} 2 {} 1", k + 1, group + 1));
        for at in shuffled(vertices.len(), seed + k) {
            text.push_str(&format!(" {}", tag(vertices[at])));
        }
        text.push('\n');
    }
    text + "$EndElements\n"
}

fn is_the_same_in_any_order<const D: usize>(mesh: &Mesh<D>) {
    let names = (0..3).map(|k| vec![k.to_string()]).collect();
    let regions = (0..mesh.n_cells()).map(|c| (c % 3) as u16).collect();
    let mesh = mesh.clone().with_regions(names, regions).unwrap();
    let text = in_disorder(&mesh, 5);
    let one = parse::<D>(text.as_bytes());
    for seed in [11, 12, 13] {
        let other = parse::<D>(in_disorder(&mesh, seed).as_bytes());
        assert!(one.mesh.vertices() == other.mesh.vertices(), "vertices, {seed}");
        assert!(one.mesh.cells() == other.mesh.cells(), "cells, {seed}");
        for (f, g) in one.mesh.boundary().iter().zip(other.mesh.boundary()) {
            assert_eq!((f.cell, f.local, f.condition), (g.cell, g.local, g.condition));
            let names = |mesh: &Mesh<D>, group: u16| {
                mesh.boundary_groups()[usize::from(group)].names.clone()
            };
            assert_eq!(names(&one.mesh, f.group), names(&other.mesh, g.group));
        }
        let region = |mesh: &Mesh<D>, c: usize| mesh.regions()[mesh.region(c)].clone();
        for c in 0..one.mesh.n_cells() {
            assert_eq!(region(&one.mesh, c), region(&other.mesh, c), "cell {c}");
        }
    }
    // neighbours are near: numbers in disorder differ in a cell by 0.5 to 0.6 of all in the mean
    let spread = |mesh: &Mesh<D>| {
        let of = |cell: &[u32]| f64::from(cell[D] - cell[0]);
        mesh.cells().chunks_exact(D + 1).map(of).sum::<f64>() / mesh.n_cells() as f64
    };
    assert!(spread(&one.mesh) < 0.3 * mesh.vertices().len() as f64, "{}", spread(&one.mesh));
}

#[test]
fn the_order_of_a_file_does_not_matter() {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let file = |name: &str| std::fs::read(data.join(name)).unwrap();
    is_the_same_in_any_order(&Mesh::kuhn_box(&BoxDomain::<1>::centred(0.3), [50]).unwrap());
    is_the_same_in_any_order(&parse::<2>(&file("unstructured_square.msh")).mesh);
    is_the_same_in_any_order(&parse::<3>(&file("unstructured_cube.msh")).mesh);
}

/// The box with `n` cubes along each axis is read cube by cube, each beside the one before it: the simplices of a cube
/// have their barycentres in its box of a lattice with `n` boxes, a power of two.
#[test]
fn neighbours_in_the_order_of_cells_are_neighbours_in_space() {
    fn check<const D: usize>(n: usize) {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(n as f64));
        let mesh = Mesh::<D>::kuhn_box(&domain, [n; D]).unwrap();
        let read = parse::<D>(in_disorder(&mesh, 3).as_bytes()).mesh;
        let cube = |cell: usize| read.barycentre(cell).map(f64::floor);
        let mut cubes: Vec<Point<D>> = (0..read.n_cells()).map(cube).collect();
        cubes.dedup();
        assert_eq!(cubes.len(), n.pow(D as u32), "each cube once");
        for pair in cubes.windows(2) {
            assert_eq!((pair[1] - pair[0]).abs().sum(), 1.0, "{:?} {:?}", pair[0], pair[1]);
        }
    }
    check::<1>(64);
    check::<2>(16);
    check::<3>(8);
}

/// Cells that are nearer to each other than the curve tells keep their order.
#[test]
fn cells_at_one_place_keep_their_order() {
    let nodes = [0.0, 0.5, 0.5 + 1e-8, 0.5 + 2e-8, 0.5 + 3e-8, 1.0];
    for order in [[0, 1, 2, 3, 4], [0, 3, 1, 2, 4], [4, 2, 3, 1, 0]] {
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n".to_owned();
        for (k, x) in nodes.iter().enumerate() {
            text.push_str(&format!("{} {x:?} 0 0\n", k + 1));
        }
        text.push_str("$EndNodes\n$Elements\n7\n1 15 2 1 1 1\n2 15 2 1 1 6\n");
        for (k, cell) in order.into_iter().enumerate() {
            text.push_str(&format!("{} 1 2 2 1 {} {}\n", k + 3, cell + 1, cell + 2));
        }
        let mesh = parse::<1>((text + "$EndElements\n").as_bytes()).mesh;
        let number = |cell: usize| {
            let x = mesh.barycentre(cell)[0];
            nodes.windows(2).position(|ends| ends[0] < x && x < ends[1]).unwrap()
        };
        let found: Vec<usize> = (0..5).map(number).collect();
        let inner: Vec<usize> = order.into_iter().filter(|cell| (1..4).contains(cell)).collect();
        assert_eq!(found, [&[0][..], &inner, &[4]].concat(), "{order:?}");
    }
}
