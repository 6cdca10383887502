//! Quadratic elements and their three sets of constraints.

mod bernstein;
mod bernstein_jumps;
mod sets;

use crate::runs::{own_scene, small_mesh, solve};
use crate::support::checks::Checks;
use crate::support::meshes::{Random, Raw, mixed_box};
use crate::support::rows::{label, rows, rows_in};
use crate::support::scheme_lists::entry;
use crate::support::schemes::Entry;
use unilateral::algebra::{Contact, Start};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{BoundaryCondition, Edges, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::scheme::{SchemeOptions, scheme_by_name};

/// Symmetric interior penalty on broken quadratics.
fn broken<const D: usize>() -> OnElement<Sipg, D> {
    Sipg::default().on(P2)
}

/// Conforming quadratics with bounds at all nodes, at midpoints, and on Bernstein coefficients.
fn conforming<const D: usize>() -> Vec<Entry<D>> {
    vec![entry(ConformingP2, Nodes), entry(ConformingP2, Midpoints), entry(ConformingP2, Bernstein)]
}

/// Conforming and discontinuous quadratics with every set of constraints.
fn all<const D: usize>() -> Vec<Entry<D>> {
    let mut schemes = conforming();
    schemes.push(entry(broken(), Nodes));
    schemes.push(entry(broken(), Midpoints));
    schemes.push(entry(broken(), Bernstein));
    schemes
}

/// The H1 error of a scheme on conforming quadratics by a rule of degree nine, from the contact set
/// of conforming linear elements.
fn h1_as_tables(scene: &Scene<2>, set: impl ConstraintSet + 'static, level: usize) -> f64 {
    let (solver, quadrature) = (ActiveSet::default(), DataQuadrature::default());
    let meshes = Hierarchy::of_domain(&scene.domain, level).unwrap();
    let linear = NestedIteration::new(&scene.problem, &meshes).solve(&ConformingP1).unwrap();
    let start = &linear.solution().contact;
    let mesh = meshes.finest();
    let problem = scene.problem.clone().on(set);
    let space = Discretisation::new(&ConformingP2, &problem, mesh, quadrature).unwrap();
    let mut inequality = space.inequality().unwrap();
    let in_contact = |&v: &u32| start[v as usize] == Contact::Lower;
    let states = inequality.locations.iter().map(|place| {
        if place.vertices().iter().all(in_contact) { Contact::Lower } else { Contact::Inactive }
    });
    inequality.start = Start::Contact(states.collect());
    let solution = solver.solve(&inequality);
    assert_eq!(solution.outcome, Outcome::Converged);
    let exact = scene.problem.exact.as_ref().unwrap();
    let (_, edges) = Edges::with_cell_edges(mesh);
    let n = mesh.vertices().len();
    let rule = Rule::new(2, 9);
    let mut sum = 0.0;
    for (cell, edges) in edges.chunks(3).enumerate() {
        let geometry = mesh.geometry(cell);
        let vertices = mesh.cell(cell).iter().map(|&v| v as usize);
        let unknowns = vertices.chain(edges.iter().map(|&e| n + e as usize));
        let values: Vec<f64> = unknowns.map(|k| solution.values[k]).collect();
        for (point, weight) in rule.iter() {
            // the side that the rule collapses lies at the first vertex
            let point = [point[2], point[1], point[0]];
            let mut slopes = [[0.0; 4]; 10];
            Element::<2>::derivatives(&P2, &point, &mut slopes);
            let mut error = -(exact.gradient)(&mesh.point(cell, &point));
            for k in 0..3 {
                let slope: f64 = values.iter().zip(&slopes).map(|(u, s)| u * s[k]).sum();
                error += geometry.gradient(k) * slope;
            }
            sum += weight * geometry.volume * error.norm_squared();
        }
    }
    sum.sqrt()
}

/// Figures of an independent implementation on the same meshes. They are those of its rule of degree
/// nine, which the free boundary makes inexact: by 7e-3 on the coarsest mesh, by 1e-3 on the finest.
#[test]
fn the_obstacle_in_the_plane_as_an_independent_implementation_has_it() {
    let levels = [8, 16, 32, 64, 128];
    let nodes = ["7.5700e-2", "2.3669e-2", "9.0958e-3", "3.0781e-3", "1.1395e-3"];
    let midpoints = ["8.0838e-2", "2.5998e-2", "9.6236e-3", "3.2994e-3", "1.2116e-3"];
    let mut checks = Checks::default();
    let scene = scenes::radial::<2>(1.0);
    let mut compare = |name: &str, printed: [&str; 5], errors: [f64; 5]| {
        for ((level, printed), &ours) in levels.iter().zip(printed).zip(&errors) {
            checks.printed(&format!("{name}, n = {level}"), ours, printed, 0.5);
        }
        // measured: 1.434 and 1.445
        let order = (errors[3] / errors[4]).log2();
        checks.that((1.4..1.6).contains(&order), || format!("{name}: order {order}"));
    };
    compare("nodes", nodes, levels.map(|n| h1_as_tables(&scene, Nodes, n)));
    compare("midpoints", midpoints, levels.map(|n| h1_as_tables(&scene, Midpoints, n)));
    checks.finish();
}

/// Checks the order in H1 between the two finest of these levels.
fn order_in_h1<const D: usize>(
    checks: &mut Checks,
    scene: Scene<D>,
    schemes: Vec<Entry<D>>,
    levels: &[usize],
    [low, high]: [f64; 2],
) {
    for row in rows::<D>(scene, schemes, levels.to_vec()) {
        checks.certified(&row, 1e-9);
        if Some(&row.level) == levels.last() {
            let order = row.order.h1.unwrap();
            checks.that((low..high).contains(&order), || format!("{}: {order:.3}", label(&row)));
            let promised = row.expected_order.h1.unwrap_or(order);
            checks.that(order > promised - 0.1, || format!("{}: not {promised}", label(&row)));
        }
    }
}

#[test]
fn orders_under_inequalities() {
    let mut checks = Checks::default();
    let c = &mut checks;
    let (coefficients, others) =
        all().into_iter().partition(|scheme: &Entry<2>| scheme.constraint() == "bernstein");
    // measured: 1.565, 1.546, 1.563, 1.541, 1.558
    order_in_h1(c, scenes::radial::<2>(1.0), others, &[32, 64], [1.4, 1.6]);
    // measured: 1.6, 1.615
    order_in_h1(c, scenes::radial::<2>(1.0), coefficients, &[32, 64], [1.5, 1.7]);
    // measured: 1.388, 1.372
    let coefficients = vec![entry(ConformingP2, Bernstein), entry(broken(), Bernstein)];
    order_in_h1(c, scenes::radial::<3>(1.0), coefficients, &[4, 8], [1.3, 1.5]);
    // measured: 1.497, twice, and 1.498; the solution is in no space that would allow more
    let mut schemes = conforming();
    schemes.push(entry(broken(), Nodes));
    order_in_h1(c, scenes::signorini_harmonic::<2>(), schemes, &[32, 64], [1.45, 1.55]);
    // measured: 1.479, twice
    order_in_h1(c, scenes::signorini_harmonic::<3>(), conforming(), &[4, 8], [1.4, 1.6]);
    // measured: 1.000, because nothing binds the ends of a cell
    let midpoints = vec![entry::<1>(ConformingP2, Midpoints)];
    order_in_h1(c, scenes::radial::<1>(1.0), midpoints, &[512, 1024], [0.95, 1.05]);
    checks.finish();
}

/// Coefficient 3, reaction `1 + x`, Dirichlet data at the lower end of the first axis, Neumann data
/// elsewhere; the solution is the exponential of the mean of `2x - x_0`.
fn smooth<const D: usize>() -> Scene<D> {
    let slope = |k: usize| if k == 0 { 1.0 } else { 2.0 } / D as f64;
    let value = move |x: &Point<D>| (0..D).map(|k| slope(k) * x[k]).sum::<f64>().exp();
    let gradient = move |x: &Point<D>| Point::from_fn(|k, _| slope(k)) * value(x);
    let squares: f64 = (0..D).map(|k| slope(k) * slope(k)).sum();
    let load = move |x: &Point<D>| (1.0 + x[0] - 3.0 * squares) * value(x);
    let problem = Problem::new()
        .source(load)
        .coefficient(|_| 3.0)
        .reaction(|x: &Point<D>| 1.0 + x[0])
        .exact(value, gradient);
    let mut domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    domain.sides = [[BoundaryCondition::Neumann; 2]; D];
    own_scene("smooth", domain.side(0, 0, BoundaryCondition::Dirichlet), problem)
}

/// Orders two and three where no inequality binds. Those with continuous functions are one space, and so are the
/// others; the basis or the constraint set is another, not the solution.
#[test]
fn smooth_solutions() {
    fn check<const D: usize>(checks: &mut Checks, levels: [usize; 2]) {
        for row in rows::<D>(smooth(), all(), levels) {
            checks.certified(&row, 1e-9);
            let (Some(h1), Some(l2)) = (row.order.h1, row.order.l2) else { continue };
            let holds = (1.9..2.1).contains(&h1) && (2.85..3.15).contains(&l2);
            checks.that(holds, || format!("{}: H1 {h1:.3}, L2 {l2:.3}", label(&row)));
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, [16, 32]);
    check::<2>(&mut checks, [8, 16]);
    check::<3>(&mut checks, [4, 8]);
    checks.finish();
}

fn quadratic<const D: usize>(x: &Point<D>) -> f64 {
    x.norm_squared() + (0..D).map(|k| x[k] * x[(k + 1) % D] - (k as f64) * x[k]).sum::<f64>()
}

fn slope_of_quadratic<const D: usize>(x: &Point<D>) -> Point<D> {
    Point::from_fn(|k, _| 2.0 * x[k] + x[(k + 1) % D] + x[(k + D - 1) % D] - k as f64)
}

/// The mesh with Dirichlet data in place of contact.
fn without_contact<const D: usize>(mesh: Mesh<D>) -> Mesh<D> {
    let boundary = mesh.boundary().iter().map(|f| {
        let mut vertices = mesh.facet_vertices(f.cell as usize, f.local as usize);
        let vertices = std::array::from_fn(|_| vertices.next().unwrap());
        let contact = f.condition == BoundaryCondition::Contact;
        TaggedFacet {
            vertices,
            condition: if contact { BoundaryCondition::Dirichlet } else { f.condition },
        }
    });
    let boundary: Vec<_> = boundary.collect();
    Mesh::new(mesh.vertices().to_vec(), mesh.cells().to_vec(), &boundary).unwrap()
}

/// Quadratics are reproduced, also in contact with themselves and with a reaction, whatever the
/// shape, the numbers and the order of vertices of the cells.
#[test]
fn quadratics_are_reproduced() {
    fn check<const D: usize>(checks: &mut Checks, mesh: &Mesh<D>) {
        let pull = if D == 1 { 4.0 } else { 2.0 * D as f64 };
        let exact = || Problem::new().exact(quadratic, slope_of_quadratic);
        let problems = [
            exact().constant_source(-pull),
            exact().reaction(2.0).source(move |x| 2.0 * quadratic(x) - pull),
            exact().constant_source(-pull - 1.0).obstacle_below(quadratic),
            exact().constant_source(-pull).obstacle_above(|x| quadratic(x) + 1.0),
        ];
        for (k, problem) in problems.iter().enumerate() {
            for scheme in all::<D>() {
                let solved = solve(&*scheme, &scheme.constrain(problem), mesh);
                let what = format!("{D}d, problem {k}, {} {}", scheme.name(), scheme.constraint());
                // full contact under a load that is one too large is reproduced if the mean of a
                // node's function, which is the force on it, vanishes where the node is open and
                // presses where it is bound
                let bends = k == 2
                    && match &scheme.constraint()[..] {
                        "nodes" => D == 3,
                        "midpoints" => D != 2,
                        _ => false,
                    };
                let error = solved.error.h1.unwrap();
                checks.that(solved.outcome == Outcome::Converged, || what.clone());
                checks.that((error < 1e-9) != bends, || format!("{what}: H1 {error:e}"));
            }
        }
    }
    fn shuffled<const D: usize>(n: usize) -> Mesh<D> {
        let raw = Raw::<D>::jittered(&mixed_box(), n, 0.4, &mut Random(7));
        without_contact(raw.shuffled(&mut Random(8)).mesh())
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, &shuffled(7));
    check::<2>(&mut checks, &shuffled(4));
    check::<3>(&mut checks, &shuffled(3));
    check::<1>(&mut checks, &without_contact(small_mesh("interval.msh")));
    check::<2>(&mut checks, &without_contact(small_mesh("plate.msh")));
    check::<3>(&mut checks, &without_contact(small_mesh("cube.msh")));
    checks.finish();
}

/// The same inequality on a mesh whose vertices and cells are numbered and listed otherwise has the
/// same solution, unknown by unknown.
#[test]
fn numbering_does_not_matter() {
    let raw = Raw::<2>::jittered(&mixed_box(), 6, 0.4, &mut Random(3));
    let (mesh, shuffled) = (raw.mesh(), raw.shuffled(&mut Random(4)).mesh());
    let problem = Problem::new()
        .constant_source(-4.0)
        .dirichlet(|x| 0.1 * x[0])
        .obstacle_below(|x| -0.05 - 0.1 * x[1])
        .signorini(|x| 0.02 * x[0] - 0.03);
    for scheme in all::<2>() {
        let [first, second] = [&mesh, &shuffled].map(|mesh| {
            let problem = scheme.constrain(&problem);
            let inequality = scheme.inequality(&problem, mesh, Default::default()).unwrap();
            let solution = ActiveSet::default().solve(&inequality);
            assert_eq!(solution.outcome, Outcome::Converged);
            let touching = solution.contact.iter().filter(|&&c| c == Contact::Lower).count();
            // unknowns by the barycentres of their cell and of their place
            let barycentre = |vertices: &[u32]| {
                let sum = vertices.iter().map(|&v| mesh.vertices()[v as usize]).sum::<Point<2>>();
                sum / vertices.len() as f64
            };
            let keys = inequality.locations.iter().zip(&solution.values).map(|(place, &u)| {
                let cell = place.cell().map_or(Point::zeros(), |c| mesh.barycentre(c as usize));
                let key = [cell, barycentre(place.vertices())];
                (key.map(|x| [x[0], x[1]].map(|t| (t * 1e9).round() as i64)), u)
            });
            let mut values: Vec<_> = keys.collect();
            values.sort_by_key(|v| v.0);
            (values, touching)
        });
        assert!(first.1 > 0 && first.1 == second.1, "{} {}", first.1, second.1);
        for (a, b) in first.0.iter().zip(&second.0) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-11, "{a:?} {b:?}");
        }
    }
}

