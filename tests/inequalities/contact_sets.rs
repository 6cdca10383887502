//! Multipliers and contact sets of discrete solutions against the exact ones.

use crate::problems::Random;
use crate::support::checks::Checks;
use crate::support::rows::{label, rows};
use crate::support::scheme_lists::all_schemes;
use crate::support::schemes::Entry;
use std::f64::consts::PI;
use unilateral::prelude::*;
use unilateral::problem::Exact;
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// The schemes with the placement of bounds each is known for.
fn schemes(names: &[(&str, &str)]) -> Vec<Entry<2>> {
    let mut schemes = all_schemes::<2>();
    schemes.retain(|s| names.contains(&(s.name(), &s.constraint()[..])));
    assert_eq!(schemes.len(), names.len());
    schemes
}

const P1: (&str, &str) = ("p1", "vertices");
const CR: (&str, &str) = ("cr", "facet-means");
const SIPG: (&str, &str) = ("sipg", "vertices");
const WOPSIP: (&str, &str) = ("wopsip", "vertices");
const WOPSIP_MEANS: (&str, &str) = ("wopsip", "facet-means");

/// The slope of the straight line closest to the logarithms of figures over those of mesh sizes.
fn fitted(rows: &[Row], figure: impl Fn(&Row) -> Option<f64>) -> f64 {
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| (row.mesh_size.ln(), figure(row).unwrap().ln())).collect();
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum::<f64>()
}

/// On every level: the free boundary within two cells, and between the sets no more than a layer of
/// one cell along a free boundary of this length.
fn check_sets(checks: &mut Checks, rows: &[Row], length: f64) {
    for row in rows {
        checks.certified(row, 1e-9);
        let cells = row.contact.free_boundary_distance.unwrap() / row.mesh_size;
        checks.that(cells <= 2.0, || format!("{}: {cells:.2} cells apart", label(row)));
        let layers = row.contact.contact_area_error.unwrap() / (row.mesh_size * length);
        checks.that(layers <= 1.0, || format!("{}: {layers:.2} layers wrong", label(row)));
    }
}

/// Orders of the multiplier over all levels of every scheme. Free boundaries of a mesh move in steps
/// of one cell, so errors of single levels oscillate.
fn check_multipliers(checks: &mut Checks, rows: &[Row], l1: [f64; 2], l2: [f64; 2]) {
    let [first, second] = [
        fitted(rows, |row| row.contact.multiplier_l1),
        fitted(rows, |row| row.contact.multiplier_l2),
    ];
    let within = |x: f64, [low, high]: [f64; 2]| low <= x && x <= high;
    checks.that(within(first, l1), || format!("{}: order {first:.3} in L1", label(&rows[0])));
    checks.that(within(second, l2), || format!("{}: order {second:.3} in L2", label(&rows[0])));
}

/// The exact density jumps, so that order one half in L2 is the best there is.
const JUMP: [f64; 2] = [0.4, 0.7];

#[test]
fn contact_in_a_disc_under_a_load() {
    let levels = [8, 16, 32, 64, 128];
    let mut checks = Checks::default();
    let found =
        rows(scenes::radial::<2>(1.0), schemes(&[P1, CR, SIPG, WOPSIP, WOPSIP_MEANS]), levels);
    for of_scheme in found.chunks(levels.len()) {
        check_sets(&mut checks, of_scheme, 2.0 * PI);
        check_multipliers(&mut checks, of_scheme, [0.85, 1.15], JUMP);
    }
    checks.finish();
}

/// At level 8 the contact disc is less than three cells wide.
#[test]
fn contact_with_a_ball() {
    let length = 2.0 * PI * 0.697_965;
    let mut checks = Checks::default();
    let levels = [16, 32, 64];
    let found = rows(scenes::ball_2d(), schemes(&[P1, CR, SIPG, WOPSIP_MEANS]), levels);
    for of_scheme in found.chunks(levels.len()) {
        check_sets(&mut checks, of_scheme, length);
        check_multipliers(&mut checks, of_scheme, [0.85, 1.35], [0.3, 0.8]);
    }
    // on finer meshes bounds at vertices are more than the solver can do
    let found = rows(scenes::ball_2d(), schemes(&[WOPSIP]), [8, 16, 32]);
    check_sets(&mut checks, &found, length);
    check_multipliers(&mut checks, &found[1..], [0.85, 1.15], [0.3, 0.8]);
    checks.finish();
}

/// Contact on a segment: the multiplier is continuous, its error of order one in L2 too. The ends of
/// contact are vertices of the mesh, and every scheme finds them.
#[test]
fn contact_on_a_segment() {
    let levels = [16, 32, 64];
    for scene in [scenes::signorini_2d(), scenes::hertz_2d()] {
        let mut checks = Checks::default();
        for of_scheme in rows(scene, all_schemes::<2>(), levels).chunks(levels.len()) {
            check_sets(&mut checks, of_scheme, 1.0);
            check_multipliers(&mut checks, of_scheme, [1.4, 2.0], [0.95, 1.3]);
            for row in of_scheme {
                let length = row.contact.contact_area_error.unwrap();
                checks.that(length < 1e-3 * row.mesh_size, || format!("{}: {length}", label(row)));
            }
        }
        checks.finish();
    }
}

