//! Discrete functions as data: exact loads on nested meshes, values of each cell as obstacles, means at vertices as
//! Dirichlet data, and results that outlive their problem.

use unilateral::algebra::Bound;
use unilateral::assemble::DataQuadrature;
use unilateral::error::Error;
use unilateral::error_bound::Unproven;
use unilateral::mesh::Domain;
use unilateral::nested::KeptSolution;
use unilateral::prelude::*;
use unilateral::problem::Datum;

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    name.parse::<NamedScheme>().unwrap().make()
}

fn cube<const D: usize>(n: usize) -> Mesh<D> {
    let cube = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&cube, [n; D]).unwrap()
}

/// Numbers between minus one and one, without a pattern.
fn numbers(n: usize) -> Vec<f64> {
    (0..n).map(|k| (1.7 * k as f64 + 0.3).sin()).collect()
}

/// A function of a scheme with these unknowns.
fn function<const D: usize>(name: &str, mesh: &Mesh<D>, u: &[f64]) -> DiscreteFunction<D> {
    let problem = Problem::new();
    let of = Discretisation::new(&*scheme(name), &problem, mesh, Default::default()).unwrap();
    of.function(u)
}

fn unknowns<const D: usize>(name: &str, mesh: &Mesh<D>) -> usize {
    let problem = Problem::new();
    Discretisation::new(&*scheme(name), &problem, mesh, Default::default()).unwrap().unknowns()
}

/// The largest difference of the load with a function as source from the mass matrix times the function's interpolant,
/// over the largest entry.
fn difference_from_mass<const D: usize>(
    name: &str,
    u: &DiscreteFunction<D>,
    mesh: &Mesh<D>,
    quadrature: DataQuadrature,
) -> f64 {
    let scheme = scheme::<D>(name);
    let discretise = |problem| Discretisation::new(&*scheme, problem, mesh, quadrature).unwrap();
    let problem = Problem::new().source_in("default", u.clone());
    let of = discretise(&problem);
    let (datum, element) = (Datum::from(u.clone()), scheme.element());
    let mut interpolant = vec![0.0; of.unknowns()];
    for cell in 0..mesh.n_cells() {
        for (i, unknown) in of.unknowns_of(cell).enumerate() {
            let x = mesh.point(cell, &element.node(i).centre(D)[..=D]);
            interpolant[unknown] = datum.in_cell(mesh, cell, &x);
        }
    }
    let with_reaction = Problem::new().reaction(1.0);
    let [form, both] = [&problem, &with_reaction].map(|problem| discretise(problem).matrix());
    let load = of.load().unwrap();
    let products = (0..load.len())
        .map(|i| both.row_dot(i, &interpolant) - form.row_dot(i, &interpolant))
        .collect::<Vec<f64>>();
    let largest = products.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let differences = load.iter().zip(&products).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / largest
}

fn loads_are_exact<const D: usize>(n: usize) {
    let mesh = cube::<D>(n);
    let fine = mesh.refine().unwrap().0;
    let finest = fine.refine().unwrap().0;
    for name in ["p1", "p2", "cr", "sipg", "sipg-p2"] {
        let u = function(name, &mesh, &numbers(unknowns(name, &mesh)));
        for (refinements, mesh) in [&mesh, &fine, &finest].into_iter().enumerate() {
            // a coarse function of Crouzeix and Raviart jumps on fine facets
            if name == "cr" && refinements > 0 {
                continue;
            }
            // a rule of low degree is replaced
            for quadrature in [DataQuadrature::default(), DataQuadrature::default().cell(1)] {
                let difference = difference_from_mass(name, &u, mesh, quadrature);
                assert!(difference < 1e-10, "{name}, {D}, {refinements}: {difference:e}");
            }
        }
    }
}

#[test]
fn loads_of_discrete_functions_are_exact_on_nested_meshes() {
    loads_are_exact::<1>(5);
    loads_are_exact::<2>(2);
    loads_are_exact::<3>(1);
}

