//! Rules on a cell that the zeros of a function cut: integrals of loads, multipliers and errors.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{Outcome, Solution};
use unilateral::measure::ContactErrors;
use unilateral::mesh::TaggedFacet;
use unilateral::prelude::*;
use unilateral::problem::{Datum, Exact};
use unilateral::quadrature::Rule;

/// The function whose zeros cut a cell.
type Level<const D: usize> = Arc<dyn Fn(&Point<D>) -> f64 + Send + Sync>;

/// The unit simplex as a mesh of one cell, without Dirichlet boundary.
fn simplex<const D: usize>() -> Mesh<D> {
    let corner = |k: usize| Point::from_fn(|axis, _| f64::from(u8::from(k == axis + 1)));
    let facet = |opposite: u32| {
        let mut others = (0..=D as u32).filter(|&v| v != opposite);
        let vertices = std::array::from_fn(|_| others.next().unwrap());
        TaggedFacet { vertices, condition: BoundaryCondition::Neumann }
    };
    let boundary: Vec<_> = (0..=D as u32).map(facet).collect();
    Mesh::new((0..=D).map(corner).collect(), (0..=D as u32).collect(), &boundary).unwrap()
}

/// The mean over the unit simplex of a function where the level is positive, zero elsewhere.
fn mean<const D: usize>(
    degree: usize,
    level: &Level<D>,
    value: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
) -> f64 {
    let mesh = simplex::<D>();
    let (of_value, of_cut) = (Arc::clone(level), Arc::clone(level));
    let within = move |x: &Point<D>| if of_value(x) > 0.0 { value(x) } else { 0.0 };
    let problem = Problem::new().piecewise_source(within, move |x| of_cut(x));
    let quadrature = DataQuadrature::default().cell(degree);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap();
    (1..=D).map(|k| k as f64).product::<f64>() * of.load().unwrap().iter().sum::<f64>()
}

#[test]
fn the_part_within_a_sphere_is_resolved() {
    fn share<const D: usize>() -> f64 {
        mean::<D>(5, &(Arc::new(|x: &Point<D>| 0.5 - x.norm()) as Level<D>), |_| 1.0)
    }
    assert!((share::<1>() - 0.5).abs() < 1e-15);
    assert!((share::<2>() - PI / 8.0).abs() < 5e-4, "{:e}", share::<2>() - PI / 8.0);
    assert!((share::<3>() - PI / 8.0).abs() < 1.2e-2, "{:e}", share::<3>() - PI / 8.0);
}

/// A plane that cuts every unit simplex.
fn plane<const D: usize>() -> Level<D> {
    Arc::new(|x| (0..D).map(|k| (k + 1) as f64 * x[k]).sum::<f64>() - 0.6)
}

