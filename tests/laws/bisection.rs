//! Bisection: conformity, ancestors, names, shapes.

use crate::support::meshes::{Random, Raw, mixed_box};
use proptest::prelude::*;
use std::path::Path;
use unilateral::mesh::{
    BisectedMesh, Bisection, BoundaryCondition, BoundaryFacet, BoxDomain, GroupedFacet,
    MeshErrorKind, TaggedFacet, gmsh,
};
use unilateral::prelude::*;

fn unit_box<const D: usize>(n: usize) -> Mesh<D> {
    Mesh::kuhn_box(&mixed_box(), [n; D]).unwrap()
}

fn file<const D: usize>(name: &str) -> Mesh<D> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    gmsh::read(&path).unwrap().mesh
}

/// The smallest ratio of volume to the power `D` of the diameter.
fn worst_shape<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let shape = |c| mesh.geometry(c).volume / mesh.cell_diameter(c).powi(D as i32);
    (0..mesh.n_cells()).map(shape).fold(f64::INFINITY, f64::min)
}

/// The barycentric coordinates of a point in a cell.
fn barycentric<const D: usize>(mesh: &Mesh<D>, cell: usize, x: &Point<D>) -> Vec<f64> {
    let geometry = mesh.geometry(cell);
    let from = x - mesh.vertices()[mesh.cell(cell)[0] as usize];
    (0..=D).map(|i| f64::from(i == 0) + geometry.gradient(i).dot(&from)).collect()
}

/// Made anew from its lists, the mesh is accepted and the same: cells whose facets have vertices in
/// their interior would be refused.
fn check_conformity<const D: usize>(mesh: &Mesh<D>) {
    let facet = |f: &BoundaryFacet| {
        let v: Vec<u32> = mesh.facet_vertices(f.cell as usize, f.local as usize).collect();
        TaggedFacet { vertices: std::array::from_fn(|k| v[k]), condition: f.condition }
    };
    let boundary: Vec<_> = mesh.boundary().iter().map(facet).collect();
    let again = Mesh::<D>::new(mesh.vertices().to_vec(), mesh.cells().to_vec(), &boundary).unwrap();
    assert_eq!(again.vertices(), mesh.vertices(), "every vertex is used");
    assert_eq!(again.cells(), mesh.cells());
    let conditions = |mesh: &Mesh<D>| -> Vec<_> {
        mesh.boundary().iter().map(|f| (f.cell, f.local, f.condition)).collect()
    };
    assert_eq!(conditions(&again), conditions(mesh));
    assert_eq!(again.is_supported(), mesh.is_supported());
}

