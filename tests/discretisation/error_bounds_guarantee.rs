//! What bounds claim to be proven: data for which they once claimed too much, or gave no bound.

use crate::support::checks::Checks;
use unilateral::assemble::DataQuadrature;
use unilateral::error_bound::Unproven;
use unilateral::prelude::*;
use unilateral::problem::{BoundaryFlux, Datum};
use unilateral::quadrature::VertexRule;

/// The interval (0, 1) with Neumann data at both ends.
fn free_interval() -> BoxDomain<1> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann)
}

/// On one cell P1 has the constant one as its solution, whose flux vanishes: the bound is oscillation alone. Twice the
/// energy of a fine solution of the equation of the error bounds the square of the error from below.
#[test]
fn a_reaction_that_vanishes_at_a_vertex_gives_no_constant() {
    let mut checks = Checks::default();
    let [coarse, fine] = [1, 20_000].map(|n| Mesh::<1>::kuhn_box(&free_interval(), [n]).unwrap());
    for (factor, power) in [(1e6, 1), (1e12, 1), (1e6, 2), (1e9, 2), (1e12, 2)] {
        let reaction = move |x: &Point<1>| factor * x[0].powi(power);
        let rest = |x: &Point<1>| 6.0 * x[0] * x[0] - 6.0 * x[0] + 1.0;
        let problem = Problem::new()
            .source(move |x| reaction(x) + rest(x))
            .reaction(reaction)
            .polynomial_data(2);
        let bound = solve(&problem, &coarse, &ConformingP1).unwrap().bound().unwrap();
        let of_error = Problem::new().source(rest).reaction(reaction);
        let error = solve(&of_error, &fine, &ConformingP1).unwrap();
        let square = -2.0 * error.objective().unwrap();
        let label = format!("{factor:e} x^{power}: {:e}, {:e}", bound.total, square.sqrt());
        checks.that(bound.total.powi(2) >= square && bound.distance < 1e-9, || label);
    }
    checks.finish();
}

#[test]
fn a_reaction_that_is_negative_between_points_gives_no_norm() {
    for n in [1, 2] {
        let mesh = Mesh::<1>::kuhn_box(&free_interval(), [n]).unwrap();
        let problem = Problem::new()
            .constant_source(1.0)
            .reaction(|x: &Point<1>| x[0] - 0.02)
            .polynomial_data(1);
        let bound = solve(&problem, &mesh, &ConformingP1).unwrap().bound();
        assert!(matches!(bound, Err(unilateral::error_bound::NoBound::NegativeReaction)));
    }
}

/// The obstacles differ by a quadratic that is small in a cell: no value at its midpoint exceeds one and stays below
/// the other by Bernstein coefficients.
#[test]
fn two_obstacles_of_degree_two_may_leave_no_room() {
    let interval = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let width = |x: &Point<1>| 0.001313 + 15.967666 * (x[0] - 0.286928).powi(2);
    let problem = Problem::new()
        .constant_source(3.974717)
        .obstacle_below(move |x| -width(x))
        .obstacle_above(width)
        .polynomial_data(2);
    for name in ["p2", "sipg-p2"] {
        let unproven = |n: usize| {
            let mesh = Mesh::<1>::kuhn_box(&interval, [n]).unwrap();
            let scheme: NamedScheme = name.parse().unwrap();
            solve(&problem, &mesh, &*scheme.make()).unwrap().bound().unwrap().unproven
        };
        assert_eq!(unproven(2), [Unproven::Obstacle], "{name}");
        assert_eq!(unproven(64), [], "{name}");
    }
}

/// In a cell with two Dirichlet facets an obstacle of degree two that touches zero on both is exceeded inside.
#[test]
fn an_obstacle_of_degree_two_is_exceeded_in_a_corner() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [3, 3]).unwrap();
    let problem = Problem::new()
        .constant_source(-0.10764068)
        .obstacle_below(|x| -6.81321883 * (x[0] + 1.0 - x[1] - 0.290277879).powi(2))
        .polynomial_data(2);
    for name in ["p2", "sipg-p2", "wopsip-p2"] {
        let scheme: NamedScheme = name.parse().unwrap();
        let bound = solve(&problem, &mesh, &*scheme.make()).unwrap().bound().unwrap();
        assert_eq!(bound.unproven, [Unproven::Obstacle], "{name}");
    }
}

