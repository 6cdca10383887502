//! The bound on the error of the discrete solution: the midpoint of function and flux.

use crate::support::checks::Checks;
use crate::support::meshes::Random;
use unilateral::assemble::DataQuadrature;
use unilateral::error_bound::{ErrorBound, Flux, PrimalDualPair};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;

/// Every scheme that has a bound.
const SCHEMES: &str = "p1 p2 cr sipg nipg iipg ldg br2 bmmpr wopsip wopsip:facet-means \
    sipg:facet-means wopsip@eta=1e4 ldg-switch sipg-p2 nipg-p2 iipg-p2 ldg-p2 br2-p2 \
    bmmpr-p2 wopsip-p2";

fn scheme_of<const D: usize>(name: &str) -> (NamedScheme, Box<dyn AnyScheme<f64, D>>) {
    let named: NamedScheme = name.parse().unwrap();
    let scheme = named.make();
    (named, scheme)
}

/// An interval, square or cube whose sides are Dirichlet but for one of each other part, and data with random numbers:
/// obstacles and gaps are affine, coefficients jump on lines of the mesh.
fn random_problem<const D: usize>(random: &mut Random) -> (Problem<D>, BoxDomain<D>) {
    let mut domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
    let mut problem = Problem::new().constant_source(between(-20.0, 20.0));
    let contrast = 10.0_f64.powf(between(-2.0, 2.0));
    if between(0.0, 1.0) < 0.6 {
        problem = problem.coefficient(move |x| if x[0] < 0.5 { 1.0 } else { contrast });
    }
    if between(0.0, 1.0) < 0.5 {
        problem = problem.reaction(10.0_f64.powf(between(-1.0, 3.0)));
    }
    let plane = |a: f64, b: f64| move |x: &Point<f64, D>| a * x[0] + b * x[D - 1];
    let (a, b, below) = (between(-0.1, 0.1), between(-0.1, 0.1), between(0.2, 0.4));
    if between(0.0, 1.0) < 0.7 {
        let slope = plane(a, b);
        problem = problem.obstacle_below(move |x| slope(x) - below);
    }
    if between(0.0, 1.0) < 0.4 {
        let (slope, above) = (plane(b, a), between(0.2, 0.4));
        problem = problem.obstacle_above(move |x| slope(x) + above);
    }
    if between(0.0, 1.0) < 0.5 {
        let flux = between(-1.0, 1.0);
        problem = problem.neumann(move |_, _| flux);
        domain = domain.side(0, 1, BoundaryPart::Neumann);
    }
    if D > 1 && between(0.0, 1.0) < 0.5 {
        let (slope, gap) = (plane(a, 0.0), between(0.01, 0.1));
        problem = problem.signorini(move |x| slope(x) - 0.1 - gap);
        domain = domain.side(D - 1, 0, BoundaryPart::Contact);
    }
    (problem, domain)
}

/// For random problems and all schemes the distance of the solution from one of quadratics on a finer mesh is at most
/// the sum of both bounds, and no bound is above that by the triangle inequality. Returns the number of pairs.
fn check_random_pairs<const D: usize>(
    problems: u64,
    (n, refinements): (usize, usize),
    checks: &mut Checks,
) -> usize {
    let mut pairs = 0;
    for number in 0..problems {
        let (problem, domain) = random_problem::<D>(&mut Random(1000 * D as u64 + number));
        let mesh = Mesh::<f64, D>::kuhn_box(&domain, [n; D]).unwrap();
        let meshes = Hierarchy::refine(&mesh, refinements).unwrap();
        let of_reference = problem.clone();
        let mut nested = NestedIteration::new(&of_reference, &meshes);
        let reference = nested.solve_on(refinements, &ConformingP2).unwrap();
        assert!(reference.converged(), "{D} {number}: {}", reference.outcome());
        let of_reference = reference.bound().unwrap().discrete;
        for name in SCHEMES.split_whitespace() {
            let (named, scheme) = scheme_of::<D>(name);
            let mut problem = problem.clone();
            problem.constraint_set = named.constraint_set();
            let mut nested = NestedIteration::new(&problem, &meshes);
            let solved = nested.solve_on(0, &*scheme).unwrap();
            if !solved.converged() {
                continue;
            }
            let distance = solved.difference(&reference).unwrap().broken_energy.unwrap();
            let bound = solved.bound().unwrap();
            let what =
                || format!("{D}, {number}, {name}: {distance:e}, {of_reference:e}, {bound:?}");
            let most = bound.total + bound.distance;
            checks.that(bound.discrete + of_reference >= distance * (1.0 - 1e-9), what);
            checks.that(bound.discrete <= most && bound.discrete >= 0.5 * bound.total, what);
            pairs += 1;
        }
    }
    pairs
}

