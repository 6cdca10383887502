//! Error bounds where obstacles press on facets: through the boundary, where an obstacle ends, along a ridge.

use crate::support::checks::Checks;
use unilateral::error_bound::{NoBound, PrimalDualPair, Unproven};
use unilateral::mesh::{BoundaryCondition::*, Neighbour, Neighbours};
use unilateral::prelude::*;

const LINEARS: &str = "p1 cr sipg nipg ldg br2 wopsip sipg:facet-means wopsip:facet-means";
const QUADRATICS: &str = "p2 p2:bernstein sipg-p2 ldg-p2";

/// A mesh of the box `(0, length) x (0, 1) x ..` with these conditions at the ends of the first axis.
fn strip<const D: usize>(length: f64, ends: [BoundaryCondition; 2], n: usize) -> Mesh<D> {
    let mut upper = Point::<D>::from_element(1.0);
    upper[0] = length;
    let sides = std::array::from_fn(|axis| if axis == 0 { ends } else { [Neumann; 2] });
    let domain = BoxDomain::new(Point::<D>::zeros(), upper, sides);
    Mesh::kuhn_box(&domain, [n; D]).unwrap()
}

/// A flux presses the end `x = 0` onto an obstacle; with the sign -1 everything is upside down. The solution is
/// `0.05 x^2 + 0.15 x - 0.2`.
fn press<const D: usize>(sign: f64) -> Problem<D> {
    let problem = Problem::new()
        .constant_source(-0.1 * sign)
        .neumann(move |x, normal| if x[0] == 0.0 { sign * normal[0] } else { 0.0 })
        .polynomial_data(0)
        .exact(
            move |x| sign * (0.05 * x[0] * x[0] + 0.15 * x[0] - 0.2),
            move |x| {
                Point::from_fn(|axis, _| if axis == 0 { sign * (0.1 * x[0] + 0.15) } else { 0.0 })
            },
        );
    match sign > 0.0 {
        true => problem.obstacle_below(|_| -0.2),
        false => problem.obstacle_above(|_| 0.2),
    }
}

/// An obstacle in the right half of `(0, 2)` only: its edge at `x = 1` presses like a line. The solution touches up to
/// `2 - 0.1^(1/2)`.
fn half<const D: usize>(sign: f64, n: usize) -> (Problem<D>, Mesh<D>) {
    let mesh = strip::<D>(2.0, [Dirichlet; 2], n);
    let of_cells = (0..mesh.n_cells()).map(|c| u16::from(mesh.barycentre(c)[0] > 1.0)).collect();
    let names = ["soft", "stiff"].map(|name| vec![name.to_owned()]);
    let mesh = mesh.with_regions(names.to_vec(), of_cells).unwrap();
    let end = 2.0 - 0.1_f64.sqrt();
    let value = move |x: f64| match x {
        x if x < 1.0 => 2.0 * x * x - 2.2 * x,
        x if x < end => -0.2,
        x => 2.0 * (x - end).powi(2) - 0.2,
    };
    let slope = move |x: f64| match x {
        x if x < 1.0 => 4.0 * x - 2.2,
        x if x < end => 0.0,
        x => 4.0 * (x - end),
    };
    let problem = Problem::new().constant_source(-4.0 * sign).dirichlet(|_| 0.0).exact(
        move |x: &Point<D>| sign * value(x[0]),
        move |x: &Point<D>| {
            Point::from_fn(|axis, _| if axis == 0 { sign * slope(x[0]) } else { 0.0 })
        },
    );
    let problem = match sign > 0.0 {
        true => problem.obstacle_below_in("stiff", -0.2),
        false => problem.obstacle_above_in("stiff", 0.2),
    };
    (problem, mesh)
}

