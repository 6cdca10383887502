//! A constant added to the data changes nothing but the values of the solution.

use std::sync::Arc;

use crate::support::checks::Checks;
use crate::support::meshes::Random;
use unilateral::constraint::Bernstein;
use unilateral::error::Error;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::real::Precision;
use unilateral::scheme::{SchemeOptions, scheme_by_name};

const SCHEMES: [&str; 9] =
    ["p1", "p2", "cr", "sipg", "nipg", "ldg", "wopsip", "sipg-p2", "p2:bernstein"];

/// A scheme and whether bounds are on Bernstein coefficients.
fn scheme<const D: usize>(label: &str) -> (Box<dyn Scheme<D>>, bool) {
    let (name, placement) = label.split_once(':').unwrap_or((label, ""));
    let scheme = scheme_by_name(name, &SchemeOptions::default()).unwrap();
    (scheme, placement == "bernstein")
}

/// What holds a body besides bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    DirichletData,
    Reaction,
    BoundsAlone,
}

/// A box, loaded by `f + 0.3 x`, on a foundation at the lower end of the last axis or under an obstacle, with a flux
/// through the upper end of the first axis.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    held: Held,
    has_gap: bool,
    has_lower: bool,
    has_upper: bool,
    /// Of the reaction `r (1 + x)`; zero for none.
    reaction: f64,
    load: f64,
    flux: f64,
    level: usize,
}

impl Drawn {
    fn new(random: &mut Random, level: usize) -> Self {
        let held = [Held::DirichletData, Held::Reaction, Held::BoundsAlone][random.below(3)];
        let mut odd = || random.below(2) == 1;
        let (has_gap, has_lower, has_upper, has_reaction) = (odd(), odd(), odd(), odd());
        let presses = held == Held::BoundsAlone;
        let reaction = if presses || held == Held::DirichletData && !has_reaction {
            0.0
        } else {
            0.5 + random.unit()
        };
        Self {
            held,
            has_gap,
            has_lower: has_lower || presses && !has_gap,
            has_upper,
            reaction,
            // what bounds alone hold is pressed down
            load: if presses { -1.5 - random.unit() } else { 2.0 - 4.0 * random.unit() },
            flux: if presses { -0.2 } else { random.unit() - 0.5 },
            level,
        }
    }

    fn domain<const D: usize>(&self) -> BoxDomain<D> {
        let sides = match self.held {
            Held::DirichletData => BoundaryCondition::Dirichlet,
            _ => BoundaryCondition::Neumann,
        };
        let mut domain = BoxDomain::new(Point::zeros(), Point::repeat(1.0), [[sides; 2]; D]);
        domain = domain.side(0, 1, BoundaryCondition::Neumann);
        if self.has_gap {
            domain = domain.side(D - 1, 0, BoundaryCondition::Contact);
        }
        domain
    }

    /// The problem of `u + c`.
    fn problem<const D: usize>(&self, c: f64) -> Problem<D> {
        let Self { reaction, load, flux, .. } = *self;
        let of_reaction = move |x: &Point<D>| reaction * (1.0 + x[0]);
        let mut problem = Problem::new()
            .source(move |x| load + 0.3 * x[0] + of_reaction(x) * c)
            .neumann(move |_, n| if n[0] > 0.5 { flux } else { 0.0 })
            .dirichlet(move |x| c + 0.1 * x[0]);
        if reaction > 0.0 {
            problem = problem.reaction(of_reaction);
        }
        if self.has_gap {
            problem = problem.signorini(move |x| c - 0.05 + 0.02 * x[0]);
        }
        if self.has_lower {
            problem = problem.obstacle_below(move |x| c - 0.09 + 0.02 * x[0] * x[0]);
        }
        if self.has_upper {
            problem = problem.obstacle_above(move |x| c + 0.15 + 0.1 * x[0]);
        }
        problem
    }