#[test]
fn bounds_of_random_problems_are_never_below_the_error() {
    let mut checks = Checks::default();
    check_random_pairs::<1>(6, (4, 3), &mut checks);
    check_random_pairs::<2>(3, (4, 2), &mut checks);
    check_random_pairs::<3>(1, (2, 1), &mut checks);
    checks.finish();
}

#[test]
#[ignore = "a thousand pairs take minutes"]
fn bounds_of_a_thousand_random_pairs_are_never_below_the_error() {
    let mut checks = Checks::default();
    let pairs = check_random_pairs::<1>(30, (4, 4), &mut checks)
        + check_random_pairs::<2>(30, (4, 3), &mut checks)
        + check_random_pairs::<3>(6, (2, 2), &mut checks);
    checks.finish();
    assert!(pairs > 1000, "{pairs}");
}

/// The bound from function, flux and discrete solution by its formula, for linears with constant load and coefficient
/// and an obstacle that is zero.
fn midpoint_bound(
    (mesh, pair): (&Mesh<f64, 2>, &PrimalDualPair<2>),
    (alpha, load): (f64, f64),
    gradient_of: &dyn Fn(usize) -> Point<f64, 2>,
) -> f64 {
    let rule = Rule::new(2, 2);
    let (mut mismatch, mut complementarity, mut distance) = (0.0, 0.0, 0.0);
    for cell in 0..mesh.n_cells() {
        let (geometry, corners) = (mesh.geometry(cell), mesh.cell(cell));
        let vertex = |k: usize| mesh.vertices()[corners[k] as usize];
        let flux = [0, 1, 2].map(|facet| pair.flux.through(cell, facet));
        let multiplier = -flux.iter().sum::<f64>() / geometry.volume - load;
        let value = |k: usize| pair.function[corners[k] as usize];
        let gradient: Point<f64, 2> = (0..3).map(|k| *geometry.gradient(k) * value(k)).sum();
        let discrete = gradient_of(cell);
        for (point, weight) in rule.iter() {
            let weight = weight * geometry.volume;
            let x: Point<f64, 2> = (0..3).map(|k| vertex(k) * point[k]).sum();
            let v: f64 = (0..3).map(|k| value(k) * point[k]).sum();
            let q: Point<f64, 2> =
                (0..3).map(|k| (x - vertex(k)) * (flux[k] / (2.0 * geometry.volume))).sum();
            mismatch += weight * (gradient * alpha - q).norm_squared() / alpha;
            complementarity += weight * multiplier.max(0.0) * v;
            let of_midpoint = (gradient * alpha + q) / 2.0 - discrete * alpha;
            distance += weight * of_midpoint.norm_squared() / alpha;
        }
    }
    (mismatch / 4.0 + complementarity).sqrt() + distance.sqrt()
}

#[test]
fn the_bound_is_that_of_the_midpoint() {
    let (alpha, load) = (3.0, -40.0);
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<f64, 2>::kuhn_box(&square, [8, 8]).unwrap();
    let problem = Problem::new()
        .constant_source(load)
        .coefficient(move |_| alpha)
        .dirichlet(|x| 0.5 * x[0])
        .obstacle_below(|_| 0.0);
    for name in ["p1", "sipg", "nipg", "wopsip"] {
        let (_, scheme) = scheme_of::<2>(name);
        let solved = solve(&problem, &mesh, &*scheme).unwrap();
        assert!(solved.converged() && solved.active() > Some(0), "{name}");
        let pair = solved.primal_dual_pair().unwrap();
        let bound = solved.bound().unwrap();
        // by the values of the discrete function at the barycentre and near it
        let gradient_of = |cell: usize| {
            let middle = mesh.barycentre(cell);
            let value = |x: &Point<f64, 2>| solved.value_at(x).unwrap();
            Point::from_fn(|k, _| {
                let mut beside = middle;
                beside[k] += 0.01;
                (value(&beside) - value(&middle)) / 0.01
            })
        };
        let expected = midpoint_bound((&mesh, &pair), (alpha, load), &gradient_of);
        let ratio = bound.discrete / expected;
        assert!((ratio - 1.0).abs() < 1e-8, "{name}: {ratio}");
        assert!(bound.parts.obstacle > 0.0 && bound.discrete < bound.total + bound.distance);
    }
}

/// The bound of the functions that vanish, with a flux that vanishes.
fn bound_of_zero<const D: usize>(problem: &Problem<D>, mesh: &Mesh<f64, D>) -> ErrorBound {
    let quadrature = DataQuadrature::default().cell(20);
    let solved =
        NestedIteration::new(problem, mesh).quadrature(quadrature).solve(&ConformingP1).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.function.fill(0.0);
    pair.flux = Flux::zero(0, mesh.n_cells());
    solved.discretisation().error_bound(&pair, &vec![0.0; solved.values().len()]).unwrap()
}

