//! The bound on the error of the discrete solution: the midpoint of function and flux.

use crate::support::checks::Checks;
use crate::support::meshes::Random;
use unilateral::algebra::Contact;
use unilateral::assemble::DataQuadrature;
use unilateral::error_bound::{ErrorBound, Flux, PrimalDualPair, Unproven};
use unilateral::inequality::{Outcome, Solution};
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::quadrature::Rule;

/// Every scheme that has a bound.
const SCHEMES: &str = "p1 p2 cr sipg nipg iipg ldg br2 bmmpr wopsip wopsip:facet-means \
    sipg:facet-means wopsip@eta=1e4 ldg-switch sipg-p2 nipg-p2 iipg-p2 ldg-p2 br2-p2 \
    bmmpr-p2 wopsip-p2";

fn scheme_of<const D: usize>(name: &str) -> (NamedScheme, Box<dyn Scheme<D>>) {
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
    let plane = |a: f64, b: f64| move |x: &Point<D>| a * x[0] + b * x[D - 1];
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
        domain = domain.side(0, 1, BoundaryCondition::Neumann);
    }
    if D > 1 && between(0.0, 1.0) < 0.5 {
        let (slope, gap) = (plane(a, 0.0), between(0.01, 0.1));
        problem = problem.signorini(move |x| slope(x) - 0.1 - gap);
        domain = domain.side(D - 1, 0, BoundaryCondition::Contact);
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
        let mesh = Mesh::<D>::kuhn_box(&domain, [n; D]).unwrap();
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
    (mesh, pair): (&Mesh<2>, &PrimalDualPair<2>),
    (alpha, load): (f64, f64),
    gradient_of: &dyn Fn(usize) -> Point<2>,
) -> f64 {
    let rule = Rule::new(2, 2);
    let (mut mismatch, mut complementarity, mut distance) = (0.0, 0.0, 0.0);
    for cell in 0..mesh.n_cells() {
        let (geometry, corners) = (mesh.geometry(cell), mesh.cell(cell));
        let vertex = |k: usize| mesh.vertices()[corners[k] as usize];
        let flux = [0, 1, 2].map(|facet| pair.flux.through(cell, facet));
        let multiplier = -flux.iter().sum::<f64>() / geometry.volume - load;
        let value = |k: usize| pair.function[corners[k] as usize];
        let gradient: Point<2> = (0..3).map(|k| *geometry.gradient(k) * value(k)).sum();
        let discrete = gradient_of(cell);
        for (point, weight) in rule.iter() {
            let weight = weight * geometry.volume;
            let x: Point<2> = (0..3).map(|k| vertex(k) * point[k]).sum();
            let v: f64 = (0..3).map(|k| value(k) * point[k]).sum();
            let q: Point<2> =
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
    let mesh = Mesh::<2>::kuhn_box(&square, [8, 8]).unwrap();
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
            let value = |x: &Point<2>| solved.value_at(x).unwrap();
            Point::from_fn(|k, _| {
                let mut beside = middle;
                beside[k] += 0.01;
                (value(&beside) - value(&middle)) / 0.01
            })
        };
        let expected = midpoint_bound((&mesh, &pair), (alpha, load), &gradient_of);
        let ratio = bound.discrete / expected;
        assert!((ratio - 1.0).abs() < 1e-8, "{name}: {ratio}");
        assert!(bound.terms.obstacle > 0.0 && bound.discrete < bound.total + bound.distance);
    }
}

/// The bound of the functions that vanish, with a flux that vanishes.
fn bound_of_zero<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>) -> ErrorBound {
    bound_of_zero_by(&ConformingP1, problem, mesh)
}

fn bound_of_zero_by<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> ErrorBound {
    let quadrature = DataQuadrature::default().cell(20);
    let solved = NestedIteration::new(problem, mesh).quadrature(quadrature).solve(scheme).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.function.fill(0.0);
    pair.flux = Flux::zero(pair.flux.degree(), mesh.n_cells());
    solved.discretisation().error_bound(&pair, &vec![0.0; solved.values().len()]).unwrap()
}