/// The pair of a scheme, its bounds and its errors: of the function, and of the discrete solution.
fn bounded<const D: usize>(
    mut problem: Problem<D>,
    mesh: &Mesh<D>,
    name: &str,
) -> (PrimalDualPair<D>, [f64; 2], [f64; 2]) {
    let named: NamedScheme = name.parse().unwrap();
    problem.constraint_set = named.constraint_set();
    let solved = solve(&problem, mesh, &*named.make()).unwrap();
    assert!(solved.converged(), "{name}");
    let pair = solved.primal_dual_pair().unwrap();
    let of_pair = solved.discretisation().error_of_pair(&pair).unwrap();
    let bound = solved.bound().unwrap();
    assert!(!bound.unproven.contains(&Unproven::Algebra), "{name}: {:?}", bound.unproven);
    let errors = solved.errors().unwrap();
    (pair, [bound.total, bound.discrete], [of_pair, errors.broken_energy.unwrap()])
}

/// Bounds exceed errors, and stay below this many times the errors; where the solution is in the space of the scheme,
/// they are rounding, or its root where a body is held by obstacles alone.
fn check_bounds<const D: usize>(
    checks: &mut Checks,
    label: &str,
    (problem, mesh, name): (Problem<D>, &Mesh<D>, &str),
    most: f64,
) {
    let (_, bounds, errors) = bounded(problem, mesh, name);
    for (bound, error) in bounds.into_iter().zip(errors) {
        let is_right = match error < 1e-10 {
            true if mesh.boundary().iter().all(|f| f.condition == Neumann) => bound < 1e-7,
            true => bound < 1e-9,
            false => bound > (1.0 - 1e-9) * error && bound < most * error,
        };
        checks.that(is_right, || format!("{label} in {D}d, {name}: {bound:e} for {error:e}"));
    }
}

/// The over-penalty of WOPSIP leaves jumps, and multipliers that are not quite those of facets, where the errors of other
/// quadratics are small or zero: its bounds stay below a number.
fn check_wopsip_p2<const D: usize>(
    checks: &mut Checks,
    label: &str,
    (problem, mesh): (Problem<D>, &Mesh<D>),
    most: f64,
) {
    let (_, bounds, errors) = bounded(problem, mesh, "wopsip-p2");
    for (bound, error) in bounds.into_iter().zip(errors) {
        let is_right = bound > (1.0 - 1e-9) * error && bound < most;
        checks.that(is_right, || format!("{label} in {D}d, wopsip-p2: {bound:e} for {error:e}"));
    }
}

fn press_in<const D: usize>(checks: &mut Checks, levels: &[usize], most: f64) {
    for name in LINEARS.split_whitespace().chain(QUADRATICS.split_whitespace()) {
        for &n in levels {
            let mesh = strip::<D>(1.0, [Neumann, Dirichlet], n);
            for sign in [1.0, -1.0] {
                let label = format!("press {sign} {n}");
                check_bounds(checks, &label, (press(sign), &mesh, name), most);
            }
        }
    }
}

/// A flux into an obstacle along the boundary: without forces on facets the bound is 40 times the error at 4 and
/// doubles with every other level.
#[test]
fn a_flux_presses_the_boundary_onto_an_obstacle() {
    let mut checks = Checks::default();
    press_in::<1>(&mut checks, &[4, 32], 2.0);
    press_in::<2>(&mut checks, &[4, 16], 2.1);
    press_in::<3>(&mut checks, &[2], 2.5);
    // 0.22 and 0.11 without forces on facets
    for (n, most) in [(4, 6e-3), (16, 2e-4)] {
        let mesh = strip::<2>(1.0, [Neumann, Dirichlet], n);
        check_wopsip_p2(&mut checks, &format!("press {n}"), (press(1.0), &mesh), most);
    }
    checks.finish();
}

/// Fluxes of both signs at both ends, onto a lower and an upper obstacle: the solution `0.4 x - 0.2` is linear.
#[test]
fn fluxes_press_onto_two_obstacles() {
    fn problem<const D: usize>() -> Problem<D> {
        Problem::new()
            .neumann(|x, normal| if x[0] == 0.0 { normal[0] } else { normal[0].max(0.0) * x[0] })
            .obstacle_below(|_| -0.2)
            .obstacle_above(|_| 0.2)
            .exact(
                |x| 0.4 * x[0] - 0.2,
                |_| Point::from_fn(|axis, _| if axis == 0 { 0.4 } else { 0.0 }),
            )
    }
    let mut checks = Checks::default();
    for name in LINEARS.split_whitespace().chain(QUADRATICS.split_whitespace()) {
        // linears of WOPSIP do not contain the solution
        let most = if name.starts_with("wopsip") { 5.0 } else { 1.0 };
        let plane = strip::<2>(1.0, [Neumann; 2], 6);
        check_bounds(&mut checks, "two obstacles", (problem(), &plane, name), most);
        let line = strip::<1>(1.0, [Neumann; 2], 6);
        check_bounds(&mut checks, "two obstacles", (problem(), &line, name), most);
    }
    checks.finish();
}

