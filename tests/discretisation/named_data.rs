//! Data by the names of regions and boundary groups.

use unilateral::algebra::Bound;
use unilateral::error::Error;
use unilateral::error_bound::Unproven;
use unilateral::mesh::{BoundaryGroup, GroupedFacet, MeshErrorKind};
use unilateral::prelude::*;
use unilateral::problem::Datum;

fn boxed<const D: usize>(names: &[&str]) -> Vec<Box<dyn Scheme<D>>> {
    names.iter().map(|name| name.parse::<NamedScheme>().unwrap().make()).collect()
}

/// The box `(-1, 1)^D` in two regions, divided at zero along the first axis, and a third one that both
/// intersect, above zero along the last one.
fn divided<const D: usize>(n: usize) -> Mesh<D> {
    let mesh = Mesh::kuhn_box(&BoxDomain::<D>::centred(1.0), [n; D]).unwrap();
    let of = |c: usize| {
        let x = mesh.barycentre(c);
        u16::from(x[0] > 0.0) + 2 * u16::from(x[D - 1] > 0.0)
    };
    let of_cells = (0..mesh.n_cells()).map(of).collect();
    let names = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>();
    let regions = vec![
        names(&["left"]),
        names(&["right"]),
        names(&["left", "high"]),
        names(&["right", "high"]),
    ];
    mesh.clone().with_regions(regions, of_cells).unwrap()
}