    /// `J(u + c) - J(u)`.
    fn added_energy(&self, c: f64) -> f64 {
        -c * (self.load + 0.15 + self.flux) - 0.75 * self.reaction * c * c
    }
}

/// What is compared of a solve.
struct Found {
    outcome: String,
    systems: Option<usize>,
    outer: usize,
    largest_violation: f64,
    values: Vec<f64>,
    resultant: Option<f64>,
    bound: Option<f64>,
    /// None where nothing carries the load.
    energy: Option<f64>,
}

fn found<const D: usize>(drawn: &Drawn, label: &str, c: f64, precision: Precision) -> Found {
    let (scheme, is_bernstein) = scheme::<D>(label);
    let mut problem = drawn.problem::<D>(c);
    if is_bernstein {
        problem = problem.on(Bernstein);
    }
    let mesh = Mesh::<D>::kuhn_box(&drawn.domain(), [drawn.level; D]).unwrap();
    let solver: Arc<_> = in_precision(precision, ActiveSet::default()).into();
    let solved = NestedIteration::new(&problem, &mesh).shared_solver(solver).solve(&*scheme);
    let solved = solved.unwrap();
    Found {
        outcome: solved.outcome().to_string(),
        systems: solved.solution().systems,
        outer: solved.solution().outer,
        largest_violation: solved.certificate().largest(),
        values: solved.values().to_vec(),
        resultant: solved.resultant(),
        bound: solved.bound().ok().map(|bound| bound.total),
        energy: solved.energy().unwrap(),
    }
}

fn compare<const D: usize>(drawn: &Drawn, label: &str, c: f64, checks: &mut Checks) {
    let [near, far] = [0.0, c].map(|c| found::<D>(drawn, label, c, Precision::Double));
    let what = || format!("{label} in {D}d, c = {c:e}, {drawn:?}");
    // rounding of data of this size
    let rounding = c.abs() * f64::EPSILON;
    checks.that(near.outcome == far.outcome, || {
        format!("{}: {} and {}", what(), near.outcome, far.outcome)
    });
    // a body that only contact holds touches everywhere: the scene is degenerate
    let is_degenerate = drawn.held == Held::BoundsAlone && drawn.reaction == 0.0;
    let is_one_apart = |a: usize, b: usize| a.abs_diff(b) <= if is_degenerate { 4 } else { 1 };
    checks.that(
        is_one_apart(near.outer, far.outer)
            && near.systems.zip(far.systems).is_none_or(|(a, b)| is_one_apart(a, b)),
        || {
            let all = [near.outer, far.outer];
            format!("{}: steps {all:?}, systems {:?} {:?}", what(), near.systems, far.systems)
        },
    );
    // where nothing carries the load there is no iterate
    checks.that(near.energy.is_none() || far.largest_violation < 1e-9, || {
        format!("{}: certificate {:e}", what(), far.largest_violation)
    });
    let apart = near.values.iter().zip(&far.values).map(|(a, b)| (a + c - b).abs());
    let apart = apart.fold(0.0, f64::max);
    checks.that(apart <= 1e-9 + 32.0 * rounding, || format!("{}: values {apart:e}", what()));
    let n = drawn.level as f64;
    let forces = near.resultant.unwrap_or(0.0) - far.resultant.unwrap_or(0.0);
    checks.that(
        near.resultant.is_some() == far.resultant.is_some()
            && forces.abs() <= 1e-8 + 64.0 * n.powi(D as i32) * rounding,
        || format!("{}: forces {:?} {:?}", what(), near.resultant, far.resultant),
    );
    // a bound is the root of an integral of forces times distances, which have the rounding of the data
    let squares = [near.bound, far.bound].map(|bound| bound.map_or(0.0, |bound| bound * bound));
    let share = if label.contains("p2") { 0.1 } else { 1e-6 };
    checks.that(
        near.bound.is_some() == far.bound.is_some()
            && (squares[0] - squares[1]).abs() <= share * squares[0] + 1e-12 + 64.0 * rounding,
        || format!("{}: bounds {:?} {:?}", what(), near.bound, far.bound),
    );
    let added = drawn.added_energy(c);
    let energies = near.energy.zip(far.energy).map(|(near, far)| near + added - far);
    checks.that(
        near.energy.is_some() == far.energy.is_some()
            && energies.is_none_or(|e| e.abs() <= 1e-9 + 64.0 * f64::EPSILON * added.abs()),
        || format!("{}: energies {:?} + {added}, {:?}", what(), near.energy, far.energy),
    );
}