/// Where no facet is in contact, all forces are zero but for rounding.
#[test]
fn open_contact_facets_have_a_bound() {
    let mut checks = Checks::default();
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(1, 0, BoundaryCondition::Contact)
        .side(0, 1, BoundaryCondition::Neumann);
    for gap in [-5.0, -0.02] {
        let problem = Problem::new().constant_source(1.0).signorini(move |_| gap);
        for (n, name) in
            [2, 4, 8].into_iter().flat_map(|n| ["p1", "cr", "sipg", "p2"].map(|s| (n, s)))
        {
            let mesh = Mesh::<2>::kuhn_box(&square, [n, n]).unwrap();
            let scheme: NamedScheme = name.parse().unwrap();
            let bound = solve(&problem, &mesh, &*scheme.make()).unwrap().bound();
            checks.that(bound.is_ok(), || format!("{name}, {n}, {gap}: {bound:?}"));
        }
    }
    checks.finish();
}

/// A rule on facets that does not integrate the stated data leaves the bound unproven.
#[test]
fn facet_rules_are_held_against_stated_degrees() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(1, 0, BoundaryCondition::Contact)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let problem = Problem::new()
        .constant_source(-1.0)
        .neumann(|x, _| x[1] * x[1])
        .signorini(|x| 0.1 * x[0] - 0.2)
        .polynomial_data(2);
    let unproven = |quadrature: DataQuadrature| {
        let mut iteration = NestedIteration::new(&problem, &mesh).quadrature(quadrature);
        iteration.solve(&ConformingP1).unwrap().bound().unwrap().unproven
    };
    assert!(!unproven(DataQuadrature::default()).contains(&Unproven::Quadrature));
    for quadrature in
        [DataQuadrature::default().facet(1), DataQuadrature::default().family(&VertexRule)]
    {
        assert!(unproven(quadrature).contains(&Unproven::Quadrature));
    }
}

/// The rules of a bound follow the degrees of polynomial data: with these stated it has the value that rules of a high
/// degree give.
#[test]
fn rules_follow_the_degrees_of_data() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(1, 0, BoundaryCondition::Contact)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<2>::kuhn_box(&square, [2, 2]).unwrap();
    let source = |x: &Point<2>| 40.0 * x[0].powi(12) - 20.0 * x[1].powi(11);
    let flux = |x: &Point<2>, _: &Point<2>| 10.0 * x[1].powi(12);
    let gap = |x: &Point<2>| -0.1 + 0.1 * x[0].powi(2);
    let functions = Problem::new().source(source).neumann(flux).signorini(gap);
    let mut polynomials = functions.clone();
    polynomials.source.everywhere = Some(Datum::polynomial(12, source));
    polynomials.neumann.everywhere =
        Some(BoundaryFlux::Polynomial { value: std::sync::Arc::new(flux), degree: 12 });
    polynomials.gap.everywhere = Some(Datum::polynomial(2, gap));
    for name in ["p1", "sipg", "p2"] {
        let scheme: NamedScheme = name.parse().unwrap();
        let scheme = scheme.make();
        let bound = |problem: &Problem<2>, degree: usize| {
            let quadrature = DataQuadrature::default().cell(26).facet(degree);
            let mut nested = NestedIteration::new(problem, &mesh).quadrature(quadrature);
            nested.solve(&*scheme).unwrap().bound().unwrap()
        };
        let (by_degrees, by_rules) = (bound(&polynomials, 15), bound(&functions, 26));
        let far = (by_degrees.discrete / by_rules.discrete - 1.0).abs();
        assert!(far < 1e-10, "{name}: {far:e}");
        assert!(!by_degrees.unproven.contains(&Unproven::Quadrature), "{name}");
        assert!(by_rules.unproven.contains(&Unproven::Quadrature), "{name}");
    }
}

/// A reaction alone decides which rule the terms of cells need.
#[test]
fn rules_follow_the_degree_of_the_reaction() {
    let mesh = Mesh::<1>::kuhn_box(&free_interval(), [2]).unwrap();
    let reaction = |x: &Point<1>| 1.0 + 3.0 * x[0] * x[0];
    let problem = |datum: Datum<1>| Problem::new().constant_source(-4.0).reaction(datum);
    for scheme in [&ConformingP1 as &dyn Scheme<1>, &ConformingP2] {
        let [by_degree, by_rules] =
            [Datum::polynomial(2, reaction), reaction.into()].map(|datum| {
                let (problem, quadrature) = (problem(datum), DataQuadrature::default().cell(26));
                let mut nested = NestedIteration::new(&problem, &mesh).quadrature(quadrature);
                nested.solve(scheme).unwrap().bound().unwrap().discrete
            });
        let far = (by_degree / by_rules - 1.0).abs();
        assert!(far < 1e-10, "{}: {by_degree} {by_rules}", scheme.name());
    }
}