fn regions_are_inherited<const D: usize>() {
    let mut mesh = divided::<D>(2);
    let volume = |mesh: &Mesh<D>, region: usize| -> f64 {
        let cells = (0..mesh.n_cells()).filter(|&c| mesh.region(c) == region);
        cells.map(|c| mesh.geometry(c).volume).sum()
    };
    for _ in 0..3 {
        let fine = mesh.refine().unwrap().0;
        assert_eq!(fine.regions(), mesh.regions());
        assert!((0..fine.n_cells()).all(|c| fine.region(c) == mesh.region(c >> D)));
        for region in 0..4 {
            let (a, b) = (volume(&mesh, region), volume(&fine, region));
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert_eq!(fine.boundary_groups(), mesh.boundary_groups());
        for facet in fine.boundary() {
            let x = fine.facet_barycentre(facet.cell as usize, facet.local as usize);
            let side = usize::from(facet.group);
            assert!((x[side / 2] - [-1.0, 1.0][side % 2]).abs() < 1e-12);
        }
        mesh = fine;
    }
}

#[test]
fn regions_and_groups_are_inherited_by_refinement() {
    regions_are_inherited::<1>();
    regions_are_inherited::<2>();
    regions_are_inherited::<3>();
}

/// Data by name make the inequality that functions of space make.
fn names_agree_with_functions<const D: usize>(n: usize) {
    let mesh = divided::<D>(n);
    let is_right = |x: &Point<D>| x[0] > 0.0;
    let lower = |x: &Point<D>| if x[0] > 0.0 { x[0] - 2.0 } else { -0.5 * x[0] - 2.0 };
    let load = |x: &Point<D>| x[0] * x[0];
    let plain = Problem::new()
        .coefficient(move |x| if is_right(x) { 100.0 } else { 1.0 })
        .source(move |x: &Point<D>| if is_right(x) { 2.0 } else { load(x) })
        .reaction(move |x: &Point<D>| if is_right(x) { 0.5 } else { 0.0 })
        .obstacle_below(lower);
    let named = Problem::new()
        .coefficient_in("right", 100.0)
        .source_in("right", 2.0)
        .source(load)
        .reaction_in("right", 0.5)
        .obstacle_below_in("left", |x: &Point<D>| -0.5 * x[0] - 2.0)
        .obstacle_below_in("right", |x: &Point<D>| x[0] - 2.0);
    // by sides in one dimension, where no side lies on both values
    let (plain, named) = match D {
        1 => (
            plain.dirichlet(|x| if x[0] < 0.5 { 1.0 } else { 0.25 }),
            named.dirichlet_on("left", 1.0).dirichlet_on("right", 0.25),
        ),
        _ => (plain.dirichlet(|_| 0.75), named.dirichlet(|_| 0.75)),
    };
    for scheme in boxed::<D>(&["p1", "p2", "cr", "sipg", "wopsip", "sipg-p2"]) {
        let name = scheme.name();
        let assemble = |problem: &Problem<D>| {
            let of = Discretisation::new(&*scheme, problem, &mesh, Default::default()).unwrap();
            of.inequality().unwrap()
        };
        let (a, b) = (assemble(&plain), assemble(&named));
        let close = |a: &[f64], b: &[f64], what: &str| {
            let size = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
            let far = a.iter().zip(b).find(|(x, y)| (*x - *y).abs() > 1e-13 * size);
            assert!(a.len() == b.len() && far.is_none(), "{name}, {D}D, {what}: {far:?}");
        };
        close(&a.matrix.values, &b.matrix.values, "matrix");
        close(&a.load, &b.load, "load");
        let values = |bounds: &[Bound<f64>]| -> Vec<f64> {
            bounds.iter().map(|b| b.lower().unwrap_or(9.0)).collect()
        };
        close(&values(&a.bounds), &values(&b.bounds), "bounds");
    }
}

#[test]
fn names_and_functions_make_the_same_inequality() {
    names_agree_with_functions::<1>(8);
    names_agree_with_functions::<2>(4);
    names_agree_with_functions::<3>(2);
}

#[test]
fn the_first_datum_takes_precedence() {
    let mesh = divided::<2>(4);
    // cells of region "high" are in "left" or "right" too
    let problem = Problem::new().coefficient_in("high", 5.0).coefficient_in("left", 7.0);
    let other = Problem::new().coefficient_in("left", 7.0).coefficient_in("high", 5.0);
    let trace = |problem: &Problem<2>| {
        let of = Discretisation::new(&Wopsip::default(), problem, &mesh, Default::default());
        let matrix = of.unwrap().matrix();
        matrix.values.iter().map(|v| v.abs()).sum::<f64>()
    };
    assert!((trace(&problem) - trace(&other)).abs() > 1.0);
    // the area of "high" is two, half of it in "left"
    let load = |problem: Problem<2>| {
        let of = Discretisation::new(&Wopsip::default(), &problem, &mesh, Default::default());
        of.unwrap().inequality().unwrap().load.iter().sum::<f64>()
    };
    let high_first = load(Problem::new().source_in("high", 1.0).source_in("left", 0.0));
    let left_first = load(Problem::new().source_in("left", 0.0).source_in("high", 1.0));
    assert!((high_first - 2.0).abs() < 1e-12 && (left_first - 1.0).abs() < 1e-12);

    // the corner of two Dirichlet sides
    let corner = mesh.vertices().iter().position(|x| x[0] == -1.0 && x[1] == -1.0).unwrap();
    let value = |problem: Problem<2>| {
        let of = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default());
        match of.unwrap().inequality().unwrap().bounds[corner] {
            Bound::Fixed(value) => value,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(value(Problem::new().dirichlet_on("left", 1.0).dirichlet_on("bottom", 2.0)), 1.0);
    assert_eq!(value(Problem::new().dirichlet_on("bottom", 2.0).dirichlet_on("left", 1.0)), 2.0);
}

#[test]
fn of_the_obstacles_of_two_regions_the_higher_holds_where_they_meet() {
    let mesh = divided::<2>(4);
    let problem = Problem::new()
        .obstacle_below_in("left", -1.0)
        .obstacle_below_in("right", -0.5)
        .obstacle_above_in("left", 3.0);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default()).unwrap();
    for (x, bound) in mesh.vertices().iter().zip(of.inequality().unwrap().bounds) {
        if let Bound::Fixed(_) = bound {
            continue;
        }
        let expected = if x[0] < 0.0 { Some(-1.0) } else { Some(-0.5) };
        let above = (x[0] <= 0.0).then_some(3.0);
        assert_eq!((bound.lower(), bound.upper()), (expected, above), "at {x}");
    }
}

fn refusal(problem: &Problem<2>, mesh: &Mesh<2>) -> Error {
    Discretisation::new(&ConformingP1, problem, mesh, Default::default()).map(|_| ()).unwrap_err()
}

#[test]
fn wrong_names_are_refused() {
    let mesh = divided::<2>(2);
    let error = refusal(&Problem::new().coefficient_in("steel", 2.0), &mesh);
    let said = "the mesh has no region `steel`; ";
    assert!(matches!(&error, Error::UnknownGroup(why) if why.starts_with(said)), "{error}");
    assert!(error.to_string().ends_with("it has high, left, right"), "{error}");
    let error = refusal(&Problem::new().dirichlet_on("foot", 2.0), &mesh);
    assert!(matches!(&error, Error::UnknownGroup(why) if why.contains("boundary group `foot`")));
    let error = refusal(&Problem::new().signorini_on("left", 2.0), &mesh);
    let said = "has contact data on boundary group left, whose facets are dirichlet in the mesh";
    assert!(matches!(&error, Error::UnboundBoundary(why) if why.contains(said)), "{error}");
    let twice = Problem::new().signorini_on("left", 2.0).neumann_on("left", |_, _| 0.0);
    let error = twice.bind_boundary(mesh.clone()).unwrap_err();
    assert_eq!(error.kind, MeshErrorKind::GroupWithTwoConditions, "{error}");
}

#[test]
fn a_problem_gives_the_boundary_its_conditions() {
    let problem = Problem::new()
        .constant_source(-4.0)
        .signorini_on("bottom", |x: &Point<2>| 0.1 * x[0] - 0.1)
        .neumann_on("left", |x, n| x[1] * n[0]);
    let mesh = problem.bind_boundary(divided::<2>(8)).unwrap();
    let condition =
        |BoundaryGroup { names, condition, .. }: &BoundaryGroup| (names[0].clone(), *condition);
    let conditions: Vec<_> = mesh.boundary_groups().iter().map(condition).collect();
    let expected = [
        ("left", BoundaryCondition::Neumann),
        ("right", BoundaryCondition::Dirichlet),
        ("bottom", BoundaryCondition::Contact),
        ("top", BoundaryCondition::Dirichlet),
    ];
    assert!(
        conditions.iter().zip(expected).all(|(a, b)| a.0 == b.0 && a.1 == Some(b.1)),
        "{conditions:?}"
    );
    // as by a domain with these sides and functions for all facets with a condition
    let domain = BoxDomain::<2>::centred(1.0).side(0, 0, BoundaryCondition::Neumann).side(
        1,
        0,
        BoundaryCondition::Contact,
    );
    let plain = Problem::new()
        .constant_source(-4.0)
        .signorini(|x| 0.1 * x[0] - 0.1)
        .neumann(|x, n| x[1] * n[0]);
    let same = Mesh::<2>::kuhn_box(&domain, [8, 8]).unwrap();
    for scheme in boxed::<2>(&["p1", "cr", "sipg", "wopsip", "p2"]) {
        let a = solve(&problem, &mesh, &*scheme).unwrap();
        let b = solve(&plain, &same, &*scheme).unwrap();
        assert!(a.converged() && a.active() > Some(0));
        assert_eq!(a.values(), b.values(), "{}", scheme.name());
    }
}

/// A datum that may be given by name: its name, by which it is given on a group and everywhere, and the value that is in
/// force.
type NamedDatum = (
    &'static str,
    fn(Problem<2>, &str, f64) -> Problem<2>,
    fn(Problem<2>, f64) -> Problem<2>,
    fn(&Discretisation<'_, 2>) -> f64,
);

/// The unit square, whose cells are all in the regions `one` and `two` and whose boundary facets are all in the groups
/// `one` and `two`.
fn named_twice() -> Mesh<2> {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [2, 2]).unwrap();
    let mut facets = Vec::new();
    for f in mesh.boundary() {
        let vertices: Vec<u32> =
            mesh.facet_vertices(f.cell as usize, usize::from(f.local)).collect();
        let vertices = [vertices[0], vertices[1]];
        facets.extend([0, 1].map(|group| GroupedFacet { vertices, group }));
    }
    let names = ["one", "two"].map(str::to_owned);
    let (vertices, cells) = (mesh.vertices().to_vec(), mesh.cells().to_vec());
    let mesh = Mesh::with_groups(vertices, cells, &facets, &names).unwrap();
    let n_cells = mesh.n_cells();
    mesh.with_regions(vec![names.to_vec()], vec![0; n_cells]).unwrap()
}

/// Of data with names that a cell or facet has, the one given first is in force, and any of them before the one without a
/// name.
#[test]
fn every_datum_by_name_has_the_documented_precedence() {
    fn energy(of: &Discretisation<'_, 2>, u: fn(&Point<2>) -> f64) -> f64 {
        let values: Vec<f64> = of.mesh().vertices().iter().map(u).collect();
        of.energy(&values).unwrap()
    }
    fn bound(of: &Discretisation<'_, 2>, x: [f64; 2]) -> Bound<f64> {
        let vertex = of.mesh().vertices().iter().position(|y| *y == Point::from(x)).unwrap();
        let constant = of.constants().get(vertex).copied().unwrap_or(0.0);
        match of.bounds().unwrap()[vertex] {
            Bound::Lower(value) => Bound::Lower(value + constant),
            Bound::Upper(value) => Bound::Upper(value + constant),
            Bound::Fixed(value) => Bound::Fixed(value + constant),
            other => other,
        }
    }
    let data: [NamedDatum; 8] = [
        (
            "coefficient",
            |p, name, value| p.coefficient_in(name, value),
            |p, value| p.coefficient(move |_| value),
            |of| 2.0 * energy(of, |x| x[0]),
        ),
        (
            "source",
            |p, name, value| p.source_in(name, value),
            Problem::constant_source,
            |of| -energy(of, |_| 1.0),
        ),
        (
            "reaction",
            |p, name, value| p.reaction_in(name, value),
            |p, value| p.reaction(value),
            |of| 2.0 * energy(of, |_| 1.0),
        ),
        (
            "lower obstacle",
            |p, name, value| p.obstacle_below_in(name, value),
            |p, value| p.obstacle_below(move |_| value),
            |of| bound(of, [0.5; 2]).lower().unwrap(),
        ),
        (
            "upper obstacle",
            |p, name, value| p.obstacle_above_in(name, value),
            |p, value| p.obstacle_above(move |_| value),
            |of| bound(of, [0.5; 2]).upper().unwrap(),
        ),
        (
            "Dirichlet datum",
            |p, name, value| p.dirichlet_on(name, value),
            |p, value| p.dirichlet(move |_| value),
            |of| bound(of, [0.5, 0.0]).fixed_value().unwrap(),
        ),
        (
            "Neumann datum",
            |p, name, value| p.neumann_on(name, move |_, _| value),
            |p, value| p.neumann(move |_, _| value),
            // the boundary has the length four
            |of| -energy(of, |_| 1.0) / 4.0,
        ),
        (
            "gap",
            |p, name, value| p.signorini_on(name, value),
            |p, value| p.signorini(move |_| value),
            |of| bound(of, [0.5, 0.0]).lower().unwrap(),
        ),
    ];
    for (name, on_group, everywhere, in_force) in data {
        let value = |problem: Problem<2>| {
            let has_boundary = problem.dirichlet.is_given() || problem.neumann.is_given();
            let problem = match has_boundary || problem.gap.is_given() {
                true => problem,
                false => problem.neumann_on("one", |_, _| 0.0),
            };
            let mesh = problem.bind_boundary(named_twice()).unwrap();
            let of = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default());
            in_force(&of.unwrap())
        };
        for [first, second] in [["one", "two"], ["two", "one"]] {
            let problem = on_group(on_group(Problem::new(), first, 2.0), second, 5.0);
            let found = value(problem);
            assert!((found - 2.0).abs() < 1e-14, "{name}, {first} first: {found}");
            let found = value(everywhere(on_group(Problem::new(), first, 2.0), 7.0));
            assert!((found - 2.0).abs() < 1e-14, "{name}, {first} and everywhere: {found}");
        }
    }
}