/// A number of size 1 to 1e7, of both signs.
fn constant(random: &mut Random) -> f64 {
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    sign * 10_f64.powf(7.0 * random.unit())
}

fn compare_all<const D: usize>(draws: usize, level: usize, seed: u64) {
    let (mut random, mut checks) = (Random(seed), Checks::default());
    for k in 0..draws {
        let drawn = Drawn::new(&mut random, level);
        let c = constant(&mut random);
        compare::<D>(&drawn, SCHEMES[k % SCHEMES.len()], c, &mut checks);
    }
    checks.finish();
}

#[test]
fn on_a_line() {
    compare_all::<1>(18, 9, 1);
}
#[test]
fn in_the_plane() {
    compare_all::<2>(18, 4, 2);
}
#[test]
fn in_space() {
    compare_all::<3>(9, 2, 3);
}
#[test]
#[ignore = "long"]
fn on_a_line_many() {
    compare_all::<1>(300, 11, 4);
}
#[test]
#[ignore = "long"]
fn in_the_plane_many() {
    compare_all::<2>(300, 6, 5);
}
#[test]
#[ignore = "long"]
fn in_space_many() {
    compare_all::<3>(100, 3, 6);
}

/// In single precision the constant is added in double precision: 1e7 has no digit behind the point in `f32`.
#[test]
fn in_single_precision() {
    let drawn = Drawn {
        held: Held::DirichletData,
        has_gap: true,
        has_lower: false,
        has_upper: false,
        reaction: 0.0,
        load: -2.0,
        flux: 0.1,
        level: 4,
    };
    for label in ["p1", "cr", "sipg", "wopsip"] {
        let near = found::<2>(&drawn, label, 0.0, Precision::Double);
        let far = found::<2>(&drawn, label, 1e7, Precision::Single);
        assert_eq!(far.outcome, "converged", "{label}");
        let apart = near.values.iter().zip(&far.values).map(|(a, b)| (a + 1e7 - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-5, "{label}: {apart:e}");
    }
}

/// The constant is zero where its size does not exceed the range of the data: what is computed there without it is
/// computed elsewhere with it.
#[test]
fn objectives_and_energies_keep_their_meaning() {
    let drawn = Drawn {
        held: Held::DirichletData,
        has_gap: false,
        has_lower: true,
        has_upper: false,
        reaction: 0.7,
        load: -2.0,
        flux: 0.1,
        level: 4,
    };
    let mesh = Mesh::<2>::kuhn_box(&drawn.domain(), [4, 4]).unwrap();
    for label in ["p1", "cr", "sipg", "ldg", "wopsip", "sipg-p2"] {
        let (scheme, _) = scheme::<2>(label);
        let figures = |c: f64| {
            let problem = drawn.problem::<2>(c);
            let solved = unilateral::nested::solve(&problem, &mesh, &*scheme).unwrap();
            let has_constant = !solved.discretisation().constants().is_empty();
            assert_eq!(has_constant, c.abs() > 0.3, "{label} {c}");
            [solved.objective().unwrap(), solved.energy().unwrap().unwrap()]
        };
        let step = 0.05;
        let [below, at, above, far] = [-step, 0.0, step, 9.0].map(figures);
        for k in 0..2 {
            // quadratics in the constant
            let slope = (above[k] - below[k]) / (2.0 * step);
            let curvature = (above[k] - 2.0 * at[k] + below[k]) / (step * step);
            let expected = at[k] + 9.0 * slope + 40.5 * curvature;
            let unit = at[k].abs() + (9.0 * slope).abs() + (40.5 * curvature).abs();
            // differences divided by the square of the step
            assert!(
                (far[k] - expected).abs() <= 1e-7 * unit,
                "{label} {k}: {} for {expected}",
                far[k]
            );
        }
    }
}

/// Two bodies that have no vertex in common have a constant each; what the constants leave is the same.
#[test]
fn each_body_has_a_constant_of_its_own() {
    let problem = |levels: [f64; 2]| {
        let level = move |x: &Point<1>| if x[0] < 1.5 { levels[0] } else { levels[1] };
        Problem::<1>::new()
            .constant_source(-1.0)
            .dirichlet(move |x| level(x))
            .obstacle_below(move |x| level(x) - 0.05)
            .exact(move |x| level(x), |_| Point::zeros())
    };
    let vertices = [0.0, 0.25, 0.5, 0.75, 1.0, 2.0, 2.25, 2.5, 2.75, 3.0].map(Point::<1>::repeat);
    let cells = [0, 1, 2, 3, 5, 6, 7, 8].iter().flat_map(|&v| [v, v + 1]).collect();
    let end = |v: u32| TaggedFacet { vertices: [v], condition: BoundaryCondition::Dirichlet };
    let mesh = Mesh::new(vertices.to_vec(), cells, &[0, 4, 5, 9].map(end)).unwrap();
    for label in ["p1", "p2", "cr", "sipg", "wopsip", "sipg-p2"] {
        let (scheme, _) = scheme::<1>(label);
        let (near, far) = (problem([0.0, 0.0]), problem([1e6, 3.0]));
        let near = unilateral::nested::solve(&near, &mesh, &*scheme).unwrap();
        let far = unilateral::nested::solve(&far, &mesh, &*scheme).unwrap();
        assert!(far.converged(), "{label}: {}", far.outcome());
        assert_eq!(near.active(), far.active(), "{label}");
        let values = [&near, &far].map(|solved| solved.fields().unwrap().u);
        let errors = [&near, &far].map(|solved| solved.errors().unwrap().l2.unwrap());
        assert!((errors[0] - errors[1]).abs() < 1e-9, "{label}: {errors:?}");
        for (k, (a, b)) in values[0].iter().zip(&values[1]).enumerate() {
            let level = if k < 8 { 1e6 } else { 3.0 };
            let rounding = 1e-12 + 8.0 * f64::EPSILON * level;
            assert!((a + level - b).abs() < rounding, "{label} at {k}: {a} and {b}");
        }
        // an obstacle of known degree
        let mut above = problem([1e6, 3.0]);
        above.lower = Datum::Constant(2.5).into();
        let bound = unilateral::nested::solve(&above, &mesh, &*scheme).unwrap().bound();
        assert!(bound.is_ok_and(|bound| bound.total < 0.2), "{label}");
    }
}

/// Data that contradict each other do so on every level.
#[test]
fn contradictions_are_found_on_every_level() {
    let mesh = Mesh::<1>::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), [4]);
    let mesh = mesh.unwrap();
    for c in [0.0, 300.0, 1e7] {
        let problem = Problem::<1>::new().dirichlet(move |_| c - 1.0);
        let problem = problem.obstacle_below(move |_| c + 0.001).obstacle_above(move |_| c);
        let of = Discretisation::new(&Sipg::default(), &problem, &mesh, Default::default());
        let error = of.unwrap().inequality().unwrap_err();
        let Error::EmptyConstraint { lower, upper, .. } = error else { panic!("{error}") };
        assert!((lower - c - 0.001).abs() < 1e-8 && (upper - c).abs() < 1e-8, "{lower} {upper}");
    }
}