/// Cells lie in their ancestors and fill them, the marked ones are divided; vertices are midpoints;
/// regions and boundary groups are those of the ancestors.
fn check_inheritance<const D: usize>(
    old: &Mesh<D>,
    new: &Mesh<D>,
    bisection: &Bisection,
    marked: &[usize],
) {
    let Bisection { ancestors, parents, .. } = bisection;
    assert_eq!(ancestors.len(), new.n_cells());
    assert!(ancestors.is_sorted());
    let mut volumes = vec![0.0; old.n_cells()];
    let mut children = vec![0; old.n_cells()];
    for (c, &ancestor) in ancestors.iter().enumerate() {
        let ancestor = ancestor as usize;
        volumes[ancestor] += new.geometry(c).volume;
        children[ancestor] += 1;
        for &v in new.cell(c) {
            let lambda = barycentric(old, ancestor, &new.vertices()[v as usize]);
            assert!(lambda.iter().all(|&l| l > -1e-10), "cell {c} leaves {ancestor}: {lambda:?}");
        }
        assert_eq!(new.region(c), old.region(ancestor));
    }
    for (c, volume) in volumes.iter().enumerate() {
        assert!((volume / old.geometry(c).volume - 1.0).abs() < 1e-10, "ancestor {c} is filled");
    }
    assert!(marked.iter().all(|&c| children[c] > 1), "marked cells are divided");
    for (c, _) in children.iter().enumerate().filter(|(_, n)| **n == 1) {
        let position = ancestors.binary_search(&(c as u32)).unwrap();
        assert_eq!(new.cell(position), old.cell(c), "other cells stay");
    }
    assert_eq!(new.boundary_groups(), old.boundary_groups());
    for f in new.boundary() {
        let (ancestor, x) = (
            ancestors[f.cell as usize] as usize,
            new.facet_barycentre(f.cell as usize, f.local as usize),
        );
        let lambda = barycentric(old, ancestor, &x);
        let local = (0..=D).min_by(|&i, &j| lambda[i].abs().total_cmp(&lambda[j].abs())).unwrap();
        assert!(lambda[local].abs() < 1e-10);
        assert_eq!(Some(usize::from(f.group)), old.boundary_group(ancestor, local));
    }
    assert_eq!(parents.len(), new.vertices().len());
    for (v, &[a, b]) in parents.iter().enumerate() {
        let [x, y] = [a, b].map(|v| new.vertices()[v as usize]);
        if v < old.vertices().len() {
            assert_eq!([a as usize, b as usize], [v, v]);
            assert_eq!(new.vertices()[v], old.vertices()[v]);
        } else {
            assert!(a < b && (b as usize) < v);
            assert_eq!(new.vertices()[v], (x + y) * 0.5);
        }
    }
}

