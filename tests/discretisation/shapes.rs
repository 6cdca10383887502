//! Boundary groups with a shape: vertices, orders, parts and errors.

use std::f64::consts::PI;
use std::path::Path;
use unilateral::error_bound::Unproven;
use unilateral::mesh::{
    BisectedMesh, Extent, GroupedFacet, Layers, MeshError, MeshErrorKind, Part, gmsh,
};
use unilateral::prelude::*;
use unilateral::problem::Exact;

/// The unit disc, with a mesh from Gmsh, whose rim has a shape.
pub fn disc() -> Mesh<2> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/problems");
    let disc = gmsh::read::<2>(&folder.join("disc_orphan.msh")).unwrap().mesh;
    disc.with_shape("rim", |x| x.norm_squared() - 1.0).unwrap()
}

/// The octahedron around the origin, each face the base of a cell, in groups `upper` and `lower`.
fn octahedron() -> Mesh<3> {
    let signs = [1.0, -1.0];
    let ends =
        (0..3).flat_map(|k| signs.map(|s| Point::from_fn(|i, _| if i == k { s } else { 0.0 })));
    let vertices: Vec<Point<3>> = [Point::zeros()].into_iter().chain(ends).collect();
    let faces = (0..8_u32).map(|k| [1 + (k & 1), 3 + (k >> 1 & 1), 5 + (k >> 2)]);
    let cells = faces.clone().flat_map(|[a, b, c]| [0, a, b, c]).collect();
    let group = |vertices: [u32; 3]| GroupedFacet { vertices, group: u16::from(vertices[2] == 6) };
    let facets: Vec<_> = faces.map(group).collect();
    Mesh::with_groups(vertices, cells, &facets, &["upper", "lower"].map(str::to_owned)).unwrap()
}

/// The ball around that octahedron.
pub fn ball() -> Mesh<3> {
    let sphere = |x: &Point<3>| x.norm_squared() - 1.0;
    octahedron().with_shape("upper", sphere).unwrap().with_shape("lower", sphere).unwrap()
}

/// The solution `|x|^2 - 1` of a membrane or body over the unit ball.
pub fn paraboloid<const D: usize>(groups: &[&str]) -> Problem<D> {
    let exact = Exact::new(|x: &Point<D>| x.norm_squared() - 1.0, |x: &Point<D>| x * 2.0);
    let problem = Problem::new().constant_source(-2.0 * D as f64).solved_by(exact);
    groups.iter().fold(problem, |problem, group| problem.dirichlet_on(group, 0.0))
}

/// The largest distance from the unit sphere of vertices of the boundary.
fn off_sphere<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let facets = mesh.boundary().iter();
    let vertices = facets.flat_map(|f| mesh.facet_vertices(f.cell as usize, f.local as usize));
    vertices.map(|v| (mesh.vertices()[v as usize].norm() - 1.0).abs()).fold(0.0, f64::max)
}

fn volume<const D: usize>(mesh: &Mesh<D>) -> f64 {
    (0..mesh.n_cells()).map(|cell| mesh.geometry(cell).volume).sum()
}

/// The order of errors on a mesh and its refinement.
fn order([coarse, fine]: &[f64; 2]) -> f64 {
    (coarse / fine).log2()
}

/// The orders of the energy, which is minus pi on the disc and minus 8 pi / 5 in the ball, and of the solution in the energy norm.
fn orders<const D: usize>(mesh: Mesh<D>, scheme: &str, levels: [usize; 2]) -> [f64; 2] {
    let groups: Vec<String> = mesh.boundary_groups().iter().map(|g| g.names[0].clone()).collect();
    let groups: Vec<&str> = groups.iter().map(|name| &name[..]).collect();
    let problem = paraboloid(&groups);
    let energy = if D == 2 { -PI } else { -1.6 * PI };
    let scheme = scheme.parse::<NamedScheme>().unwrap().make();
    let mesh = problem.bind_boundary(mesh).unwrap();
    let solved = levels.map(|level| {
        let meshes = Hierarchy::refine(&mesh, level).unwrap();
        let solved = solve(&problem, &meshes, &*scheme).unwrap();
        assert!(solved.converged(), "{}", solved.outcome());
        assert!(solved.bound().unwrap().unproven.contains(&Unproven::Shape));
        [
            (solved.energy().unwrap().unwrap() - energy).abs(),
            solved.errors().unwrap().broken_energy.unwrap(),
        ]
    });
    [0, 1].map(|k| order(&solved.map(|errors| errors[k])))
}