/// The edge of an obstacle inside the domain: without forces on facets the bounds of quadratics are 100 times the error
/// at 32.
#[test]
fn an_obstacle_ends_inside_the_domain() {
    let mut checks = Checks::default();
    for (names, most) in [(LINEARS, 2.5), (QUADRATICS, 4.0)] {
        for name in names.split_whitespace() {
            for (n, sign) in [(8, 1.0), (8, -1.0), (32, 1.0)] {
                let label = format!("half {sign} {n}");
                let (problem, mesh) = half::<2>(sign, n);
                check_bounds(&mut checks, &label, (problem, &mesh, name), most);
                let (problem, mesh) = half::<1>(sign, 2 * n);
                check_bounds(&mut checks, &label, (problem, &mesh, name), most);
            }
        }
    }
    // 0.34 and 0.19 without forces on facets
    for (n, most) in [(8, 0.1), (32, 0.012)] {
        let (problem, mesh) = half::<2>(1.0, n);
        check_wopsip_p2(&mut checks, &format!("half {n}"), (problem, &mesh), most);
    }
    checks.finish();
}

fn ridge_in<const D: usize>(checks: &mut Checks, n: usize) {
    let scene = scenes::ridge::<D>();
    let mesh = scene.domain.mesh(n).unwrap();
    for name in "p1 cr sipg nipg iipg p2 p2:bernstein sipg-p2 nipg-p2".split_whitespace() {
        let (_, bounds, _) = bounded(scene.problem.clone(), &mesh, name);
        let largest = bounds[0].max(bounds[1]);
        checks.that(largest < 1e-8, || format!("ridge in {D}d, {name} at {n}: {largest:e}"));
    }
}

/// The multiplier of a ridge lies on facets alone, and all of it moves there.
#[test]
fn the_ridge_of_an_obstacle_presses_on_facets() {
    let mut checks = Checks::default();
    ridge_in::<1>(&mut checks, 16);
    ridge_in::<2>(&mut checks, 8);
    ridge_in::<2>(&mut checks, 32);
    ridge_in::<3>(&mut checks, 4);
    // iterative solves leave values near the obstacle
    let schemes = NamedScheme::list(["sipg", "iipg", "ldg-switch-p2"]).unwrap();
    let study = Study::<2>::new(scenes::ridge()).levels([64]);
    for row in schemes.iter().fold(study, Study::named_scheme).run().unwrap().rows {
        let bound = row.bound.total.unwrap();
        checks.that(row.linear != "direct", || row.label.clone());
        checks.that(bound < 1e-8, || format!("ridge, {} at 64: {bound:e}", row.label));
    }
    checks.finish();
}