/// A solve that starts from the solution of the same problem with another constant starts at its solution.
#[test]
fn a_start_has_the_constant_of_its_own_problem() {
    let of = |c: f64| Problem::<2>::new().constant_source(-8.0).dirichlet(move |_| c);
    let of = |c: f64| of(c).obstacle_below(move |_| c - 0.2);
    let (domain, label) = (BoxDomain::<2>::centred(1.0), "p1");
    let mesh = Mesh::<2>::kuhn_box(&domain, [8, 8]).unwrap();
    let (scheme, _) = scheme::<2>(label);
    let (first, second) = (of(300.0), of(1e5));
    let before = unilateral::nested::solve(&first, &mesh, &*scheme).unwrap();
    let mut nested = NestedIteration::new(&second, &mesh).start_from(before.solution());
    let after = nested.solve(&*scheme).unwrap();
    assert!(before.converged() && after.converged());
    assert!(before.outer() > Some(1));
    assert_eq!(after.outer(), Some(1));
}

/// Sources that are discrete functions, and those that jump within cells, lose the constant times the reaction at every
/// point of their rule.
#[test]
fn reactions_of_every_kind_of_source() {
    let domain = BoxDomain::<2>::centred(1.0).side(0, 0, BoundaryCondition::Neumann);
    let domain = domain.side(0, 1, BoundaryCondition::Neumann);
    let domain = domain.side(1, 0, BoundaryCondition::Neumann);
    let domain = domain.side(1, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<2>::kuhn_box(&domain, [4, 4]).unwrap();
    let level = |x: &Point<2>| x[0] + 0.3 * x[1] - 0.11;
    let side = move |x: &Point<2>| if level(x) > 0.0 { 1.0 } else { -1.0 };
    let reaction = || Datum::piecewise(move |x| 2.0 + 0.5 * side(x), level);
    let c = 1e6;
    for label in ["p1", "sipg", "p2"] {
        let (scheme, _) = scheme::<2>(label);
        let jumps = |c: f64| {
            let f = move |x: &Point<2>| side(x) + c * (2.0 + 0.5 * side(x));
            Problem::<2>::new().piecewise_source(f, level).reaction(reaction())
        };
        let discrete = |c: f64| {
            let load = Problem::<2>::new().reaction(1.0).source(move |x| x[0] + 2.0 * c);
            let f = unilateral::nested::solve(&load, &mesh, &ConformingP1).unwrap().function();
            Problem::<2>::new().source_in("default", f.unwrap()).reaction(2.0)
        };
        for of in [&jumps as &dyn Fn(f64) -> Problem<2>, &discrete] {
            let problems = [0.0, c].map(of);
            let solved = |k: usize| unilateral::nested::solve(&problems[k], &mesh, &*scheme);
            let (near, far) = (solved(0).unwrap(), solved(1).unwrap());
            assert!(far.converged(), "{label}");
            let apart = near.values().iter().zip(far.values()).map(|(a, b)| (a + c - b).abs());
            let apart = apart.fold(0.0, f64::max);
            assert!(apart < 1e-8, "{label}: {apart:e}");
        }
    }
}

/// Fields of quadratics have the constant at vertices and at midpoints of edges.
#[test]
fn fields_have_the_constant() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [2, 2]).unwrap();
    let problem = Problem::new().dirichlet(|x| 100.0 + x[0]);
    let solved = solve(&problem, &mesh, &ConformingP2).unwrap();
    let fields = solved.fields().unwrap();
    assert_eq!((fields.u.len(), fields.midpoints.len()), (24, 24));
    // the means over the square, of each vertex and of each midpoint by cell
    for values in [&fields.u, &fields.midpoints] {
        let mean = values.iter().sum::<f64>() / 24.0;
        assert!((mean - 100.5).abs() < 1e-10, "{mean}");
    }
}
