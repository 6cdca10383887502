//! Facets, refinement, boxes, and every way a mesh can be wrong.

use crate::support::meshes::{Random, Raw, mixed_box};
use crate::support::panics::message_of_panic;
use proptest::prelude::*;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{
    BoundaryCondition, Edges, Facets, Mesh, MeshError, MeshErrorKind, Neighbour, Neighbours,
    TaggedFacet,
};
use unilateral::prelude::*;

fn volume<const D: usize>(mesh: &Mesh<D>) -> f64 {
    (0..mesh.n_cells()).map(|c| mesh.geometry(c).volume).sum()
}

/// Neighbours are mutual and share vertices; the facets of all cells are counted once each.
fn check_topology<const D: usize>(mesh: &Mesh<D>) {
    let neighbours = Neighbours::new(mesh);
    let facets = Facets::new(mesh, &neighbours);
    for c in 0..mesh.n_cells() {
        assert!(mesh.cell(c).is_sorted());
        for i in 0..=D {
            if let Neighbour::Cell { cell, local } = neighbours.across(c, i) {
                let back = neighbours.across(cell as usize, local as usize);
                assert_eq!(back, Neighbour::Cell { cell: c as u32, local: i as u8 });
                assert!(
                    mesh.facet_vertices(c, i)
                        .eq(mesh.facet_vertices(cell as usize, local as usize))
                );
                let (a, b) = (mesh.geometry(c), mesh.geometry(cell as usize));
                assert!(
                    (a.normal(i) + b.normal(local as usize)).norm() < 1e-12,
                    "normals opposite"
                );
                assert!((a.facet_measure(i) - b.facet_measure(local as usize)).abs() < 1e-12);
            }
        }
    }
    assert_eq!(2 * facets.interior().len() + mesh.boundary().len(), mesh.cells().len());
    for condition in
        [BoundaryCondition::Dirichlet, BoundaryCondition::Neumann, BoundaryCondition::Contact]
    {
        assert_eq!(
            facets.boundary(condition).len(),
            mesh.boundary().iter().filter(|f| f.condition == condition).count()
        );
        for f in facets.boundary(condition) {
            let (c, i) = facets.here(f);
            assert_eq!(neighbours.across(c, i), Neighbour::Boundary(condition));
        }
    }
    let numbers = facets.numbers::<D>(mesh.n_cells());
    for f in facets.interior() {
        let ((c, i), (d, j)) = (facets.here(f), facets.there(f));
        assert!(c < d);
        assert_eq!(numbers[c * (D + 1) + i] as usize, f);
        assert_eq!(numbers[d * (D + 1) + j] as usize, f);
    }
}

/// The smallest ratio of volume to the cube (square) of the diameter.
fn worst_shape<const D: usize>(mesh: &Mesh<D>) -> f64 {
    (0..mesh.n_cells())
        .map(|c| mesh.geometry(c).volume / mesh.cell_diameter(c).powi(D as i32))
        .fold(f64::INFINITY, f64::min)
}

fn check_refinement<const D: usize>(times: usize) {
    let mut random = Random(7);
    let coarse = Raw::<D>::jittered(&mixed_box(), 2, 0.5, &mut random).shuffled(&mut random).mesh();
    let shape = worst_shape(&coarse);
    let mut meshes = vec![coarse];
    for _ in 0..times {
        let before = &meshes[meshes.len() - 1];
        let (after, refinement) = before.refine().unwrap();
        let after = &after;
        check_topology(after);
        assert_eq!(after.n_cells(), before.n_cells() << D);
        assert_eq!(after.boundary().len(), before.boundary().len() << (D - 1));
        let rounding = f64::EPSILON * after.n_cells() as f64;
        assert!((volume(after) - volume(before)).abs() < rounding.max(1e-14));
        for c in 0..after.n_cells() {
            // children have equal volumes and lie in their parents
            let parent = before.geometry(c >> D);
            assert!(
                (after.geometry(c).volume * f64::from(1 << D) / parent.volume - 1.0).abs() < 1e-10
            );
            let corner = before.vertices()[before.cell(c >> D)[0] as usize];
            let inside = after.barycentre(c) - corner;
            let lambda: Vec<f64> =
                (0..=D).map(|i| f64::from(i == 0) + parent.gradient(i).dot(&inside)).collect();
            assert!(lambda.iter().all(|&l| l > 0.0));
        }
        for (v, &[a, b]) in refinement.parents.iter().enumerate() {
            let middle = (before.vertices()[a as usize] + before.vertices()[b as usize]) * 0.5;
            assert!((after.vertices()[v] - middle).norm() < 1e-15);
        }
        meshes.push(after.clone());
    }
    // Bey's rule keeps shapes: at most three classes of each tetrahedron
    let floor = if D == 3 { 0.2 } else { 0.999 };
    assert!(worst_shape(&meshes[times]) > floor * shape);
    let last = worst_shape(&meshes[times]);
    let before = worst_shape(&meshes[times - 1]);
    assert!((last / before - 1.0).abs() < 1e-6, "shapes settle: {before} {last}");
}