#[test]
fn the_energy_on_the_unit_disc_is_minus_pi_with_order_two() {
    // the errors of WOPSIP and of the polygon have opposite signs and cancel on coarse meshes
    for (scheme, levels) in [("p1", [2, 3]), ("sipg", [2, 3]), ("wopsip", [4, 5])] {
        let [energy, gradient] = orders(disc(), scheme, levels);
        assert!((energy - 2.0).abs() < 0.1, "{scheme}: {energy}");
        assert!((gradient - 1.0).abs() < 0.02, "{scheme}: {gradient}");
    }
    // cells have straight sides
    for scheme in ["p2", "sipg-p2"] {
        let [energy, gradient] = orders(disc(), scheme, [2, 3]);
        assert!((energy - 2.0).abs() < 0.1, "{scheme}: {energy}");
        assert!((gradient - 1.5).abs() < 0.05, "{scheme}: {gradient}");
    }
}

#[test]
fn the_energy_in_a_ball_has_order_two() {
    for scheme in ["p1", "sipg"] {
        let [energy, gradient] = orders(ball(), scheme, [3, 4]);
        assert!((energy - 2.0).abs() < 0.1, "{scheme}: {energy}");
        assert!((gradient - 1.0).abs() < 0.05, "{scheme}: {gradient}");
    }
}

#[test]
fn new_vertices_lie_on_the_shape_and_the_measure_has_order_two() {
    let refined = |k: usize| Hierarchy::refine(&disc(), k).unwrap();
    let measures = [2, 3].map(|k| PI - volume(refined(k).finest()));
    assert!((order(&measures) - 2.0).abs() < 0.05, "{measures:?}");
    assert!(off_sphere(refined(3).finest()) < 1e-15);
    let refined = |k: usize| Hierarchy::refine(&ball(), k).unwrap();
    let measures = [3, 4].map(|k| 4.0 / 3.0 * PI - volume(refined(k).finest()));
    assert!((order(&measures) - 2.0).abs() < 0.1, "{measures:?}");
    assert!(off_sphere(refined(4).finest()) < 1e-15);
}

/// Cells of a bisected mesh follow the shape too, also those with an edge alone on the boundary.
#[test]
fn bisection_follows_the_shape() {
    fn on<const D: usize>(mesh: Mesh<D>, steps: usize) -> Mesh<D> {
        let mut refined = BisectedMesh::new(mesh);
        for _ in 0..steps {
            let mesh = refined.mesh();
            let near = |&c: &usize| mesh.barycentre(c)[0] > 0.3;
            let marked: Vec<usize> = (0..mesh.n_cells()).filter(near).collect();
            let (next, bisection) = refined.bisect(&marked).unwrap();
            assert_eq!(bisection.parents.len(), next.mesh().vertices().len());
            refined = next;
            assert!(off_sphere(refined.mesh()) < 1e-15);
        }
        refined.into_mesh()
    }
    let plane = on(disc(), 6);
    assert!(PI - volume(&plane) < 0.6 * (PI - volume(&disc())));
    let space = on(ball(), 9);
    // vertices keep their distances from others: no cell is flat
    for cell in 0..space.n_cells() {
        let volume = space.geometry(cell).volume;
        assert!(volume > 1e-3 * space.cell_diameter(cell).powi(3), "cell {cell}: {volume}");
    }
}

/// Adaptive refinement on the disc reaches a smaller error of the energy than the polygon of the first mesh has.
#[test]
fn adaptive_meshes_follow_the_shape() {
    let problem = paraboloid(&["rim"]);
    let meshes = AdaptiveMeshes::new(problem.bind_boundary(disc()).unwrap());
    let steps = adapt(&problem, &meshes, &ConformingP1, Adaptivity::default().steps(6)).unwrap();
    let energies = steps.map(|step| step.unwrap().solved.energy().unwrap().unwrap() + PI);
    let energies: Vec<f64> = energies.collect();
    assert!(off_sphere(meshes.finest()) < 1e-15);
    assert!(energies.iter().all(|e| *e > 0.0), "{energies:?}");
    assert!(energies[energies.len() - 1] < 0.1 * energies[0], "{energies:?}");
}