/// In a cell of a refinement a function with jumps has the values of its ancestor, at its vertices too.
#[test]
fn values_in_cells_are_those_of_the_ancestor() {
    let coarse = cube::<2>(2);
    let fine = coarse.refine().unwrap().0.refine().unwrap().0;
    let values = numbers(3 * coarse.n_cells());
    let datum = Datum::from(function("sipg", &coarse, &values));
    for cell in 0..fine.n_cells() {
        let ancestor = cell >> 4;
        for &v in fine.cell(cell) {
            let x = fine.vertices()[v as usize];
            let corner = coarse.vertices()[coarse.cell(ancestor)[0] as usize];
            let geometry = coarse.geometry(ancestor);
            let own = &values[3 * ancestor..][..3];
            let slopes = (0..3).map(|k| own[k] * geometry.gradient(k).dot(&(x - corner)));
            let expected = own[0] + slopes.sum::<f64>();
            assert!((datum.in_cell(&fine, cell, &x) - expected).abs() < 1e-13);
        }
    }
}

/// Cells of another mesh are searched for: a linear function is right there, and the bound says that its load is
/// integrated by a rule. On the own mesh and on refinements the bound is guaranteed.
#[test]
fn functions_on_other_meshes_are_integrated_by_the_rule() {
    let mesh = cube::<2>(5);
    let linear = |x: &Point<2>| 1.0 + 2.0 * x[0] - x[1];
    let u = function("p1", &mesh, &mesh.vertices().iter().map(linear).collect::<Vec<_>>());
    let other = cube::<2>(7);
    assert!(difference_from_mass("p1", &u, &other, DataQuadrature::default()) < 1e-12);
    assert_eq!(u.times(2.0).value_at(&Point::from([0.3, 0.4])).map(|v| v.round()), Some(2.0));

    let problem = Problem::new().source_in("default", u);
    let unproven = |mesh| solve(&problem, mesh, &ConformingP1).unwrap().bound().unwrap().unproven;
    let fine = mesh.refine().unwrap().0;
    assert_eq!([unproven(&mesh), unproven(&fine)], [[], []]);
    assert_eq!(unproven(&other), [Unproven::Quadrature]);
}

/// On a mesh with a multiple of the cells that is no refinement a function with kinks, or with jumps, is no polynomial in
/// each cell: the load is integrated by a rule, and the bound says so.
#[test]
fn functions_on_meshes_with_a_multiple_of_the_cells_are_no_polynomials() {
    let mesh = cube::<2>(2);
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let inner = BoxDomain::dirichlet(Point::zeros(), Point::repeat(0.9));
    let others = [(square, [4, 2]), (inner.clone(), [2, 2]), (inner, [4, 4])];
    for name in ["p1", "sipg"] {
        let u = function(name, &mesh, &numbers(unknowns(name, &mesh)));
        let problem = Problem::new().source_in("default", u);
        let fine = mesh.refine().unwrap().0;
        let found = |mesh: &Mesh<2>, quadrature: DataQuadrature| {
            let mut nested = NestedIteration::new(&problem, mesh).quadrature(quadrature);
            let solved = nested.solve(&ConformingP1).unwrap();
            (solved.bound().unwrap().unproven, solved.energy().unwrap().unwrap())
        };
        let rules = [4, 14].map(|degree| DataQuadrature::default().cell(degree));
        // the energy depends on the rule where the function is no polynomial
        let figures = |mesh: &Mesh<2>| {
            let [(unproven, coarse), (_, fine)] = rules.map(|rule| found(mesh, rule));
            (unproven, (coarse / fine - 1.0).abs())
        };
        for own in [&mesh, &fine] {
            let (unproven, difference) = figures(own);
            assert!(unproven.is_empty() && difference < 1e-12, "{name}: {difference:e}");
        }
        for (domain, counts) in &others {
            let other = Mesh::kuhn_box(domain, *counts).unwrap();
            assert!(other.n_cells().is_multiple_of(mesh.n_cells()));
            let (unproven, difference) = figures(&other);
            assert_eq!(unproven, [Unproven::Quadrature], "{name} {counts:?}");
            assert!(difference > 1e-6, "{name} {counts:?}: {difference:e}");
        }
    }
}

/// A mesh of a disc lies within the disc: the function on a coarse one is continued to a finer one, but not far.
#[test]
fn functions_are_continued_to_meshes_of_the_same_domain_alone() {
    let disc = scenes::disc_2d().domain;
    assert!(matches!(disc, Domain::Disc { .. }));
    let [coarse, fine] = [4, 12].map(|level| disc.mesh(level).unwrap());
    let linear = |x: &Point<2>| 3.0 - x[0];
    let u = function("p1", &coarse, &coarse.vertices().iter().map(linear).collect::<Vec<_>>());
    for x in fine.vertices() {
        assert!((u.value_at(x).unwrap() - linear(x)).abs() < 1e-12, "{x}");
    }
    let problem = Problem::new().source_in("default", u);
    let wide = BoxDomain::dirichlet(Point::repeat(-9.0), Point::repeat(9.0));
    let mesh = Mesh::kuhn_box(&wide, [4; 2]).unwrap();
    let error = solve(&problem, &mesh, &ConformingP1).unwrap_err();
    assert!(matches!(error, Error::DataNotFinite(_)), "{error}");
    assert!(error.to_string().starts_with("source is "), "{error}");
}