/// Bisects a shuffled mesh of a box several times at random marks, and checks every step.
fn check_random<const D: usize>(n: usize, steps: usize, random: &mut Random) {
    let raw = Raw::<D>::jittered(&mixed_box(), n, 0.6, random).shuffled(random);
    let mut refined = BisectedMesh::new(raw.mesh());
    for _ in 0..steps {
        let n_cells = refined.mesh().n_cells();
        let marked: Vec<usize> =
            (0..random.below(1 + n_cells / 4)).map(|_| random.below(n_cells)).collect();
        let (next, bisection) = refined.bisect(&marked).unwrap();
        check_conformity(next.mesh());
        check_inheritance(refined.mesh(), next.mesh(), &bisection, &marked);
        refined = next;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn random_bisections_are_conforming_and_nested(seed in 0_u64..1_000_000) {
        let random = &mut Random(seed);
        check_random::<1>(5, 6, random);
        check_random::<2>(3, 6, random);
        check_random::<3>(2, 4, random);
    }
}

/// Thirty bisections at the cells that `is_marked` chooses in each step. The worst shape stays above a
/// share of the first one, and the second half of the steps makes no worse one than the first half.
fn check_shapes<const D: usize>(
    mesh: Mesh<D>,
    share: f64,
    is_marked: impl Fn(&Mesh<D>, usize, usize) -> bool,
) {
    let floor = share * worst_shape(&mesh);
    let mut refined = BisectedMesh::new(mesh);
    let mut worst = [f64::INFINITY; 2];
    for step in 0..30 {
        let mesh = refined.mesh();
        let marked: Vec<usize> =
            (0..mesh.n_cells()).filter(|&c| is_marked(mesh, c, step)).collect();
        assert!(!marked.is_empty(), "step {step}");
        refined = refined.bisect(&marked).unwrap().0;
        worst[step / 15] = worst[step / 15].min(worst_shape(refined.mesh()));
    }
    check_conformity(refined.mesh());
    assert!(worst[0] >= floor, "{worst:?} against {floor}");
    assert!(worst[1] >= worst[0] * (1.0 - 1e-9), "{worst:?}");
}

/// Marks the cells that contain a point.
fn around<const D: usize>(x: Point<D>) -> impl Fn(&Mesh<D>, usize, usize) -> bool {
    move |mesh, c, _| barycentric(mesh, c, &x).iter().all(|&l| l > -1e-9)
}

#[test]
fn shapes_are_bounded_towards_a_point() {
    check_shapes(unit_box::<1>(3), 0.999, around(Point::from([0.3])));
    check_shapes(unit_box::<2>(3), 0.999, around(Point::from([0.3, 0.7])));
    check_shapes(unit_box::<2>(2), 0.999, around(Point::from([0.0, 0.0])));
    check_shapes(Mesh::disc(1.0, 2).unwrap(), 0.4, around(Point::from([0.0, 0.0])));
    check_shapes(file::<2>("unstructured_square.msh"), 0.5, around(Point::from([0.3, 0.1])));
    check_shapes(unit_box::<3>(2), 0.9, around(Point::from([0.0, 0.0, 0.0])));
    check_shapes(unit_box::<3>(2), 0.9, around(Point::from([0.3, 0.4, 0.7])));
    let inside = Point::from([0.3, 0.1, 0.2]);
    check_shapes(file::<3>("unstructured_cube.msh"), 0.3, around(inside));
    check_shapes(file::<3>("unstructured_half_cube.msh"), 0.3, around(Point::zeros()));
}

/// Part of an edge or of a circle, which halves as the sizes of cells do once these are small.
fn part(step: usize, first: usize, dimension: usize) -> f64 {
    0.5_f64.powf(step.saturating_sub(first) as f64 / dimension as f64)
}

#[test]
fn shapes_are_bounded_towards_an_edge() {
    // cells with an edge on the line x = y = -1 or 0, up to a height
    let along = |low: f64| {
        move |mesh: &Mesh<3>, c: usize, step: usize| {
            let on_line = |&&v: &&u32| {
                let x = mesh.vertices()[v as usize];
                x[0] == low && x[1] == low && x[2] <= part(step, 9, 3)
            };
            mesh.cell(c).iter().filter(on_line).count() > 0
        }
    };
    check_shapes(unit_box::<3>(2), 0.9, along(0.0));
    check_shapes(file::<3>("unstructured_half_cube.msh"), 0.3, along(-1.0));
}

#[test]
fn shapes_are_bounded_towards_a_circle() {
    // cells that a circle around the origin cuts, up to an angle
    let circle = |radius: f64| {
        move |mesh: &Mesh<2>, c: usize, step: usize| {
            let corners = mesh.cell(c).iter().map(|&v| mesh.vertices()[v as usize]);
            let inside = corners.clone().filter(|x| x.norm() < radius).count();
            let mut angles = corners.map(|x| x[1].atan2(x[0]).abs());
            let largest = std::f64::consts::PI * part(step, 12, 2);
            inside % 3 != 0 && angles.any(|angle| angle <= largest)
        }
    };
    check_shapes(unit_box::<2>(4), 0.999, circle(0.7));
    check_shapes(Mesh::l_shape(1.0, 3).unwrap(), 0.999, circle(0.7));
    check_shapes(file::<2>("unstructured_square.msh"), 0.5, circle(0.7));
}

#[test]
fn names_are_inherited() {
    fn check<const D: usize>() {
        let raw = Raw::<D>::jittered(&mixed_box(), 2, 0.3, &mut Random(1));
        let group = |f: &TaggedFacet<D>| {
            let x: f64 = f.vertices.iter().map(|&v| raw.vertices[v as usize][0]).sum();
            GroupedFacet { vertices: f.vertices, group: u16::from(x < 1e-9) }
        };
        let grouped: Vec<_> = raw.boundary.iter().map(group).collect();
        let names = ["wall", "inlet"].map(str::to_owned);
        let mesh = Mesh::<D>::with_groups(raw.vertices, raw.cells, &grouped, &names).unwrap();
        let regions = (0..mesh.n_cells()).map(|c| u16::from(mesh.barycentre(c)[0] > 0.5));
        let regions = regions.collect();
        let named = ["steel", "rubber"].map(|name| vec![name.to_owned()]).to_vec();
        let mesh = mesh.with_regions(named, regions).unwrap();
        let mesh = mesh
            .with_boundary_conditions(&|name| {
                (name == "inlet").then_some(BoundaryCondition::Contact)
            })
            .unwrap();
        let mut refined = BisectedMesh::new(mesh);
        for _ in 0..4 {
            let marked: Vec<usize> = (0..refined.mesh().n_cells()).step_by(2).collect();
            let (next, bisection) = refined.bisect(&marked).unwrap();
            check_inheritance(refined.mesh(), next.mesh(), &bisection, &marked);
            assert_eq!(next.mesh().regions(), refined.mesh().regions());
            refined = next;
        }
        let mesh = refined.into_mesh();
        assert!((0..mesh.n_cells()).any(|c| mesh.region(c) == 1));
        for f in mesh.boundary() {
            let x = mesh.facet_barycentre(f.cell as usize, f.local as usize)[0];
            let names = &mesh.boundary_groups()[usize::from(f.group)].names;
            assert_eq!(names, &[if x < 1e-9 { "inlet" } else { "wall" }]);
            assert_eq!(f.condition == BoundaryCondition::Contact, x < 1e-9);
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn neither_the_order_of_marks_nor_the_number_of_threads_matters() {
    fn check<const D: usize>(n: usize) {
        let mut random = Random(3);
        let raw = Raw::<D>::jittered(&mixed_box(), n, 0.5, &mut random).shuffled(&mut random);
        let start = BisectedMesh::new(raw.mesh());
        let run = |threads, reversed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut refined = start.clone();
                let mut steps = Vec::new();
                for _ in 0..3 {
                    let mut marked: Vec<usize> = (0..refined.mesh().n_cells()).step_by(3).collect();
                    if reversed {
                        marked.reverse();
                        marked.extend_from_within(..2);
                    }
                    let (next, bisection) = refined.bisect(&marked).unwrap();
                    steps.push(bisection);
                    refined = next;
                }
                let mesh = refined.into_mesh();
                let lists = (mesh.cells().to_vec(), mesh.boundary().to_vec(), steps);
                (mesh.vertices().to_vec(), lists)
            })
        };
        let one = run(1, false);
        assert!(one == run(1, true), "{D}-d, marks reversed");
        assert!(one == run(4, false), "{D}-d, four threads");
    }
    check::<1>(50);
    check::<2>(8);
    check::<3>(4);
}

#[test]
fn marks_that_cannot_be_followed() {
    let start = BisectedMesh::new(unit_box::<2>(2));
    let error = start.bisect(&[0, 8]).unwrap_err();
    assert_eq!(error.kind, MeshErrorKind::Parameter);
    assert_eq!(error.to_string(), "marked cell = 8: less than 8, the number of cells");
    let (same, bisection) = start.bisect(&[]).unwrap();
    assert_eq!(same.mesh().cells(), start.mesh().cells());
    assert_eq!(bisection.ancestors, (0..8).collect::<Vec<u32>>());
    // towards a point that is no scalar, until the cells are as small as rounding
    fn refine<const D: usize>(n: usize) {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mut refined = BisectedMesh::new(Mesh::<D>::kuhn_box(&domain, [n; D]).unwrap());
        let target = Point::<D>::repeat(1.0 / 3.0);
        let error = loop {
            let mesh = refined.mesh();
            let distance = |c: &usize| (mesh.barycentre(*c) - target).norm();
            let nearest = (0..mesh.n_cells()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            match refined.bisect(&[nearest.unwrap()]) {
                Ok((next, _)) => refined = next,
                Err(error) => break error,
            }
        };
        let small = |cell: usize| refined.mesh().cell_diameter(cell) < 1e-13;
        assert_eq!(error.kind, MeshErrorKind::TooSmallToBisect, "{error}");
        assert!(error.cells.len() == 1 && small(error.cells[0]), "{error}");
        assert!(error.to_string().contains("rounding changes the volume"), "{error}");
    }
    refine::<1>(3);
    refine::<2>(2);
    refine::<3>(1);
}