#[test]
fn refinement_in_one_dimension() {
    check_refinement::<1>(4);
}
#[test]
fn refinement_in_two_dimensions() {
    check_refinement::<2>(4);
}
#[test]
fn refinement_in_three_dimensions() {
    check_refinement::<3>(4);
}

#[test]
fn refined_boxes_are_finer_boxes() {
    fn check<const D: usize>() {
        let coarse = Mesh::<D>::kuhn_box(&mixed_box(), [2; D]).unwrap();
        let fine = Mesh::<D>::kuhn_box(&mixed_box(), [4; D]).unwrap();
        let key = |mesh: &Mesh<D>| {
            let mut all: Vec<Vec<i64>> = (0..mesh.n_cells())
                .map(|c| {
                    let mut points: Vec<Vec<i64>> = mesh
                        .cell(c)
                        .iter()
                        .map(|&v| {
                            mesh.vertices()[v as usize]
                                .iter()
                                .map(|x| (x * 64.0).round() as i64)
                                .collect()
                        })
                        .collect();
                    points.sort();
                    points.concat()
                })
                .collect();
            all.sort();
            all
        };
        assert_eq!(key(&coarse.refine().unwrap().0), key(&fine));
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// The condition of a fine boundary facet is that of the side on which it lies.
#[test]
fn refinement_keeps_the_conditions_on_the_boundary() {
    fn check<const D: usize>() {
        let domain: BoxDomain<D> = mixed_box();
        let mut mesh = Mesh::<D>::kuhn_box(&domain, [2; D]).unwrap();
        for _ in 0..2 {
            mesh = mesh.refine().unwrap().0;
            let mut seen = [0; 3];
            for f in mesh.boundary() {
                let x = mesh.facet_barycentre(f.cell as usize, f.local as usize);
                let sides = (0..D).flat_map(|k| [(k, 0, x[k]), (k, 1, 1.0 - x[k])]);
                let (axis, end, _) = sides.min_by(|a, b| a.2.total_cmp(&b.2)).unwrap();
                assert_eq!(f.condition, domain.sides[axis][end], "{x}");
                seen[f.condition as usize] += 1;
            }
            assert_eq!(seen.iter().filter(|&&n| n > 0).count(), if D > 1 { 3 } else { 2 });
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn boxes_have_the_stated_cells_and_sides() {
    let domain = BoxDomain::dirichlet(Point::from([-1.0, 0.0]), Point::from([1.0, 1.0])).side(
        1,
        0,
        BoundaryCondition::Contact,
    );
    assert_eq!(domain.counts(8), [16, 8]);
    let mesh = Mesh::<2>::kuhn_box(&domain, domain.counts(8)).unwrap();
    check_topology(&mesh);
    assert_eq!((mesh.n_cells(), mesh.vertices().len()), (256, 153));
    for f in mesh.boundary() {
        let on_floor = mesh.facet_barycentre(f.cell as usize, f.local as usize)[1] == 0.0;
        assert_eq!(on_floor, f.condition == BoundaryCondition::Contact);
    }
    // every diagonal runs from the lower left to the upper right corner
    for c in 0..mesh.n_cells() {
        let cell = mesh.cell(c);
        let diagonal = mesh.vertices()[cell[2] as usize] - mesh.vertices()[cell[0] as usize];
        assert!(diagonal.iter().all(|&d| (d - 0.125).abs() < 1e-15));
    }
}

#[test]
fn topology_does_not_depend_on_the_number_of_threads() {
    fn check<const D: usize>(n: usize) {
        let mut random = Random(8);
        let raw = Raw::<D>::jittered(&mixed_box(), n, 0.3, &mut random).shuffled(&mut random);
        let mesh = raw.mesh();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (fine, refinement) = mesh.refine().unwrap();
                let lists = (fine.cells().to_vec(), fine.boundary().to_vec(), refinement);
                (
                    Neighbours::new(&mesh),
                    Edges::with_cell_edges(&mesh),
                    lists,
                    fine.vertices().to_vec(),
                )
            })
        };
        let one = run(1);
        check_topology(&mesh);
        // enough vertices for several ranges
        for threads in [2, 8] {
            assert!(one == run(threads), "{D}-d with {threads} threads");
        }
    }
    check::<1>(3000);
    check::<2>(40);
    check::<3>(10);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn topology_does_not_depend_on_the_order_of_lists(seed in 0_u64..1_000_000) {
        let mut random = Random(seed);
        let plane = Raw::<2>::jittered(&mixed_box(), 3, 0.6, &mut random).shuffled(&mut random).mesh();
        check_topology(&plane);
        prop_assert!((volume(&plane) - 1.0).abs() < 1e-12);
        let space = Raw::<3>::jittered(&mixed_box(), 2, 0.4, &mut random).shuffled(&mut random).mesh();
        check_topology(&space);
        prop_assert!((volume(&space) - 1.0).abs() < 1e-12);
    }
}

/// Two triangles of the unit square, all Dirichlet.
fn square() -> Raw<2> {
    Raw::jittered(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), 1, 0.0, &mut Random(0))
}

fn refused(raw: &Raw<2>) -> MeshError {
    Mesh::<2>::new(raw.vertices.clone(), raw.cells.clone(), &raw.boundary).unwrap_err()
}

/// The mesh is refused for this reason, with a sentence that contains the words.
#[track_caller]
fn is_refused(raw: &Raw<2>, kind: MeshErrorKind, words: &str) {
    let error = refused(raw);
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

#[test]
fn unused_vertices_are_dropped() {
    let mut raw = square();
    raw.vertices.insert(0, Point::from([9.0, 9.0]));
    raw.cells.iter_mut().for_each(|v| *v += 1);
    raw.boundary.iter_mut().for_each(|f| f.vertices = f.vertices.map(|v| v + 1));
    let mesh = raw.mesh();
    assert_eq!(mesh.vertices().len(), 4);
    assert_eq!(mesh.domain_diameter(), 2_f64.sqrt());
}

#[test]
fn wrong_lists() {
    let mut raw = square();
    raw.cells.clear();
    is_refused(&raw, MeshErrorKind::NoCells, "the mesh has no cells of dimension 2");
    let mut raw = square();
    raw.cells.pop();
    let words = "5 cell vertices do not make cells of 3";
    is_refused(&raw, MeshErrorKind::IncompleteCell, words);
    let mut raw = square();
    raw.cells[4] = 77;
    let words = "cell 1 names vertex 77, but there are only 4";
    is_refused(&raw, MeshErrorKind::VertexOutOfRange, words);
    let mut raw = square();
    raw.vertices[2][1] = f64::NAN;
    let words = "coordinate 1 of vertex 2 is NaN: coordinates must be finite";
    is_refused(&raw, MeshErrorKind::NotFinite, words);
}

#[test]
fn wrong_cells() {
    let mut raw = square();
    raw.vertices[1] = (raw.vertices[0] + raw.vertices[3]) * 0.5;
    is_refused(&raw, MeshErrorKind::DegenerateCell, " is degenerate: volume ");
    let mut raw = square();
    let again: Vec<u32> = raw.cells[..3].iter().rev().copied().collect();
    raw.cells.extend(again);
    is_refused(&raw, MeshErrorKind::RepeatedCell, "cells 0 and 2 have the same vertices ");
    // once more all cells of a mesh, and a cell with no other beside it
    fn twice<const D: usize>(n: usize) {
        let mut raw = Raw::<D>::jittered(&mixed_box(), n, 0.0, &mut Random(0));
        let cells = raw.cells.clone();
        raw.cells.extend(cells);
        let error = Mesh::<D>::new(raw.vertices, raw.cells, &raw.boundary).unwrap_err();
        assert_eq!(error.kind, MeshErrorKind::RepeatedCell, "{error}");
    }
    twice::<1>(1);
    twice::<1>(4);
    twice::<2>(2);
    twice::<3>(2);
    // a third triangle on the diagonal
    let mut raw = square();
    raw.vertices.push(Point::from([2.0, -1.0]));
    raw.cells.extend([0, 3, 4]);
    let words = "facet [0, 3] belongs to cells [0, 1, 2]: ";
    is_refused(&raw, MeshErrorKind::FacetOfThreeCells, words);
}

#[test]
fn wrong_boundaries() {
    let mut raw = square();
    let lost = raw.boundary.remove(1);
    let words = format!("boundary facet {:?} of cell ", lost.vertices);
    is_refused(&raw, MeshErrorKind::UntaggedFacet, &words);
    is_refused(&raw, MeshErrorKind::UntaggedFacet, "dirichlet, neumann, contact");
    let mut raw = square();
    raw.boundary.push(TaggedFacet { condition: BoundaryCondition::Contact, ..raw.boundary[0] });
    let words = "is in two groups, dirichlet and contact, with different boundary conditions";
    is_refused(&raw, MeshErrorKind::FacetWithTwoConditions, words);
    assert_eq!(refused(&raw).tagged_facet, Some(4));
    let mut raw = square();
    raw.boundary.push(TaggedFacet { vertices: [0, 3], condition: BoundaryCondition::Dirichlet });
    is_refused(&raw, MeshErrorKind::NotABoundaryFacet, " but lies between two cells");
    let mut raw = square();
    raw.boundary.push(TaggedFacet { vertices: [1, 2], condition: BoundaryCondition::Dirichlet });
    is_refused(&raw, MeshErrorKind::NotABoundaryFacet, " but belongs to no cell");
    // the same facet twice with the same condition is no contradiction
    let mut raw = square();
    raw.boundary.push(raw.boundary[0]);
    assert_eq!(raw.mesh().boundary().len(), 4);
}

#[test]
fn a_component_that_nothing_holds() {
    let mut raw = square();
    let shift = raw.vertices.len() as u32;
    let far: Vec<_> = raw.vertices.iter().map(|x| x + Point::from([5.0, 0.0])).collect();
    raw.vertices.extend(far);
    let cells: Vec<u32> = raw.cells.iter().map(|v| v + shift).collect();
    raw.cells.extend(cells);
    let boundary: Vec<_> = raw
        .boundary
        .iter()
        .map(|f| TaggedFacet {
            vertices: f.vertices.map(|v| v + shift),
            condition: BoundaryCondition::Neumann,
        })
        .collect();
    raw.boundary.extend(boundary);
    let mut held = raw.boundary.clone();
    assert!(!raw.mesh().is_supported());
    held[5].condition = BoundaryCondition::Dirichlet;
    let mesh = Mesh::<2>::new(raw.vertices.clone(), raw.cells.clone(), &held).unwrap();
    assert!(mesh.is_supported());
}

#[test]
fn boxes_that_cannot_be_made() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let empty = Mesh::<2>::kuhn_box(&domain, [0, 3]).unwrap_err();
    assert_eq!(empty.kind, MeshErrorKind::Parameter, "{empty}");
    let huge = Mesh::<3>::kuhn_box(
        &BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)),
        [1_000_000_000; 3],
    );
    let huge = huge.unwrap_err();
    assert!(huge.kind == MeshErrorKind::TooLarge && huge.to_string().contains(" cells, at most"));
    let flat = BoxDomain::dirichlet(Point::zeros(), Point::from([1.0, 0.0]));
    let flat = Mesh::<2>::kuhn_box(&flat, [2, 2]).unwrap_err();
    assert_eq!(flat.kind, MeshErrorKind::Parameter, "{flat}");
}

#[test]
fn sides_that_a_box_has_not_are_named() {
    for (axis, end) in [(5, 0), (2, 0), (0, 2)] {
        let message = message_of_panic(|| {
            drop(BoxDomain::<2>::centred(1.0).side(axis, end, BoundaryCondition::Contact));
        });
        let said = format!("a box in dimension 2 has no side {end} across axis {axis}");
        assert!(message.starts_with(&said), "{message}");
    }
}
