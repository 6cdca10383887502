//! Meshes that fold or lie on themselves.

use crate::support::meshes::{Random, Raw, mixed_box};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh, MeshError, MeshErrorKind, TaggedFacet};
use unilateral::prelude::*;

fn boxes<const D: usize>(n: usize) -> Raw<D> {
    let mut random = Random(5);
    let held = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Raw::jittered(&held, n, 0.3, &mut random).shuffled(&mut random)
}

fn made<const D: usize>(raw: &Raw<D>) -> Result<Mesh<D>, MeshError> {
    Mesh::new(raw.vertices.clone(), raw.cells.clone(), &raw.boundary)
}

/// Two meshes as one, without common vertices.
fn both<const D: usize>(mut first: Raw<D>, second: &Raw<D>) -> Raw<D> {
    let shift = first.vertices.len() as u32;
    first.vertices.extend(&second.vertices);
    first.cells.extend(second.cells.iter().map(|v| v + shift));
    first.boundary.extend(
        second.boundary.iter().map(|f| TaggedFacet {
            vertices: f.vertices.map(|v| v + shift),
            condition: f.condition,
        }),
    );
    first
}

fn moved<const D: usize>(mut raw: Raw<D>, factor: f64, by: impl Into<Point<D>>) -> Raw<D> {
    let by = by.into();
    raw.vertices.iter_mut().for_each(|x| *x = *x * factor + by);
    raw
}

/// The two cells of the error overlap: the volume of their common box is positive.
fn check_overlap<const D: usize>(raw: &Raw<D>) {
    let error = made(raw).unwrap_err();
    assert_eq!(error.kind, MeshErrorKind::OverlappingCells, "{error}");
    let [first, second] = error.cells[..] else { panic!("{error}") };
    assert_ne!(first, second);
    let corners = |c: usize| {
        let cell = &raw.cells[c * (D + 1)..(c + 1) * (D + 1)];
        cell.iter().map(|&v| raw.vertices[v as usize])
    };
    let bounds = |c: usize, axis: usize| {
        let x = || corners(c).map(move |x| x[axis]);
        (x().fold(f64::INFINITY, f64::min), x().fold(f64::NEG_INFINITY, f64::max))
    };
    for axis in 0..D {
        let (a, b) = (bounds(first, axis), bounds(second, axis));
        assert!(a.0 < b.1 && b.0 < a.1, "cells {first} and {second} are apart on axis {axis}");
    }
}

#[test]
fn a_vertex_beyond_its_star_folds_the_mesh() {
    fn check<const D: usize>() {
        let mut raw = boxes::<D>(3);
        let inside = |x: &Point<D>| (x - Point::repeat(1.0 / 3.0)).norm() < 0.2;
        let vertex = raw.vertices.iter().position(inside).unwrap();
        raw.vertices[vertex] = Point::repeat(0.97);
        let error = made(&raw).unwrap_err();
        assert_eq!(error.kind, MeshErrorKind::FoldedCells, "{error}");
        let vertices = |c: usize| raw.cells[c * (D + 1)..(c + 1) * (D + 1)].to_vec();
        let [mut common, other] = [0, 1].map(|k| vertices(error.cells[k]));
        common.retain(|v| other.contains(v));
        common.sort_unstable();
        assert_eq!((error.cells.len(), common.len()), (2, D), "{error}");
        let said = format!("facet {common:?}: the mesh folds over there");
        assert!(error.to_string().contains(&said), "{error}");
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// Two triangles over one edge, and the same with one of them on the other side.
#[test]
fn two_cells_on_one_side_of_their_facet() {
    let mesh = |x: f64, order: [u32; 3]| {
        let vertices = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.4], [x, 0.5]].map(Point::<2>::from);
        let condition = BoundaryCondition::Dirichlet;
        let boundary =
            [[0, 2], [1, 2], [0, 3], [1, 3]].map(|vertices| TaggedFacet { vertices, condition });
        let cells = [&[0, 1, 2], &order[..]].concat();
        Mesh::<2>::new(vertices.to_vec(), cells, &boundary)
    };
    for order in [[0, 1, 3], [3, 1, 0], [1, 3, 0]] {
        assert_eq!(mesh(-2.0, order).unwrap().n_cells(), 2);
        let folded = mesh(2.0, order).unwrap_err();
        assert_eq!((folded.kind, &folded.cells[..]), (MeshErrorKind::FoldedCells, &[0, 1][..]));
        assert!(folded.to_string().contains("their common facet [0, 1]: "), "{folded}");
    }
}