/// The values of a broken linear function at a vertex, from all cells around.
fn values_at(mesh: &Mesh<2>, values: &[f64], v: usize) -> Vec<f64> {
    let corners = mesh.cells().iter().zip(values);
    corners.filter(|(at, _)| **at as usize == v).map(|(_, value)| *value).collect()
}

#[test]
fn obstacles_with_jumps_bound_each_cell_by_its_own_values() {
    let sides = [[BoundaryCondition::Neumann; 2]; 2];
    let square = BoxDomain::new(Point::zeros(), Point::repeat(1.0), sides);
    let mesh = Mesh::<2>::kuhn_box(&square, [3; 2]).unwrap();
    let values = numbers(3 * mesh.n_cells());
    let psi = function("sipg", &mesh, &values);
    let above = psi.clone();
    let lower = Problem::new().obstacle_below_in("default", psi);
    let upper = Problem::new().obstacle_above_in("default", above);
    let bounds = |problem: &Problem<2>, name: &str| {
        let of = Discretisation::new(&*scheme(name), problem, &mesh, Default::default());
        of.unwrap().bounds().unwrap()
    };
    for (bound, value) in bounds(&lower, "sipg").iter().zip(&values) {
        assert!((bound.lower().unwrap() - value).abs() < 1e-14, "{bound:?} {value}");
    }
    let [of_lower, of_upper] = [&lower, &upper].map(|problem| bounds(problem, "p1"));
    for v in 0..mesh.vertices().len() {
        let around = values_at(&mesh, &values, v);
        let largest = around.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let smallest = around.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((of_lower[v].lower().unwrap() - largest).abs() < 1e-14);
        assert!((of_upper[v].upper().unwrap() - smallest).abs() < 1e-14);
    }
}

#[test]
fn dirichlet_data_with_jumps_are_means_at_vertices() {
    let mesh = cube::<2>(3);
    let values = numbers(3 * mesh.n_cells());
    let problem = Problem::new().dirichlet_on("default", function("sipg", &mesh, &values));
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default()).unwrap();
    let mut fixed = 0;
    for (v, bound) in of.bounds().unwrap().iter().enumerate() {
        let Bound::Fixed(value) = bound else { continue };
        let around = values_at(&mesh, &values, v);
        let mean = around.iter().sum::<f64>() / around.len() as f64;
        assert!((value - mean).abs() < 1e-14, "{value} {mean}");
        fixed += 1;
    }
    assert_eq!(fixed, 12);
    // no function with finite energy has these data
    let u = solve(&problem, &mesh, &ConformingP1).unwrap();
    assert!(u.bound().unwrap().unproven.contains(&Unproven::Boundary));
}

/// On a finer mesh of a hierarchy an obstacle with jumps keeps to its cells: no cell falls below its own obstacle. The
/// start on coarser meshes reads the function of the finest one.
#[test]
fn data_on_one_mesh_of_a_hierarchy_serve_on_all() {
    let meshes = Hierarchy::refine(&cube::<2>(4), 2).unwrap();
    let (coarse, fine) = (meshes.mesh(0), meshes.finest());
    let steps: Vec<f64> = numbers(coarse.n_cells()).iter().map(|v| 0.05 * v - 0.2).collect();
    let steps: Vec<f64> = steps.iter().flat_map(|v| [*v; 3]).collect();
    let pressed = Problem::new().constant_source(-40.0);
    let source = solve(&pressed, fine, &Sipg::default()).unwrap().function().unwrap();
    let problem = Problem::new()
        .source_in("default", source.times(10.0))
        .obstacle_below_in("default", function("sipg", coarse, &steps));
    for name in ["p1", "sipg"] {
        let nested = solve(&problem, &meshes, &*scheme(name)).unwrap();
        let flat = solve(&problem, fine, &*scheme(name)).unwrap();
        assert!(nested.converged() && nested.active() > Some(20), "{name}: {nested:?}");
        assert!(nested.penetration().unwrap().unwrap().largest() <= 1e-12, "{name}");
        let differences = nested.values().iter().zip(flat.values()).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-9, "{name}");
    }
}