/// A part that is refined by itself is the part of the refined mesh: in space too, where an edge of a cell may lie on
/// the boundary and its facets belong to cells that the part does not have.
#[test]
fn a_refined_part_follows_the_shape_as_the_whole() {
    fn on<const D: usize>(mesh: &Mesh<D>, parts: usize, layers: Layers) {
        let mut whole = mesh.clone();
        let mut owners = whole.partition(parts).unwrap();
        let part = |number| whole.part(&owners, number, layers).unwrap();
        let mut pieces: Vec<Part<D>> = (0..parts as u32).map(part).collect();
        for _ in 0..2 {
            whole = whole.refine().unwrap().0;
            owners = owners.iter().flat_map(|&owner| vec![owner; 1 << D]).collect();
            let fine = pieces.iter().map(|part| part.refine(layers).unwrap().0);
            pieces = fine.collect();
            let extents = pieces.iter().map(|part| Extent::of(&part.mesh));
            let extent = extents.reduce(Extent::merge).unwrap();
            pieces = pieces.into_iter().map(|part| part.with_extent(extent)).collect();
            for part in &pieces {
                let of_whole = whole.part(&owners, part.number, layers).unwrap();
                assert_eq!(part.mesh.vertices(), of_whole.mesh.vertices());
                assert_eq!(part.mesh.cells(), of_whole.mesh.cells());
                assert_eq!(part.mesh.boundary(), of_whole.mesh.boundary());
                assert_eq!(part.mesh.domain_diameter(), of_whole.mesh.domain_diameter());
            }
        }
    }
    let fine_ball = ball().refine().unwrap().0;
    for layers in [Layers::across_facets(1), Layers::across_vertices(1), Layers::across_facets(2)] {
        on(&disc(), 4, layers);
        on(&fine_ball, 7, layers);
        on(&fine_ball, 20, layers);
    }
}

/// On an edge between two groups a new vertex lies on both shapes.
#[test]
fn two_shapes_meet_in_their_common_curve() {
    // a quarter of the ball below a plane, whose edge is an arc of a smaller circle
    let height = |x: &Point<3>| 0.5 * (x[2] - 0.2 * x[0] * x[0] - 0.2 * x[1] * x[1]);
    let sphere = |x: &Point<3>| x.norm_squared() - 1.0;
    let mut vertices: Vec<Point<3>> =
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]
            .map(|[x, y]| {
                let r: f64 = x * x + y * y;
                // where a paraboloid meets the sphere
                let top = if r > 0.0 { (1.16_f64.sqrt() - 1.0) / 0.4 } else { 0.0 };
                let radius = (1.0 - top * top).sqrt();
                Point::<3>::new(x * radius, y * radius, top)
            })
            .to_vec();
    vertices.push(Point::<3>::new(0.0, 0.0, -1.0));
    let corners = [[1, 2], [2, 3], [3, 4], [4, 1]];
    let cells = corners.iter().flat_map(|&[a, b]| [0, a, b, 5]).collect();
    let facets = corners.iter().flat_map(|&[a, b]| {
        [[0, a, b], [a, b, 5]]
            .map(|v: [u32; 3]| GroupedFacet { vertices: v, group: u16::from(v[2] == 5) })
    });
    let names = ["lid", "bowl"].map(str::to_owned);
    let mesh = Mesh::with_groups(vertices, cells, &facets.collect::<Vec<_>>(), &names).unwrap();
    let mesh = mesh.with_shape("lid", height).unwrap().with_shape("bowl", sphere).unwrap();
    let meshes = Hierarchy::refine(&mesh, 3).unwrap();
    let mesh = meshes.finest();
    let mut on_both = vec![0; mesh.vertices().len()];
    for facet in mesh.boundary() {
        let is_lid = mesh.boundary_groups()[usize::from(facet.group)].names[0] == "lid";
        for v in mesh.facet_vertices(facet.cell as usize, facet.local as usize) {
            let x = &mesh.vertices()[v as usize];
            let value = if is_lid { height(x) } else { sphere(x) };
            assert!(value.abs() < 1e-14, "{x} {value}");
            on_both[v as usize] |= if is_lid { 1 } else { 2 };
        }
    }
    assert_eq!(on_both.iter().filter(|&&on| on == 3).count(), 32);
}

fn message<V>(found: Result<V, MeshError>) -> String {
    let Err(error) = found else { panic!("no error") };
    assert_eq!(error.kind, MeshErrorKind::Shape, "{error}");
    error.to_string()
}