/// In space an edge of a contact facet may lie on a Dirichlet facet, whose datum its midpoint takes: a gap of degree two
/// that touches zero between the ends exceeds zero by its Bernstein coefficient there.
#[test]
fn a_gap_of_degree_two_is_held_against_the_quadratic_on_facets() {
    let cube = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(
        2,
        0,
        BoundaryCondition::Contact,
    );
    let mesh = Mesh::<3>::kuhn_box(&cube, [1; 3]).unwrap();
    for (depth, expected) in [(0.0, vec![Unproven::Obstacle]), (0.3, vec![])] {
        let problem = Problem::new()
            .constant_source(1.0)
            .signorini(move |x| -(x[0] - 0.5).powi(2) - depth)
            .polynomial_data(2);
        let bound = solve(&problem, &mesh, &ConformingP2).unwrap().bound().unwrap();
        assert_eq!(bound.unproven, expected, "{depth}");
    }
}

/// Each datum by itself: what is not proven for linears and for quadratics where it is stated as a polynomial in cells.
#[test]
fn every_datum_is_held_against_what_a_bound_needs() {
    use Unproven::{Boundary, Obstacle, Quadrature};
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(1, 0, BoundaryCondition::Contact)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let x = |x: &Point<2>| x[0];
    let under_gap = |problem: Problem<2>| problem.signorini(|_| -0.3).obstacles_of_degree(0);
    let loaded = || Problem::new().constant_source(-1.0);
    let constant = || under_gap(loaded());
    let unproven = |problem: &Problem<2>| -> [Vec<Unproven>; 2] {
        [&ConformingP1 as &dyn Scheme<2>, &ConformingP2]
            .map(|scheme| solve(problem, &mesh, scheme).unwrap().bound().unwrap().unproven)
    };
    let square = |x: &Point<2>| x[0] * x[0];
    for (label, problem, of_linears, of_quadratics) in [
        ("none", constant().polynomial_data(0), vec![], vec![]),
        (
            "source with a level",
            under_gap(Problem::new().piecewise_source(|_| -1.0, move |p| x(p) - 0.3))
                .polynomial_data(0),
            vec![Quadrature],
            vec![Quadrature],
        ),
        (
            "coefficient",
            constant().coefficient(move |p| 1.0 + x(p)).polynomial_data(1),
            vec![Quadrature],
            vec![Quadrature],
        ),
        ("reaction of degree two", constant().reaction(square).polynomial_data(2), vec![], vec![]),
        (
            "reaction of degree three",
            constant().reaction(move |p: &Point<2>| x(p).powi(3)).polynomial_data(3),
            vec![Quadrature],
            vec![Quadrature],
        ),
        ("flux", constant().neumann(|x, _| x[1].powi(3)).polynomial_data(3), vec![], vec![]),
        (
            "flux of unknown degree",
            constant().neumann(|x, _| x[1].powi(3)),
            vec![Quadrature],
            vec![Quadrature],
        ),
        ("linear gap", loaded().signorini(move |p| x(p) - 0.5).polynomial_data(1), vec![], vec![]),
        (
            "gap",
            loaded().signorini(move |p| -0.3 - square(p)).polynomial_data(2),
            vec![Obstacle],
            vec![],
        ),
        (
            "lower obstacle",
            constant().obstacle_below(move |p| -0.3 - square(p)).polynomial_data(2),
            vec![Obstacle],
            vec![],
        ),
        (
            "upper obstacle",
            constant().obstacle_above(move |p| 0.3 + square(p)).polynomial_data(2),
            vec![Obstacle],
            vec![],
        ),
        (
            "upper obstacle of degree three",
            constant().obstacle_above(move |p| 0.3 + x(p).powi(3)).polynomial_data(3),
            vec![Obstacle],
            vec![Obstacle],
        ),
        (
            "Dirichlet datum",
            constant().dirichlet(move |p| 0.1 * square(p)).polynomial_data(2),
            vec![Boundary],
            vec![],
        ),
        (
            "Dirichlet datum of degree three",
            constant().dirichlet(move |p| 0.1 * x(p).powi(3)).polynomial_data(3),
            vec![Boundary],
            vec![Boundary],
        ),
    ] {
        assert_eq!(unproven(&problem), [of_linears, of_quadratics], "{label}");
    }
}