/// Zero has the load `cos(n pi x)` as its oscillation, with the coefficient of each cell. The flux of the solution is
/// `-sin(n pi x) / (n pi)`, so that the bounds are the error.
#[test]
fn oscillation_alone_is_the_error() {
    let side = |part| BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(0, 1, part);
    let mesh = Mesh::<1>::kuhn_box(&side(BoundaryCondition::Neumann), [4]).unwrap();
    let wave = |x: &Point<1>| (4.0 * std::f64::consts::PI * x[0]).cos();
    let alpha = |x: &Point<1>| if x[0] < 0.25 { 0.1 } else { 5.0 };
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
    let mesh = Mesh::<1>::kuhn_box(&domain, [4]).unwrap();
    let first: fn(&Point<1>) -> f64 = |x| if x[0] < 0.25 { 0.1 } else { 5.0 };
    // the constant of Friedrichs' inequality is 1 / pi
    let expected = 6.0 / std::f64::consts::PI / 0.1_f64.sqrt();
    for alpha in [first, |x| if x[0] > 0.75 { 0.1 } else { 5.0 }, |_| 0.1] {
        let bound = bound_of_zero(&Problem::new().constant_source(6.0).coefficient(alpha), &mesh);
        for found in [bound.total, bound.discrete] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
    // by a reaction it counts where that gives less
    for (reaction, expected) in [(0.5, expected), (1e4, 6.0 / 1e4_f64.sqrt())] {
        let problem = Problem::new().constant_source(6.0).coefficient(|_| 0.1).reaction(reaction);
        let found = bound_of_zero(&problem, &mesh).total;
        assert!((found / expected - 1.0).abs() < 1e-12, "{reaction}: {found} {expected}");
    }
}

/// In one cell of length two the load `x` has the mean one, for the solver, and the rest `x - 1`, for the oscillation:
/// both count with `2 / pi`.
#[test]
fn a_load_counts_by_its_mean_and_by_the_rest() {
    let interval = BoxDomain::dirichlet(Point::zeros(), Point::repeat(2.0));
    let mesh = Mesh::<1>::kuhn_box(&interval, [1]).unwrap();
    let problem = Problem::new().source(|x: &Point<1>| x[0]);
    let expected = 2.0 / std::f64::consts::PI * ((2.0_f64 / 3.0).sqrt() + 2.0_f64.sqrt());
    for scheme in [&ConformingP1 as &dyn Scheme<1>, &ConformingP2] {
        let bound = bound_of_zero_by(scheme, &problem, &mesh);
        for found in [bound.total, bound.discrete] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{}: {found}", scheme.name());
        }
    }
}

/// What the flux of quadratics leaves of the load `1 - 4 x` is `4 x - 1`: a force of the obstacle `-x` with the part
/// `2 x`, which is nowhere negative, and oscillation with the rest `2 x - 1`.
#[test]
fn forces_of_quadratics_have_one_sign() {
    use std::f64::consts::PI;
    let interval = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<1>::kuhn_box(&interval, [1]).unwrap();
    let problem = || Problem::<1>::new().polynomial_data(1);
    let lower = problem().source(|x| 1.0 - 4.0 * x[0]).obstacle_below(|x| -x[0]);
    let upper = problem().source(|x| 4.0 * x[0] - 1.0).obstacle_above(|x| x[0]);
    let oscillation = (1.0_f64 / 3.0).sqrt() / PI;
    // twice the integral of 2 x^2
    let obstacle = 4.0 / 3.0;
    let total = (oscillation.powi(2) + obstacle).sqrt();
    let discrete = 0.5 * (oscillation.powi(2) + 2.0 * obstacle).sqrt() + 0.5 * oscillation;
    for problem in [lower, upper] {
        let bound = bound_of_zero_by(&ConformingP2, &problem, &mesh);
        for (found, expected) in [(bound.total, total), (bound.discrete, discrete)] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
}

/// Zero is off a gap of minus one, and a flux that is constant presses with the force `s` there.
#[test]
fn a_contact_force_counts_with_the_distance_from_the_gap() {
    let interval = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let interval = interval.side(0, 1, BoundaryCondition::Contact);
    let mesh = Mesh::<1>::kuhn_box(&interval, [1]).unwrap();
    let problem = Problem::new().signorini(|_| -1.0).coefficient(|_| 4.0);
    let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.function.fill(0.0);
    for force in [0.5, 3.0] {
        // through the facets opposite the two vertices
        pair.flux = Flux::zero(0, 1);
        pair.flux.add_through(0, 0, force);
        pair.flux.add_through(0, 1, -force);
        let bound = solved.discretisation().error_bound(&pair, &[0.0; 2]).unwrap();
        let mismatch: f64 = force * force / 4.0;
        let total = (mismatch + 2.0 * force).sqrt();
        let discrete = 0.5 * (mismatch + 4.0 * force).sqrt() + 0.5 * mismatch.sqrt();
        for (found, expected) in [(bound.total, total), (bound.discrete, discrete)] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{force}: {found} {expected}");
        }
    }
}