/// The load that presses a flat obstacle everywhere is its multiplier, whatever the set; names are
/// those that reports state.
#[test]
fn multipliers_names_and_single_precision() {
    let names: Vec<_> = all::<2>().iter().map(|s| s.constraint()).collect();
    let of_both = ["nodes", "midpoints", "bernstein"];
    assert_eq!(names[..3], of_both);
    assert_eq!(names[3..], of_both);
    let named = scheme_by_name::<2>("p2", &SchemeOptions::default()).unwrap();
    assert_eq!((named.name(), named.constraint_on(&Nodes)), ("p2", Some("nodes".to_owned())));
    fn check<const D: usize>(checks: &mut Checks, level: usize) {
        let scene = scenes::radial::<D>(1.0);
        let mesh = scene.domain.mesh(level).unwrap();
        for scheme in all::<D>() {
            let solved = solve(&*scheme, &scheme.constrain(&scene.problem), &mesh);
            let multiplier = solved.fields.unwrap().multiplier;
            // cells around the origin have contact around them, and so have the patches of their
            // vertices, over which a density is a mean
            for (cell, found) in multiplier.iter().enumerate() {
                if mesh.barycentre(cell).norm() < 0.2 {
                    let what = format!("{D}d {} {}", scheme.name(), scheme.constraint());
                    // where some unknowns are open, the free boundary is felt through the contact
                    // set; this falls by a factor with each layer of cells
                    let felt = match &scheme.constraint()[..] {
                        "nodes" => 1e-9,
                        "midpoints" => 1e-4,
                        _ => 1e-3,
                    };
                    checks.close(&what, *found, 2.0, felt);
                }
            }
        }
    }
    let mut checks = Checks::default();
    check::<1>(&mut checks, 24);
    check::<2>(&mut checks, 16);
    let single = rows_in::<2>(Precision::Single, scenes::radial(1.0), all(), [16]);
    let double = rows::<2>(scenes::radial(1.0), all(), [16]);
    for (single, double) in single.iter().zip(&double) {
        checks.certified(single, 1e-3);
        let ratio = single.error.h1.unwrap() / double.error.h1.unwrap();
        checks.that((ratio - 1.0).abs() < 1e-3, || format!("{}: {ratio}", label(single)));
    }
    checks.finish();
}