/// Zero has the load `cos(n pi x)` as its oscillation, with the coefficient of each cell. The flux of the solution is
/// `-sin(n pi x) / (n pi)`, so that the bounds are the error.
#[test]
fn oscillation_alone_is_the_error() {
    let side = |part| BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(0, 1, part);
    let mesh = Mesh::<f64, 1>::kuhn_box(&side(BoundaryPart::Neumann), [4]).unwrap();
    let wave = |x: &Point<f64, 1>| (4.0 * std::f64::consts::PI * x[0]).cos();
    let alpha = |x: &Point<f64, 1>| if x[0] < 0.25 { 0.1 } else { 5.0 };
    let problem = Problem::new().source(wave).coefficient(alpha);
    let bound = bound_of_zero(&problem, &mesh);
    let square = (0.25 / 0.1 + 0.75 / 5.0) / 2.0 / (4.0 * std::f64::consts::PI).powi(2);
    for found in [bound.total, bound.discrete] {
        assert!((found / square.sqrt() - 1.0).abs() < 1e-6, "{found} {}", square.sqrt());
    }
}

/// A load with a mean counts with a constant of Friedrichs' inequality and the least coefficient, wherever that is.
#[test]
fn a_load_that_no_flux_balances_counts_with_the_least_coefficient() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<f64, 1>::kuhn_box(&domain, [4]).unwrap();
    let total = |alpha: fn(&Point<f64, 1>) -> f64| {
        bound_of_zero(&Problem::new().constant_source(6.0).coefficient(alpha), &mesh).total
    };
    let expected = total(|_| 0.1);
    // the error of zero is 6 / 12^(1/2) / 0.1^(1/2)
    assert!(expected >= 6.0 / 1.2_f64.sqrt());
    let first: fn(&Point<f64, 1>) -> f64 = |x| if x[0] < 0.25 { 0.1 } else { 5.0 };
    for alpha in [first, |x| if x[0] > 0.75 { 0.1 } else { 5.0 }] {
        let found = total(alpha);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// With a reaction `c` the solution is `cos(n pi x) / ((n pi)^2 + c)`, and the load counts with the smaller one of
/// `1 / (n pi)` and `c^-1/2`.
#[test]
fn a_large_reaction_makes_oscillation_smaller() {
    let free = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryPart::Neumann)
        .side(0, 1, BoundaryPart::Neumann);
    let mesh = Mesh::<f64, 1>::kuhn_box(&free, [4]).unwrap();
    let wave = |x: &Point<f64, 1>| (4.0 * std::f64::consts::PI * x[0]).cos();
    let square = (4.0 * std::f64::consts::PI).powi(2);
    for reaction in [1.0, 100.0, 1e4] {
        let bound = bound_of_zero(&Problem::new().source(wave).reaction(reaction), &mesh);
        let error = (0.5 / (square + reaction)).sqrt();
        let expected = (1.0 / square).min(1.0 / reaction).sqrt() * 0.5_f64.sqrt();
        for found in [bound.total, bound.discrete] {
            assert!((found / expected - 1.0).abs() < 1e-6, "{reaction}: {found} {expected}");
            assert!(found >= error * (1.0 - 1e-6), "{reaction}: {found} {error}");
        }
    }
}

/// A Neumann datum with mean zero counts with the constant of the trace inequality alone.
#[test]
fn a_neumann_datum_counts_by_the_trace_inequality() {
    use std::f64::consts::PI;
    let square =
        BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(1, 0, BoundaryPart::Neumann);
    let mesh = Mesh::<f64, 2>::kuhn_box(&square, [1, 1]).unwrap();
    let problem = Problem::new().coefficient(|_| 4.0).neumann(|x, _| x[0] - 0.5);
    let bound = bound_of_zero(&problem, &mesh);
    // one facet of length one, a cell of measure one half and of diameter the root of two
    let constant = (2.0 * (1.0 / (PI * PI) + 1.0 / PI) * 2.0).sqrt();
    let expected = constant * (1.0_f64 / 12.0).sqrt() / 2.0;
    for found in [bound.total, bound.discrete] {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

/// Where the difference of `v` and the discrete function alone counts: both are constants, and the reaction is one.
#[test]
fn values_count_with_the_reaction() {
    let free = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryPart::Neumann)
        .side(0, 1, BoundaryPart::Neumann);
    let mesh = Mesh::<f64, 1>::kuhn_box(&free, [4]).unwrap();
    let problem = Problem::new().constant_source(6.0).reaction(3.0);
    let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.flux = Flux::zero(0, mesh.n_cells());
    pair.function.fill(2.5);
    // the solution is two, and so is the discrete one
    let bound = solved.discretisation().error_bound(&pair, solved.values()).unwrap();
    let expected = 0.5 * 3.0_f64.sqrt();
    for found in [bound.total, bound.distance, bound.discrete] {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}