/// The total load, which is the integral of the source.
fn total_load<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>, name: &str) -> f64 {
    let scheme = &*boxed::<D>(&[name])[0];
    let of = Discretisation::new(scheme, problem, mesh, Default::default()).unwrap();
    of.load().unwrap().iter().sum()
}

#[test]
fn sources_of_one_name_add_up() {
    // a constant, a function, jumps in two cells and a discrete function: 1 + 1/2 + 0.3 + 2 * 0.3 + 4
    let line = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<1>::kuhn_box(&line, [4]).unwrap();
    let four = {
        let none = Problem::new();
        let of = Discretisation::new(&ConformingP1, &none, &mesh, Default::default()).unwrap();
        of.function(&[4.0; 5])
    };
    let problem = Problem::new()
        .constant_source(1.0)
        .source(|x| x[0])
        .piecewise_source(|x| f64::from(x[0] < 0.3), |x| x[0] - 0.3)
        .piecewise_source(|x| 2.0 * f64::from(x[0] > 0.7), |x| x[0] - 0.7)
        .source_in("default", four);
    for name in ["p1", "p2", "sipg"] {
        let found = total_load(&problem, &mesh, name);
        assert!((found - 6.4).abs() < 1e-13, "{name}: {found}");
    }
    // constants stay one: no quadrature
    let constants = Problem::<1>::new().constant_source(1.0).constant_source(-3.0);
    assert_eq!(format!("{constants:?}"), "Problem { source: Constant(-2.0) }");
    // those of a name add up, and take precedence over the name given later and over none
    let named = Problem::new()
        .constant_source(70.0)
        .source_in("one", 2.0)
        .source_in("two", 500.0)
        .source_in("one", |x: &Point<2>| x[0])
        .constant_source(7.0);
    let named = named.dirichlet_on("one", 0.0);
    let mesh_of_names = named.bind_boundary(named_twice()).unwrap();
    let found = total_load(&named, &mesh_of_names, "p1");
    assert!((found - 2.5).abs() < 1e-13, "{found}");
    // a bound is guaranteed if that of each term is
    let unproven = |source: Datum<1>| {
        let mut problem = Problem::new();
        problem.source = source.into();
        solve(&problem, &mesh, &ConformingP1).unwrap().bound().unwrap().unproven
    };
    let linear = Datum::polynomial(1, |x: &Point<1>| x[0]);
    assert_eq!(unproven(linear.plus(2.0.into())), []);
    assert_eq!(unproven(linear.plus(Datum::from(|x: &Point<1>| x[0]))), [Unproven::Quadrature]);
}