#[test]
fn shapes_that_do_not_fit_are_refused_with_the_place() {
    let plane = || disc();
    let said = message(plane().with_shape("rim", |x| x.norm_squared() - 1.1));
    let start = "the shape of boundary group rim: it must be zero at the vertices of the group, but \
        its zero is 4.9e-2 from vertex 0 at (-0.831470, -0.555570)";
    assert_eq!(said, start);
    let said = message(plane().with_shape("rim", |_| 1.0));
    assert!(said.ends_with("its zero is not near vertex 0 at (-0.831470, -0.555570)"), "{said}");
    let said = message(plane().with_shape("rom", |_| 1.0));
    assert_eq!(said, "the shape of boundary group rom: the mesh has no such group");
    let owners = plane().partition(2).unwrap();
    let part = plane().part(&owners, 0, Layers::across_facets(1)).unwrap().mesh;
    assert!(message(part.with_shape("rim", |_| 0.0)).contains("give it to the whole mesh"));
    let line = Mesh::<1>::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), [2]);
    let said = message(line.unwrap().with_shape("left", |x| x[0]));
    assert!(said.contains("in one dimension"), "{said}");
    // zero at the vertices alone
    let at_vertices: Vec<Point<2>> = plane().vertices().to_vec();
    let holes = move |x: &Point<2>| {
        let nearest = at_vertices.iter().map(|v| (x - v).norm()).fold(f64::INFINITY, f64::min);
        if nearest < 1e-3 { x.norm_squared() - 1.0 } else { 1.0 }
    };
    let holes = plane().with_shape("rim", holes).unwrap();
    let said = message(holes.refine());
    assert!(said.contains("has no zero within") && said.contains(" of ("), "{said}");
    let all: Vec<usize> = (0..holes.n_cells()).collect();
    let again = message(BisectedMesh::new(holes).bisect(&all));
    assert!(again.contains("rim has no zero within"), "{again}");
}

/// Two cells with a thin one between them and the arc of a deep notch.
#[test]
fn a_cell_that_turns_over_is_named() {
    let vertices = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.1]].map(Point::<2>::from);
    let facets = [[0, 1], [1, 2], [0, 2]];
    let facets =
        facets.map(|vertices| GroupedFacet { vertices, group: u16::from(vertices != [0, 1]) });
    let names = ["notch", "rest"].map(str::to_owned);
    let mesh = Mesh::with_groups(vertices.to_vec(), vec![0, 1, 2], &facets, &names).unwrap();
    let notch = mesh.with_shape("notch", |x| x[1] - 1.6 * x[0] * (1.0 - x[0])).unwrap();
    for said in [message(notch.refine()), message(BisectedMesh::new(notch).bisect(&[0]))] {
        assert!(said.starts_with("a cell within cell 0 turns over at ("), "{said}");
        assert!(said.contains("make smaller cells there"), "{said}");
    }
}

/// A function on the coarse mesh is none of the finite element space on its refinement; it is continued.
#[test]
fn discrete_functions_are_continued_to_the_shape() {
    let problem = paraboloid(&["rim"]);
    let coarse = problem.bind_boundary(disc()).unwrap();
    let u = solve(&problem, &coarse, &ConformingP1).unwrap().function().unwrap();
    let fine = coarse.refine().unwrap().0;
    let next = Problem::new().reaction(1.0).source_in("default", u).dirichlet_on("rim", 0.0);
    let unproven = |mesh: &Mesh<2>| {
        let solved = solve(&next, mesh, &Sipg::default()).unwrap();
        assert!(solved.converged());
        solved.bound().unwrap().unproven
    };
    assert_eq!(unproven(&coarse), [Unproven::Shape]);
    assert_eq!(unproven(&fine), [Unproven::Quadrature, Unproven::Shape]);
}

/// The start from coarser meshes, by algebraic prolongation, changes no solution, and contact on the disc is that of the
/// catalogue.
#[test]
fn a_membrane_over_a_ball_touches_it_in_the_same_disc_from_any_start() {
    let catalogue = scenes::disc_2d();
    let mut problem = catalogue.problem;
    problem.dirichlet = Default::default();
    let problem = problem.dirichlet_on("rim", 0.0);
    let meshes = Hierarchy::refine(&problem.bind_boundary(disc()).unwrap(), 2).unwrap();
    for scheme in ["p1", "sipg"] {
        let scheme = scheme.parse::<NamedScheme>().unwrap().make();
        let nested = solve(&problem, &meshes, &*scheme).unwrap();
        let flat = solve(&problem, meshes.finest(), &*scheme).unwrap();
        assert!(nested.converged() && flat.converged() && nested.active() > Some(0));
        assert_eq!(nested.active(), flat.active());
        let difference = nested.values().iter().zip(flat.values()).map(|(a, b)| (a - b).abs());
        assert!(difference.fold(0.0, f64::max) < 1e-8);
        let [fine, coarse] = [&nested, &solve(&problem, meshes.mesh(1), &*scheme).unwrap()]
            .map(|solved| solved.errors().unwrap().l2.unwrap());
        assert!(coarse / fine > 3.0, "{coarse} {fine}");
    }
}