/// The normal components of a flux leave the two sides of a facet with the force there, on Neumann facets beside the
/// datum, and sum to zero elsewhere; forces have the sign of their obstacle.
#[test]
fn fluxes_jump_by_the_forces() {
    let mut checks = Checks::default();
    let mesh = strip::<2>(1.0, [Neumann, Dirichlet], 6);
    let (of_half, mesh_of_half) = half::<2>(-1.0, 8);
    for name in "p1 cr sipg wopsip p2 sipg-p2 wopsip-p2".split_whitespace() {
        let cases = [(press(1.0), &mesh, 1.0, 1.0), (of_half.clone(), &mesh_of_half, -1.0, 0.0)];
        for (problem, mesh, sign, flux_at_zero) in cases {
            let (pair, ..) = bounded(problem, mesh, name);
            checks.that(!pair.forces.is_empty(), || format!("{name}: no force"));
            let neighbours = Neighbours::new(mesh);
            let force_on = |facet: (usize, usize)| {
                let place = pair.forces.binary_search_by_key(&facet, |force| force.facet);
                place.map_or([0.0; 4], |k| pair.forces[k].densities)
            };
            for (cell, local) in (0..mesh.n_cells()).flat_map(|c| (0..3).map(move |f| (c, f))) {
                let force = force_on((cell, local));
                let x = mesh.facet_barycentre(cell, local);
                for j in (0..3).filter(|&j| j != local) {
                    let here = pair.flux.density(cell, local, j);
                    let vertex = mesh.cell(cell)[j];
                    let jump = match neighbours.across(cell, local) {
                        Neighbour::Cell { cell: other, local } if other as usize > cell => {
                            let other = other as usize;
                            let there = mesh.cell(other).iter().position(|&v| v == vertex);
                            here + pair.flux.density(other, local.into(), there.unwrap())
                        }
                        Neighbour::Boundary(Neumann) => {
                            let measure = mesh.geometry(cell).facet_measure(local);
                            here + if x[0] == 0.0 { measure * flux_at_zero } else { 0.0 }
                        }
                        _ => continue,
                    };
                    let is_right = (jump - force[j]).abs() < 1e-12 && sign * force[j] >= 0.0;
                    checks.that(is_right, || format!("{name}: {cell} {local}: {jump} {force:?}"));
                }
            }
        }
    }
    checks.finish();
}

/// What a flux has besides its mean on a Neumann facet counts by the trace inequality, where no data are given too: in
/// one cell `T = (|F| / |K| (1/pi^2 + 1/pi))^1/2 h |t|`, here with `t` linear and zero at the middle.
#[test]
fn the_slope_of_a_flux_on_a_neumann_facet_counts_without_data() {
    let mesh = strip::<2>(1.0, [Dirichlet, Neumann], 1);
    let problem = Problem::<2>::new().constant_source(1.0).dirichlet(|_| 0.0);
    let solved = solve(&problem, &mesh, &ConformingP2).unwrap();
    let mut pair = solved.primal_dual_pair().unwrap();
    let of = |pair: &PrimalDualPair<2>| {
        solved.discretisation().error_bound(pair, &solved.solution().values).unwrap()
    };
    assert!(of(&pair).total < 1e-12, "the solution x - x^2/2 is one of the space");
    let (cell, local) = (0..mesh.n_cells())
        .flat_map(|cell| (0..3).map(move |local| (cell, local)))
        .find(|&(cell, local)| (mesh.facet_barycentre(cell, local)[0] - 1.0).abs() < 1e-12)
        .unwrap();
    for (vertex, change) in (0..3).filter(|&j| j != local).zip([0.1, -0.1]) {
        // the divergence stays
        pair.flux.add_density(cell, local, vertex, change);
        pair.flux.add_inner(cell, vertex, -change);
    }
    let bound = of(&pair);
    let pi = std::f64::consts::PI;
    let of_trace = 2.0 * (1.0 / (pi * pi) + 1.0 / pi);
    let expected = of_trace.sqrt() * 2.0_f64.sqrt() * (0.01_f64 / 3.0).sqrt();
    let mismatch = bound.terms.mismatch.sqrt() * bound.total;
    let found = bound.total - mismatch;
    assert!((found - expected).abs() < 1e-10, "{found} for {expected}, mismatch {mismatch}");
}

/// A force that no obstacle can have, or that has both signs, gives no bound.
#[test]
fn forces_of_the_wrong_sign_are_refused() {
    let mesh = strip::<2>(1.0, [Neumann, Dirichlet], 4);
    let problem = press(1.0);
    let solved = solve(&problem, &mesh, &ConformingP2).unwrap();
    let pair = solved.primal_dual_pair().unwrap();
    let (cell, local) = pair.forces[0].facet;
    let vertex = (0..3).find(|&j| j != local).unwrap();
    for change in [-1.0, -3.0] {
        let mut wrong = pair.clone();
        wrong.forces[0].densities[vertex] += change;
        wrong.flux.add_density(cell, local, vertex, change);
        let bound = solved.discretisation().error_bound(&wrong, &solved.solution().values);
        assert!(matches!(bound, Err(NoBound::NegativeForce)), "{bound:?}");
    }
}