#[test]
fn a_datum_that_is_given_twice_is_refused() {
    type Give = fn(Problem<2>, Option<&str>, f64) -> Problem<2>;
    let data: [(&str, Give); 7] = [
        ("coefficient", |p, name, value| match name {
            Some(name) => p.coefficient_in(name, value),
            None => p.coefficient(move |_| value),
        }),
        ("reaction", |p, name, value| match name {
            Some(name) => p.reaction_in(name, value),
            None => p.reaction(value),
        }),
        ("lower obstacle", |p, name, value| match name {
            Some(name) => p.obstacle_below_in(name, value),
            None => p.obstacle_below(move |_| value),
        }),
        ("upper obstacle", |p, name, value| match name {
            Some(name) => p.obstacle_above_in(name, value),
            None => p.obstacle_above(move |_| value),
        }),
        ("Dirichlet datum", |p, name, value| match name {
            Some(name) => p.dirichlet_on(name, value),
            None => p.dirichlet(move |_| value),
        }),
        ("Neumann datum", |p, name, value| match name {
            Some(name) => p.neumann_on(name, move |_, _| value),
            None => p.neumann(move |_, _| value),
        }),
        ("gap", |p, name, value| match name {
            Some(name) => p.signorini_on(name, value),
            None => p.signorini(move |_| value),
        }),
    ];
    let mesh = named_twice();
    for (what, give) in data {
        for name in [Some("one"), None] {
            // the same value twice is a mistake too, and a clone knows of it
            for value in [1.0, 2.0] {
                let once = give(Problem::new(), Some("two"), 3.0);
                let twice = give(give(once, name, 1.0), name, value).clone();
                let of = Discretisation::new(&ConformingP1, &twice, &mesh, Default::default());
                let error = of.err().unwrap_or_else(|| panic!("{what} {name:?} {value}"));
                assert!(matches!(error, Error::GivenTwice(_)), "{error}");
                let place = name.map_or("without a name".to_owned(), |name| format!("for {name}"));
                let said = format!("the {what} {place} is given twice: give it once");
                assert!(error.to_string().starts_with(&said), "{error}");
            }
        }
    }
    // a study is refused before anything runs, and what is set takes the place of what was given
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mut problem = Problem::new().obstacle_below(|_| -1.0).obstacle_below(|_| -2.0);
    let study = |problem: &Problem<2>| {
        let scene = Scene::new("mine", square.clone(), problem.clone());
        Study::new(scene).scheme(ConformingP1).levels([2]).run().map(|report| report.rows.len())
    };
    let Err(Error::GivenTwice(why)) = study(&problem) else { panic!("it was given once") };
    assert!(why.starts_with("the lower obstacle without a name is given twice"), "{why}");
    problem.lower = Datum::Constant(-1.0).into();
    assert_eq!(study(&problem).unwrap(), 1);
}

/// Two sources that jump on one surface, and one with a reaction that does, are divided there as one source is.
#[test]
fn sources_that_jump_on_one_surface_are_divided_there() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [4, 4]).unwrap();
    let level = |x: &Point<2>| x[0] + 0.3 * x[1] - 0.11;
    let side = move |x: &Point<2>| if level(x) > 0.0 { 1.0 } else { -1.0 };
    let load = |problem: &Problem<2>| {
        let of = Discretisation::new(&ConformingP1, problem, &mesh, Default::default()).unwrap();
        of.load().unwrap()
    };
    let one = Problem::new().piecewise_source(move |x| 3.0 * side(x), level);
    let two = Problem::new()
        .piecewise_source(side, level)
        .piecewise_source(move |x| 2.0 * side(x), move |x| -2.0 * level(x));
    let smooth = Problem::new().source(move |x| 3.0 * side(x));
    let [one, two, smooth] = [one, two, smooth].map(|problem| load(&problem));
    let apart =
        |other: &[f64]| one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart(&two) < 1e-13, "{:e}", apart(&two));
    assert!(apart(&smooth) > 1e-3, "{:e}", apart(&smooth));
}