/// Of quadratics the contact force `s` on a facet from minus one to three counts with its part from zero to two, and the
/// rest by the trace inequality.
#[test]
fn contact_forces_of_quadratics_have_one_sign() {
    use std::f64::consts::PI;
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(
        1,
        0,
        BoundaryCondition::Contact,
    );
    let mesh = Mesh::<2>::kuhn_box(&square, [1, 1]).unwrap();
    let problem = Problem::new().signorini(|x| -x[0]).polynomial_data(1);
    let solved = solve(&problem, &mesh, &ConformingP2).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.function.fill(0.0);
    pair.flux = Flux::zero(1, mesh.n_cells());
    let f = mesh.boundary().iter().find(|f| f.condition == BoundaryCondition::Contact).unwrap();
    let (cell, local) = (f.cell as usize, usize::from(f.local));
    for (k, &v) in mesh.cell(cell).iter().enumerate().filter(|(k, _)| *k != local) {
        pair.flux.add_density(cell, local, k, 4.0 * mesh.vertices()[v as usize][0] - 1.0);
    }
    let bound = solved.discretisation().error_bound(&pair, &vec![0.0; solved.values().len()]);
    let bound = bound.unwrap();
    // twice the integral of 2 x^2
    let contact = bound.terms.contact * bound.total.powi(2);
    assert!((contact / (4.0 / 3.0) - 1.0).abs() < 1e-12, "{contact}");
    // the cell has the diameter root of two and the divergence -3, 9, 0 at its vertices; 2 x - 1 is left of the force
    let of_divergence = 2.0_f64.sqrt() / PI * 3.25_f64.sqrt();
    let constant = (2.0 * (1.0 / (PI * PI) + 1.0 / PI) * 2.0).sqrt();
    let expected = of_divergence + constant * (1.0_f64 / 3.0).sqrt();
    let mismatch = bound.terms.mismatch;
    let found = ((mismatch + bound.terms.oscillation).sqrt() - mismatch.sqrt()) * bound.total;
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

/// With a reaction `c` the solution is `cos(n pi x) / ((n pi)^2 + c)`, and the load counts with the smaller one of
/// `1 / (n pi)` and `c^-1/2`.
#[test]
fn a_large_reaction_makes_oscillation_smaller() {
    let free = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<1>::kuhn_box(&free, [4]).unwrap();
    let wave = |x: &Point<1>| (4.0 * std::f64::consts::PI * x[0]).cos();
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
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)).side(
        1,
        0,
        BoundaryCondition::Neumann,
    );
    let mesh = Mesh::<2>::kuhn_box(&square, [1, 1]).unwrap();
    let problem = Problem::new().coefficient(|_| 4.0).neumann(|x, _| x[0] - 0.5);
    // one facet of length one, a cell of measure one half and of diameter the root of two
    let constant = (2.0 * (1.0 / (PI * PI) + 1.0 / PI) * 2.0).sqrt();
    let expected = constant * (1.0_f64 / 12.0).sqrt() / 2.0;
    // with a reaction too, by which a load would count
    for problem in [problem.clone(), problem.reaction(1e4)] {
        let bound = bound_of_zero(&problem, &mesh);
        for found in [bound.total, bound.discrete] {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
}

/// Where the difference of `v` and the discrete function alone counts: both are constants, and the reaction is one.
#[test]
fn values_count_with_the_reaction() {
    let free = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<1>::kuhn_box(&free, [4]).unwrap();
    let problem = Problem::new().constant_source(6.0).reaction(3.0);
    let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    pair.flux = Flux::zero(0, mesh.n_cells());
    // the solution is two, and so is the discrete one; two is the constant that is taken off
    assert!(solved.values().iter().all(|value| *value == 2.0));
    pair.function.fill(0.5);
    let bound = solved.discretisation().error_bound(&pair, &solved.solution().values).unwrap();
    let expected = 0.5 * 3.0_f64.sqrt();
    for found in [bound.total, bound.distance, bound.discrete] {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

/// Between points a reaction of degree two may be smaller than at all vertices and midpoints: its least Bernstein
/// coefficient counts, here 100, while the values at these points are 500 and more, and the least value is 400.
#[test]
fn a_reaction_of_degree_two_counts_by_its_least_bernstein_coefficient() {
    use std::f64::consts::PI;
    let free = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann);
    let mesh = Mesh::<1>::kuhn_box(&free, [1]).unwrap();
    let problem = |least: f64| {
        let reaction = move |x: &Point<1>| 1600.0 * (x[0] - 0.25).powi(2) + 300.0 + least;
        Problem::new().reaction(Datum::polynomial(2, reaction))
    };
    // a load without a mean, and one with: the reaction alone holds the interval
    let wave = problem(100.0).source(|x: &Point<1>| (PI * x[0]).cos());
    let mut linear = problem(100.0);
    linear.source = Datum::polynomial(1, |x: &Point<1>| 6.0 * x[0]).into();
    // the mean of the load, and what is left of it, count by the triangle inequality
    for (problem, norm) in [(&wave, 0.5_f64.sqrt()), (&linear, 3.0 + 3.0_f64.sqrt())] {
        let total = bound_of_zero(problem, &mesh).total;
        assert!((total / (norm / 10.0) - 1.0).abs() < 1e-9, "{total} {}", norm / 10.0);
    }
    assert_eq!(bound_of_zero(&linear, &mesh).unproven, []);
    // a coefficient below zero says nothing, although the reaction is positive everywhere
    let unproven = bound_of_zero(&problem(-1.0).constant_source(6.0), &mesh).unproven;
    assert_eq!(unproven, [Unproven::Quadrature, Unproven::Algebra]);
}

/// The admissible function by hand: at an interface the mean of both values with the coefficients as weights, and at a
/// midpoint the least value whose Bernstein coefficient is that of the obstacle.
#[test]
fn the_admissible_function_follows_by_hand() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let function = |problem: &Problem<1>, n: usize, scheme: &dyn Scheme<1>, values: &[f64]| {
        let mesh = Mesh::<1>::kuhn_box(&domain, [n]).unwrap();
        let of = scheme.discretise(problem, &mesh, DataQuadrature::default()).unwrap();
        let contact = vec![Contact::Inactive; values.len()];
        let solution = Solution::new(values.to_vec(), contact, Outcome::Converged);
        of.primal_dual_pair(&of.inequality().unwrap(), &solution).unwrap().function
    };
    let materials = Problem::new().coefficient(|x| if x[0] < 0.5 { 1.0 } else { 3.0 });
    let values = [0.0, 1.0, 2.0, 0.0];
    assert_eq!(function(&materials, 2, &Sipg::default(), &values), [0.0, 1.75, 0.0]);
    let parabola = Problem::new().obstacle_below(|x| -0.1 - x[0] * x[0]);
    let found = function(&parabola, 1, &ConformingP2, &[0.0, 0.0, -1.0]);
    // the coefficients 2 v_m - (v_a + v_b) / 2 are -1/10
    assert!((found[2] + 0.05).abs() < 1e-15 && found[..2] == [0.0, 0.0], "{found:?}");
}