/// In one dimension as in three.
#[test]
fn contact_in_other_dimensions() {
    fn check<const D: usize>(scene: Scene<D>, levels: &[usize], length: f64) {
        let mut checks = Checks::default();
        check_sets(&mut checks, &rows(scene, all_schemes::<D>(), levels.to_vec()), length);
        checks.finish();
    }
    check(scenes::radial::<1>(1.0), &[16, 32, 64], 2.0);
    check(scenes::radial::<3>(1.0), &[4, 8], 4.0 * PI);
    check(scenes::signorini_harmonic::<3>(), &[2, 4], 2.0);
}

/// Where nothing is known of the exact solution, nothing is reported.
#[test]
fn nothing_without_an_exact_solution() {
    let mut scene = scenes::radial::<2>(1.0);
    scene.problem.exact = None;
    for row in rows(scene, schemes(&[P1, SIPG]), [8, 16]) {
        assert_eq!(row.contact, Default::default());
        assert_eq!(row.order.multiplier_l1, None);
    }
}

/// A string under the load `-c` that rests on the obstacle `-1` between `a` and `1 - a`, with `c = 2 / a^2`: nodes of a
/// uniform mesh have the exact values but for the cells of the free boundary. Each stated point of it that is far from
/// the discrete one counts, and each discrete one that is far from the stated ones.
#[test]
fn the_distance_of_free_boundaries_is_that_of_hausdorff() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<1>::kuhn_box(&domain, [8]).unwrap();
    // between 1/8 and 1/4: the first node in contact is the second one
    let load = 2.0 / 0.2_f64.powi(2);
    for (stated, expected) in [
        (vec![0.25, 0.75], 0.0),
        (vec![0.25, 0.75, 0.35], 0.1),
        (vec![0.25, 0.3], 0.45),
        (vec![0.2, 0.82], 0.07),
    ] {
        let points = stated.iter().map(|&x| Point::from([x])).collect();
        let exact = Exact::new(|_| 0.0, |_| Point::zeros());
        let problem = Problem::new()
            .constant_source(-load)
            .dirichlet(|_| 0.0)
            .obstacle_below(|_| -1.0)
            .solved_by(exact.with_contact(|x| 0.05 - (x[0] - 0.5).powi(2), points));
        let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
        let found = solved.contact_errors().unwrap().free_boundary_distance.unwrap();
        assert!((found - expected).abs() < 1e-12, "{stated:?}: {found} {expected}");
    }
}

/// The string of the last test, constant along further axes: its discrete free boundary is where the first coordinate is
/// 1/4 or 3/4, and its points are vertices, half a unit apart. Stated points outside the mesh do not count, however many
/// and however far; others count as often as they are stated.
#[test]
fn stated_points_count_where_the_mesh_is() {
    fn check<const D: usize>() {
        let mut domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        domain.sides[1..].fill([BoundaryCondition::Neumann; 2]);
        let mesh = Mesh::<D>::kuhn_box(&domain, std::array::from_fn(|k| [8, 2, 2][k])).unwrap();
        let others = 3_usize.pow(D as u32 - 1);
        let sample = |k: usize| {
            let place = |axis: usize| (k % others / 3_usize.pow(axis as u32 - 1) % 3) as f64 / 2.0;
            let first = if k < others { 0.25 } else { 0.75 };
            Point::<D>::from_fn(|axis, _| if axis == 0 { first } else { place(axis) })
        };
        let discrete: Vec<Point<D>> = (0..2 * others).map(sample).collect();
        let distance = |stated: &[Point<D>]| {
            let exact = Exact::new(|_| 0.0, |_| Point::zeros());
            // a level that is constant may have its zeros in every cell
            let exact = exact.with_contact(|_| 1.0, stated.to_vec());
            let problem = Problem::new()
                .constant_source(-2.0 / 0.2_f64.powi(2))
                .dirichlet(|_| 0.0)
                .neumann(|_, _| 0.0)
                .obstacle_below(|_| -1.0)
                .solved_by(exact);
            let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
            solved.contact_errors().unwrap().free_boundary_distance
        };
        assert_eq!(distance(&discrete), Some(0.0), "{D}");
        let one_sided = |from: &[Point<D>], to: &[Point<D>]| {
            let nearest = |x: &Point<D>| to.iter().map(|y| (x - y).norm()).fold(9.0, f64::min);
            from.iter().map(nearest).fold(0.0, f64::max)
        };
        let mut random = Random::new(D as u64);
        let far = f64::INFINITY;
        for case in 0..24 {
            let mut stated: Vec<Point<D>> =
                (0..2 * case).map(|_| Point::from_fn(|_, _| 0.5 + 0.8 * random.signed())).collect();
            match case % 4 {
                // points at one place, or on a line
                1 => stated.extend([Point::repeat(0.5); 3]),
                2 => stated.iter_mut().for_each(|x| x[0] = 0.375),
                3 => {
                    stated.extend([Point::repeat(far), Point::repeat(-far)]);
                    stated.push(Point::from_fn(|axis, _| if axis == 0 { -far } else { 0.5 }));
                }
                _ => {}
            }
            let within: Vec<Point<D>> = stated
                .iter()
                .filter(|x| x.iter().all(|t| (0.0..=1.0).contains(t)))
                .copied()
                .collect();
            let expected = (!within.is_empty())
                .then(|| one_sided(&discrete, &within).max(one_sided(&within, &discrete)));
            match (distance(&stated), expected) {
                (Some(found), Some(expected)) => {
                    assert!((found - expected).abs() < 1e-12, "{D} {case}: {found} {expected}");
                }
                (found, expected) => assert_eq!(found, expected, "{D} {case}"),
            }
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}