/// The solution of one solve is zero but for rounding where it is the obstacle of the next, whose Dirichlet value is
/// zero; beside the load it counts as zero. Above rounding it is a contradiction.
#[test]
fn an_obstacle_that_is_zero_but_for_rounding_meets_zero() {
    let mesh = cube::<2>(3);
    for name in ["p1", "p2"] {
        let small = |size: f64| -> Vec<f64> {
            numbers(unknowns(name, &mesh)).iter().map(|v| size * v).collect()
        };
        let problem = |size| {
            let obstacle = function(name, &mesh, &small(size));
            Problem::new().constant_source(-1.0).obstacle_below_in("default", obstacle)
        };
        let rounding = problem(1e-16);
        let solved = solve(&rounding, &mesh, &*scheme(name)).unwrap();
        assert!(solved.converged(), "{name}: {}", solved.outcome());
        let refused = solve(&problem(1e-10), &mesh, &*scheme(name)).unwrap_err();
        assert!(matches!(refused, Error::EmptyConstraint { .. }), "{name}: {refused}");
    }
}

/// A membrane on an obstacle, under this load.
fn membrane(load: f64) -> Problem<2> {
    Problem::new().constant_source(load).obstacle_below(|_| -0.02)
}

/// The result on a mesh and of a problem that end here.
fn kept(name: &str) -> KeptSolution<2> {
    let (mesh, problem) = (cube::<2>(24), membrane(-4.0));
    solve(&problem, &mesh, &*scheme(name)).unwrap().keep().unwrap()
}

#[test]
fn results_are_kept_and_the_next_solve_starts_from_their_contact() {
    fn is_owned<T: Send + Sync + Clone + 'static>(_: &T) {}
    for name in ["p1", "sipg", "wopsip"] {
        let last = kept(name);
        is_owned(&last);
        let (mesh, problem) = (cube::<2>(24), membrane(-4.05));
        let scheme = scheme(name);
        let cold = NestedIteration::new(&problem, &mesh).cold_start(true).solve(&*scheme).unwrap();
        let mut next = NestedIteration::new(&problem, &mesh).start_from(&last.solution);
        let warm = next.solve(&*scheme).unwrap();
        assert!(warm.converged() && cold.converged());
        assert!(warm.outer() < cold.outer(), "{name}: {:?} {:?}", warm.outer(), cold.outer());
        let differences = warm.values().iter().zip(cold.values()).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-9, "{name}");
        // from the solution of the same problem one system is enough
        let same = membrane(-4.0);
        let mut again = NestedIteration::new(&same, &mesh).start_from(&last.solution);
        assert_eq!(again.solve(&*scheme).unwrap().outer(), Some(1), "{name}");
        let lowest = last.function.value_at(&Point::repeat(0.5)).unwrap();
        assert!((lowest + 0.02).abs() < 1e-15, "{name}: {lowest}");
    }
}

/// The time steps of docs/own_problems.md: the load acts beside that of the last step, so that the solution of the
/// problem without time is their end.
#[test]
fn implicit_steps_keep_the_load() {
    let (mesh, dt) = (cube::<2>(6), 0.1);
    let first = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.2);
    let end = solve(&first, &mesh, &Sipg::default()).unwrap();
    assert!(end.active() > Some(0));
    let mut last =
        solve(&first.clone().constant_source(7.0), &mesh, &Sipg::default()).unwrap().keep();
    for _ in 0..40 {
        let old = last.unwrap();
        let step = Problem::new()
            .reaction(1.0 / dt)
            .constant_source(-8.0)
            .source_in("default", old.function.times(1.0 / dt))
            .obstacle_below(|_| -0.2);
        let mut step = NestedIteration::new(&step, &mesh).start_from(&old.solution);
        last = step.solve(&Sipg::default()).unwrap().keep();
    }
    let last = last.unwrap().function;
    // inside cells: at vertices the function has jumps
    for x in (0..mesh.n_cells()).map(|cell| mesh.barycentre(cell)) {
        let [found, expected] = [last.value_at(&x), end.value_at(&x)].map(Option::unwrap);
        assert!((found - expected).abs() < 1e-8, "{x}: {found} {expected}");
    }
}