/// What is given where another condition holds is no part of the problem: an exact solution of unknown degree beside
/// Dirichlet data of its own, and data without a name beside those of all groups.
#[test]
fn data_of_other_sides_take_no_guarantee_away() {
    use BoundaryCondition::{Contact, Neumann};
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let bounded = square.clone().side(1, 0, Contact).side(0, 1, Neumann);
    let data = || {
        let of_domain = Problem::new().constant_source(-1.0).obstacle_below(|_| -0.2);
        let of_domain = of_domain.obstacles_of_degree(0);
        let held = of_domain.dirichlet_on("left", 0.0).dirichlet_on("top", 0.0);
        let mut held = held.signorini_on("bottom", -0.1);
        held.neumann.named.push(("right".to_owned(), BoundaryFlux::Constant(0.0)));
        held
    };
    let wave = |x: &Point<2>| x[0].sin() * x[1].cos() - 5.0;
    let exact = |problem: Problem<2>| problem.exact(wave, |_| Point::zeros());
    let mesh = |domain: &BoxDomain<2>, problem: &Problem<2>| {
        problem.bind_boundary(Mesh::kuhn_box(domain, [4, 4]).unwrap()).unwrap()
    };
    let unproven = |problem: &Problem<2>, mesh: &Mesh<2>| {
        ["p1", "p2", "sipg"].map(|name| {
            let scheme: NamedScheme = name.parse().unwrap();
            solve(problem, mesh, &*scheme.make()).unwrap().bound().unwrap().unproven
        })
    };
    for (name, problem) in [
        ("exact solution", exact(data())),
        ("Dirichlet data", data().dirichlet(wave)),
        ("Neumann data", data().neumann(move |x, _| wave(x))),
        ("gap", data().signorini(wave)),
    ] {
        let found = unproven(&problem, &mesh(&bounded, &problem));
        assert_eq!(found, [const { Vec::new() }; 3], "{name}");
    }
    // no side has the condition at all
    let plain = Problem::new().constant_source(-1.0);
    for problem in [plain.clone().signorini(wave), plain.neumann(move |x, _| wave(x))] {
        let mesh = Mesh::kuhn_box(&square, [4, 4]).unwrap();
        assert_eq!(unproven(&problem, &mesh), [const { Vec::new() }; 3]);
    }
    // on a Dirichlet side it counts
    let open = exact(Problem::new().constant_source(-1.0));
    let mesh = Mesh::kuhn_box(&square, [4, 4]).unwrap();
    assert_eq!(unproven(&open, &mesh), [const { Unproven::Boundary }; 3].map(|term| vec![term]));
}

/// A linear function exceeds a convex obstacle everywhere if it does at the vertices. That an obstacle is convex along all
/// edges is not enough: `x^2 + 4 x y + y^2` is so on these meshes.
#[test]
fn linears_on_obstacles_that_are_convex_in_each_cell_are_guaranteed() {
    let square = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    let foot = square.clone().side(1, 0, BoundaryCondition::Contact);
    let [square, foot] = [square, foot].map(|domain| Mesh::kuhn_box(&domain, [4, 4]).unwrap());
    // the factors of x^2, 2 x y and y^2
    let forms: [([f64; 3], bool); 5] = [
        ([1.0, 0.0, 1.0], true),
        ([1.0, 1.0, 1.0], true),
        ([1.0, 2.0, 1.0], false),
        ([-1.0, 0.0, 1.0], false),
        ([-1.0, 0.0, -1.0], false),
    ];
    let unproven = |problem: Problem<2>, mesh: &Mesh<2>| {
        solve(&problem, mesh, &ConformingP1).unwrap().bound().unwrap().unproven
    };
    for ([a, b, c], is_convex) in forms {
        let form = move |x: &Point<2>| a * x[0] * x[0] + 2.0 * b * x[0] * x[1] + c * x[1] * x[1];
        let expected = if is_convex { vec![] } else { vec![Unproven::Obstacle] };
        let mut below = Problem::new().constant_source(-8.0);
        below.lower = Datum::polynomial(2, move |x| 0.1 * form(x) - 0.7).into();
        assert_eq!(unproven(below, &square), expected, "lower {a} {b} {c}");
        let mut above = Problem::new().constant_source(8.0);
        above.upper = Datum::polynomial(2, move |x| 0.7 - 0.1 * form(x)).into();
        assert_eq!(unproven(above, &square), expected, "upper {a} {b} {c}");
        // along the foot the first factor alone counts
        let expected = if a > 0.0 { vec![] } else { vec![Unproven::Obstacle] };
        let mut contact = Problem::new().constant_source(-8.0);
        contact.gap = Datum::polynomial(2, move |x| 0.1 * form(x) - 0.2).into();
        assert_eq!(unproven(contact, &foot), expected, "gap {a} {b} {c}");
    }
}