#[test]
fn polynomials_between_planes_are_exact() {
    fn check<const D: usize>() {
        let level = plane::<D>();
        let of_cube = Arc::clone(&level);
        let volume = mean::<D>(3, &level, move |x| of_cube(x).powi(3));
        // the function less its negative part, which is -0.6 at the origin and fills the simplex around it: the mean of
        // a cube of a barycentric coordinate is 3! D! / (3 + D)!
        let corner = 0.6_f64.powi(3 + D as i32) / (1..=D).map(|k| k as f64).product::<f64>()
            * [0.0, 0.25, 0.1, 0.05][D];
        let at = |b: &[f64; 4]| level(&Point::from_fn(|axis, _| b[axis + 1])).powi(3);
        let all = Rule::new(D, 3).iter().map(|(b, w)| w * at(b)).sum::<f64>();
        assert!((volume - all - corner).abs() < 1e-14, "{D}: {:e}", volume - all - corner);
        // the weights of the points on both sides sum to one
        let opposite = Arc::clone(&level);
        let opposite: Level<D> = Arc::new(move |x| -opposite(x));
        let both = mean::<D>(3, &level, |_| 1.0) + mean::<D>(3, &opposite, |_| 1.0);
        assert!((both - 1.0).abs() < 1e-13, "{D}: {:e}", both - 1.0);
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn zeros_are_found_at_jumps_too_and_in_pairs() {
    let jump: Level<1> = Arc::new(|x| if x[0] < 0.123 { -1.0 } else { 1.0 });
    assert!((mean(1, &jump, |_| 1.0) - 0.877).abs() < 1e-14);
    let flat: Level<1> = Arc::new(|x| (x[0] - 0.3).powi(5));
    assert!((mean(1, &flat, |_| 1.0) - 0.7).abs() < 1e-14);
    let pair: Level<1> = Arc::new(|x| (x[0] - 0.6) * (x[0] - 0.3));
    assert!((mean(1, &pair, |_| 1.0) - 0.7).abs() < 1e-14);
    // levels that vanish on one side, and values of which products underflow
    let hinge: Level<1> = Arc::new(|x| (x[0] - 0.3).max(0.0));
    assert!((mean(1, &hinge, |_| 1.0) - 0.7).abs() < 1e-14);
    let indicator: Level<1> = Arc::new(|x| f64::from(u8::from(x[0] > 0.3)));
    assert!((mean(1, &indicator, |_| 1.0) - 0.7).abs() < 1e-14);
    let tiny: Level<1> = Arc::new(|x| 1e-200 * (x[0] - 0.3));
    assert!((mean(1, &tiny, |_| 1.0) - 0.7).abs() < 1e-14);
}

/// The errors of a solution without contact against a multiplier on the contact set `level > 0`, and the number of
/// points at which the multiplier is evaluated.
fn contact_errors<const D: usize>(level: &Level<D>) -> (usize, ContactErrors) {
    let mesh = simplex::<D>();
    let (calls, indicator) = (Arc::new(AtomicUsize::new(0)), Arc::clone(level));
    let (counted, of_multiplier) = (Arc::clone(&calls), Arc::clone(level));
    let exact = Exact::new(|_| 0.0, |_| Point::zeros()).with_multiplier(move |x| {
        counted.fetch_add(1, Ordering::Relaxed);
        f64::from(u8::from(of_multiplier(x) > 0.0))
    });
    let exact = exact.with_contact(move |x| indicator(x), Vec::new());
    let problem = Problem::new().obstacle_below(|_| -1.0).solved_by(exact);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default());
    let of = of.unwrap();
    let n = of.unknowns();
    let solution = Solution::new(vec![0.0; n], vec![Contact::Inactive; n], Outcome::Converged);
    let errors = of.contact_errors(&of.inequality().unwrap(), &solution).unwrap();
    (calls.load(Ordering::Relaxed), errors)
}

/// A plane is the same set of zeros whether the indicator vanishes or jumps there. A cell out of contact has no
/// multiplier, a cell in contact that of a whole rule.
#[test]
fn contact_sets_are_those_of_levels_that_jump() {
    fn check<const D: usize>() {
        let plane = plane::<D>();
        let of_jump = Arc::clone(&plane);
        let jump: Level<D> = Arc::new(move |x| of_jump(x).signum());
        let (n, errors) = contact_errors(&plane);
        let (_, of_jump) = contact_errors(&jump);
        let of = |errors: ContactErrors| {
            [errors.multiplier_l1, errors.multiplier_l2, errors.contact_area_error]
                .map(Option::unwrap)
        };
        for (a, b) in of(errors).into_iter().zip(of(of_jump)) {
            assert!((a - b).abs() < 1e-14 && a > 0.0, "{a} {b}");
        }
        let (n_far, far) = contact_errors::<D>(&(Arc::new(|x: &Point<D>| x[0] - 2.0) as Level<D>));
        assert_eq!((n_far, far.contact_area_error), (0, Some(0.0)));
        // a level that vanishes close to the mesh
        let (n_near, near) =
            contact_errors::<D>(&(Arc::new(|x: &Point<D>| x[0] - 1.1) as Level<D>));
        assert_eq!((n_near, near.contact_area_error), (0, Some(0.0)));
        let (n_whole, _) = contact_errors::<D>(&(Arc::new(|x: &Point<D>| x[0] + 0.1) as Level<D>));
        assert!(n_whole > 0 && n_whole < n, "{n_whole} {n}");
    }
    check::<2>();
    check::<3>();
}

/// The square of the gradient of `value`, a function of the first coordinate, over the unit interval: by the errors of zero
/// on a box with these lengths along other axes. The levels are given one after the other as that of the contact set, of
/// load, coefficient and reaction.
fn squared_gradient<const D: usize>(
    (levels, others): (&[&Level<D>], [f64; 2]),
    value: impl Fn(f64) -> f64 + Send + Sync + 'static,
    slope: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> f64 {
    let lengths = Point::<D>::from_fn(|axis, _| [1.0, others[0], others[1]][axis]);
    let domain = BoxDomain::dirichlet(Point::zeros(), lengths);
    let mesh = Mesh::<D>::kuhn_box(&domain, [1; D]).unwrap();
    let gradient = move |x: &Point<D>| {
        let mut gradient = Point::zeros();
        gradient[0] = slope(x[0]);
        gradient
    };
    let mut exact = Exact::new(move |x: &Point<D>| value(x[0]), gradient);
    let mut problem = Problem::new().obstacle_below(|_| -9.0);
    for (k, level) in levels.iter().enumerate() {
        let level = Arc::clone(level);
        let level = move |x: &Point<D>| level(x);
        match k {
            0 => exact = exact.with_contact(level, Vec::new()),
            1 => problem = problem.piecewise_source(|_| 0.0, level),
            2 => problem = problem.coefficient_in("default", Datum::piecewise(|_| 1.0, level)),
            _ => problem = problem.reaction(Datum::piecewise(|_| 0.0, level)),
        }
    }
    let problem = problem.solved_by(exact);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default());
    let of = of.unwrap();
    of.errors(&vec![0.0; of.unknowns()]).unwrap().h1.unwrap().powi(2) / lengths.product()
}

/// Zeros that coincide, with the same and with opposite signs, divide a cell once, others each. The middle of an edge has
/// the first coordinate 1/2.
#[test]
fn several_levels_divide_a_cell_along_all_and_once_where_they_coincide() {
    fn check<const D: usize>() {
        let [half, opposite, double, far]: [Level<D>; 4] = [
            Arc::new(|x| x[0] - 0.5),
            Arc::new(|x| 0.5 - x[0]),
            Arc::new(|x| 2.0 * x[0] - 1.0),
            Arc::new(|x| x[0] + 1.0),
        ];
        let on_half = [
            &[&half][..],
            &[&half, &double],
            &[&half, &opposite],
            &[&half, &double, &double],
            &[&half, &opposite, &double],
            &[&half, &opposite, &double, &opposite],
            &[&far, &half],
            &[&half, &far],
            &[&far, &far, &far, &half],
        ];
        for (k, levels) in on_half.into_iter().enumerate() {
            // bisections of these cells do not meet the plane
            let found = squared_gradient(
                (levels, [10.0, 7.0]),
                |x| (x - 0.5).max(0.0),
                |x| if x > 0.5 { 1.0 } else { 0.0 },
            );
            assert!((found - 0.5).abs() < 1e-12, "{D}, list {k}: {found}");
        }
        let [low, high]: [Level<D>; 2] = [Arc::new(|x| x[0] - 0.4), Arc::new(|x| x[0] - 0.6)];
        let on_both = [&[&low, &high][..], &[&low, &high, &high], &[&low, &low, &high]];
        for (k, levels) in on_both.into_iter().enumerate() {
            let found = squared_gradient(
                (levels, [1.0; 2]),
                |x| x.clamp(0.4, 0.6),
                |x| if x > 0.4 && x < 0.6 { 1.0 } else { 0.0 },
            );
            assert!((found - 0.2).abs() < 1e-12, "{D}, list {k} of two: {found}");
        }
        // without a level the kink is not seen
        let found = squared_gradient(
            (&[&far, &far], [1.0; 2]),
            |x| (x - 0.45).max(0.0),
            |x| if x > 0.45 { 1.0 } else { 0.0 },
        );
        assert!((found - 0.55).abs() > 1e-6, "{D}: {found}");
    }
    check::<1>();
    check::<2>();
    check::<3>();
}