#[test]
fn components_that_overlap() {
    fn check<const D: usize>() {
        for shift in [0.0, 0.3, -0.6] {
            check_overlap(&both(boxes::<D>(3), &moved(boxes(4), 1.0, Point::repeat(shift))));
        }
        // one inside another, far from its boundary
        check_overlap(&both(boxes::<D>(4), &moved(boxes(2), 0.1, Point::repeat(0.44))));
        // side by side, without and with a common side
        for shift in [1.5, 1.0] {
            let mut by = Point::<D>::zeros();
            by[0] = shift;
            let mesh = made(&both(boxes::<D>(3), &moved(boxes(4), 1.0, by))).unwrap();
            assert_eq!(
                mesh.n_cells(),
                boxes::<D>(3).mesh().n_cells() + boxes::<D>(4).mesh().n_cells()
            );
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// No sound mesh is refused: moved vertices, any numbering, holes, three parts.
#[test]
fn sound_meshes_are_accepted() {
    fn check<const D: usize>(n: usize) {
        for seed in 0..40 {
            let mut random = Random(seed);
            let raw = Raw::<D>::jittered(&mixed_box(), n, 0.4, &mut random).shuffled(&mut random);
            assert!(made(&raw).is_ok(), "seed {seed}: {:?}", made(&raw).err());
        }
    }
    check::<1>(9);
    check::<2>(5);
    check::<3>(3);
}

/// How many facets of the boundary lie on others, as the error of the first facet without a condition says, if that facet
/// does. All facets but some have one.
fn coincident<const D: usize>(
    vertices: &[[f64; D]],
    cells: &[Vec<u32>],
    without: &[[u32; D]],
) -> usize {
    let facet = |cell: &[u32], opposite: usize| -> [u32; D] {
        let mut others = (0..=D).filter(|&k| k != opposite).map(|k| cell[k]);
        std::array::from_fn(|_| others.next().unwrap())
    };
    let all = cells.iter().flat_map(|cell| (0..=D).map(|k| facet(cell, k)));
    let boundary = all
        .filter(|facet| !without.contains(facet))
        .map(|vertices| TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet })
        .collect();
    let vertices = vertices.iter().map(|x| Point::from(*x)).collect();
    let error = made(&Raw { vertices, cells: cells.concat(), boundary }).unwrap_err();
    assert_eq!(error.kind, MeshErrorKind::UntaggedFacet, "{error}");
    let message = error.to_string();
    let count = message.split_once("nodes of its own, as ").map(|(_, rest)| rest);
    count.map_or(0, |rest| rest.split(' ').next().unwrap().parse().unwrap())
}

#[test]
fn facets_lie_on_each_other_whatever_their_sizes() {
    // an edge over two others, with common ends, and a cell beside them
    let points = [[0.0, 0.0], [1.0, 0.0], [0.25, 0.0], [0.5, -1.0], [0.2, 1.0], [0.6, 1.0]];
    let points = [&points[..], &[[2.0, 0.0], [1.5, 1.0]]].concat();
    let cells = [vec![0, 1, 3], vec![0, 2, 4], vec![1, 2, 5], vec![1, 6, 7]];
    for edge in [[0, 1], [0, 2], [1, 2]] {
        assert_eq!(coincident(&points, &cells, &[edge]), 3, "{edge:?}");
    }
    for edge in [[1, 6], [0, 3], [2, 5]] {
        assert_eq!(coincident(&points, &cells, &[edge]), 0, "{edge:?}");
    }
    // in a line of nodes far from the origin
    let points = [0.0, 1.0, 1.0, 2.0].map(|x| [x + 5e6]);
    let cells = [vec![0, 1], vec![2, 3]];
    for (node, expected) in [(0, 0), (1, 2), (2, 2), (3, 0)] {
        assert_eq!(coincident(&points, &cells, &[[node]]), expected, "{node}");
    }
    // a triangle in a larger one, and one across it
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.5, 1.0, 0.0],
        [0.3, 0.3, -1.0],
        [0.45, 0.35, 0.0],
        [0.5, 0.4, 0.0],
        [0.4, 0.45, 0.0],
        [0.45, 0.4, 1.0],
    ];
    let cells = [vec![0, 1, 2, 3], vec![4, 5, 6, 7]];
    for (triangle, expected) in [([4, 5, 6], 1), ([0, 1, 2], 0), ([4, 5, 7], 0), ([0, 1, 3], 0)] {
        assert_eq!(coincident(&points, &cells, &[triangle]), expected, "{triangle:?}");
    }
}
