//! Figures in print, and tables of an independent implementation.

mod support;

use nalgebra::Complex;
use support::accuracy::{
    Boxed, Checks, jump_norm, norms_as_tables, own_scene, sipg, solve_as_tables, wopsip,
};
use unilateral::algebra::Contact;
use unilateral::assemble::DataQuadrature;
use unilateral::prelude::*;
use unilateral::scenes::{BoxDomain, Scene};
use unilateral::solve::{ActiveSet, InequalitySolver, Outcome};

/// The obstacle problem of PETSc's `snes/tutorials/ex9` (Bueler, *PETSc for Partial Differential
/// Equations*, chapter 12): five-point differences on `N x N` points, which are conforming linear
/// elements on triangles with a right angle. Mean and maximum of the error over all points, points
/// in contact. Up to 33 the errors are PETSc's own, beyond those of an independent program.
#[test]
fn ball_obstacle_of_petsc() {
    let cases = [
        (5, "4.531e-2", "1.635e-1", 1),
        (9, "3.076e-3", "1.334e-2", 9),
        (17, "2.707e-3", "1.428e-2", 29),
        (33, "8.182e-4", "5.747e-3", 109),
        (65, "9.818e-5", "5.991e-4", 421),
        (129, "3.334e-5", "2.154e-4", 1609),
    ];
    let scene = scenes::ball_2d();
    let exact = scene.problem.exact.as_ref().unwrap();
    let mut checks = Checks::default();
    for (points, mean, max, active) in cases {
        let mesh = scene.domain.mesh::<f64>(points - 1).unwrap();
        let inequality =
            ConformingP1.inequality(&scene.problem, &mesh, DataQuadrature::default()).unwrap();
        let solution = ActiveSet::default().solve(&inequality);
        assert_eq!(solution.outcome, Outcome::Converged);
        let nodes = mesh.vertices().iter().zip(&solution.values);
        let errors: Vec<f64> = nodes.map(|(x, u)| (u - (exact.value)(x)).abs()).collect();
        let ours = errors.iter().sum::<f64>() / errors.len() as f64;
        checks.printed(&format!("N = {points}, mean"), ours, mean, 0.5);
        let ours = errors.iter().copied().fold(0.0, f64::max);
        checks.printed(&format!("N = {points}, max"), ours, max, 0.5);
        let ours = solution.contact.iter().filter(|c| **c == Contact::Lower).count();
        checks.that(ours == active, || format!("N = {points}: {ours} in contact, not {active}"));
        // the error of the area of contact, printed for two of the meshes
        let disc = std::f64::consts::PI * 0.697_965_148_223_373_6_f64.powi(2);
        let area = 16.0 / ((points - 1) * (points - 1)) as f64 * ours as f64;
        match points {
            9 => checks.printed("area for N = 9", (area - disc) / disc, "0.47016", 0.5),
            17 => checks.printed("area for N = 17", (area - disc) / disc, "0.18430", 0.5),
            _ => {}
        }
    }
    checks.finish();
}

/// Rows of a table: subdivisions of the longest side, then for each scheme L2, H1 and, where
/// printed, the norm of the jumps.
type Table<'a> = &'a [(&'a str, &'a [(usize, &'a str)])];

/// The scheme of a column.
fn column<const D: usize>(name: &str) -> Boxed<f64, D> {
    match name {
        "p1" => Box::new(ConformingP1),
        "cr" => Box::new(CrouzeixRaviartScheme),
        "wopsip 1" => Box::new(wopsip(1.0)),
        "wopsip 10" => Box::new(wopsip(10.0)),
        "sipg 4" => Box::new(sipg(4.0)),
        "sipg 10" => Box::new(sipg(10.0)),
        "sipg 20" => Box::new(sipg(20.0)),
        _ => unreachable!("no column {name}"),
    }
}

/// Compares every figure of a table with ours, to its last digit.
fn compare<const D: usize>(build: impl Fn(usize) -> Scene<D>, table: Table<'_>) {
    let mut checks = Checks::default();
    for (name, rows) in table {
        for (n, figures) in *rows {
            let domain = build(*n).domain.bounding_box();
            let sides = domain.upper - domain.lower;
            let level = n * sides.min() as usize / sides.max() as usize;
            let scene = build(level);
            let (mesh, solved) = solve_as_tables(&scene, &*column(name), level);
            let what = format!("{name} on {}, n = {n}", scene.name);
            let (outcome, found) = (solved.outcome, solved.certificate.largest());
            checks.that(outcome == Outcome::Converged && found < 1e-9, || {
                format!("{what}: {outcome}, certificate {found:e}")
            });
            let [l2, h1] = norms_as_tables(&scene, &mesh, &solved.fields.unwrap().u);
            let [own_h1, energy] = [solved.error.h1, solved.error.energy].map(Option::unwrap);
            let ours = [("L2", l2), ("H1", h1), ("jump", jump_norm(energy, own_h1))];
            for ((norm, ours), printed) in ours.into_iter().zip(figures.split(" / ")) {
                checks.printed(&format!("{norm} of {what}"), ours, printed, 0.5);
            }
        }
    }
    checks.finish();
}

#[test]
fn radial_obstacle_in_the_plane() {
    compare(
        |_| scenes::radial::<2>(1.0),
        &[
            (
                "p1",
                &[
                    (8, "5.0045e-2 / 4.4214e-1"),
                    (16, "1.3673e-2 / 2.2654e-1"),
                    (32, "3.3701e-3 / 1.1344e-1"),
                    (64, "8.6780e-4 / 5.7004e-2"),
                    (128, "2.0768e-4 / 2.8547e-2"),
                ],
            ),
            (
                "cr",
                &[
                    (8, "2.7987e-2 / 3.7401e-1"),
                    (16, "7.4535e-3 / 1.9522e-1"),
                    (32, "1.9078e-3 / 9.8545e-2"),
                    (64, "4.8619e-4 / 4.9706e-2"),
                    (128, "1.2226e-4 / 2.4920e-2"),
                ],
            ),
            (
                "wopsip 1",
                &[
                    (8, "9.6242e-2 / 6.7496e-1 / 9.8128e-1"),
                    (16, "2.5256e-2 / 2.7074e-1 / 5.7249e-1"),
                    (32, "6.4199e-3 / 1.1052e-1 / 3.0087e-1"),
                    (64, "1.5979e-3 / 5.1208e-2 / 1.5169e-1"),
                ],
            ),
            (
                "sipg 10",
                &[
                    (8, "3.0174e-2 / 4.0921e-1"),
                    (16, "8.9829e-3 / 2.0757e-1"),
                    (32, "2.2134e-3 / 1.0281e-1"),
                    (64, "5.7989e-4 / 5.1383e-2"),
                ],
            ),
        ],
    );
}

#[test]
fn ball_obstacle_in_the_plane() {
    compare(
        |_| scenes::ball_2d(),
        &[
            (
                "p1",
                &[
                    (16, "2.7487e-2 / 2.6424e-1"),
                    (32, "7.1672e-3 / 1.3469e-1"),
                    (64, "1.4354e-3 / 6.8163e-2"),
                ],
            ),
            (
                "cr",
                &[
                    (16, "1.5525e-2 / 2.3990e-1"),
                    (32, "3.9568e-3 / 1.2440e-1"),
                    (64, "1.1257e-3 / 6.3981e-2"),
                ],
            ),
            (
                "wopsip 1",
                &[
                    (16, "3.6305e-2 / 4.1051e-1 / 6.4717e-1"),
                    (32, "1.0586e-2 / 1.6565e-1 / 3.9157e-1"),
                    (64, "2.9768e-3 / 7.2931e-2 / 2.0844e-1"),
                ],
            ),
            (
                "sipg 10",
                &[
                    (16, "2.7935e-2 / 2.4676e-1"),
                    (32, "7.1124e-3 / 1.2404e-1"),
                    (64, "1.4484e-3 / 6.2508e-2"),
                ],
            ),
        ],
    );
}

#[test]
fn signorini_with_zero_data_in_the_plane() {
    compare(
        |_| scenes::signorini_2d(),
        &[
            (
                "p1",
                &[
                    (16, "7.5403e-3 / 1.7824e-1"),
                    (32, "1.9106e-3 / 8.9629e-2"),
                    (64, "4.7980e-4 / 4.4891e-2"),
                    (128, "1.2015e-4 / 2.2459e-2"),
                ],
            ),
            (
                "cr",
                &[
                    (16, "6.0387e-3 / 1.7856e-1"),
                    (32, "1.5263e-3 / 8.9770e-2"),
                    (64, "3.8278e-4 / 4.4959e-2"),
                    (128, "9.5791e-5 / 2.2492e-2"),
                ],
            ),
            (
                "wopsip 1",
                &[
                    (16, "1.5252e-2 / 1.8010e-1 / 2.3065e-1"),
                    (32, "3.7924e-3 / 9.0014e-2 / 1.1374e-1"),
                    (64, "9.4674e-4 / 4.5008e-2 / 5.6356e-2"),
                    (128, "2.3662e-4 / 2.2504e-2 / 2.8032e-2"),
                ],
            ),
            (
                "sipg 10",
                &[
                    (16, "5.3831e-3 / 1.5950e-1"),
                    (32, "1.4316e-3 / 7.9881e-2"),
                    (64, "3.6827e-4 / 3.9914e-2"),
                    (128, "9.3328e-5 / 1.9942e-2"),
                ],
            ),
        ],
    );
}

#[test]
fn hertz_contact_in_the_plane() {
    compare(
        |_| scenes::hertz_2d(),
        &[
            (
                "p1",
                &[
                    (16, "8.1022e-4 / 3.6437e-2"),
                    (32, "2.0855e-4 / 1.8654e-2"),
                    (64, "5.2887e-5 / 9.4355e-3"),
                    (128, "1.3316e-5 / 4.7450e-3"),
                ],
            ),
            (
                "wopsip 1",
                &[
                    (16, "1.4995e-3 / 3.9417e-2 / 5.5934e-2"),
                    (32, "4.5867e-4 / 1.9197e-2 / 3.0464e-2"),
                    (64, "1.2822e-4 / 9.4997e-3 / 1.5649e-2"),
                    (128, "3.4081e-5 / 4.7495e-3 / 7.8884e-3"),
                ],
            ),
            (
                "sipg 10",
                &[
                    (16, "6.4125e-4 / 3.2029e-2"),
                    (32, "1.5968e-4 / 1.6067e-2"),
                    (64, "3.9835e-5 / 8.0153e-3"),
                    (128, "9.9390e-6 / 3.9966e-3"),
                ],
            ),
        ],
    );
}

/// The table's bound on a facet mean is the gap at the barycentre, ours the mean of the gap: a gap
/// that is constant on each facet makes them the same.
#[test]
fn hertz_contact_of_facet_means_in_the_plane() {
    let stepped = |level: usize| {
        let n = level as f64;
        let mut scene = scenes::hertz_2d();
        scene.problem = scene.problem.signorini(move |x| {
            let middle = ((x[0] * n).floor() + 0.5) / n;
            -middle * middle / 2.0
        });
        scene
    };
    compare(
        stepped,
        &[(
            "cr",
            &[
                (16, "1.4834e-3 / 3.6184e-2"),
                (32, "3.8667e-4 / 1.8584e-2"),
                (64, "9.8547e-5 / 9.4093e-3"),
                (128, "2.4865e-5 / 4.7333e-3"),
            ],
        )],
    );
}

#[test]
fn radial_obstacle_in_space() {
    compare(
        |_| scenes::radial::<3>(1.0),
        &[
            (
                "p1",
                &[
                    (4, "4.4772e-1 / 1.3871"),
                    (8, "1.0617e-1 / 7.1001e-1"),
                    (16, "2.7701e-2 / 3.5939e-1"),
                ],
            ),
            (
                "cr",
                &[
                    (4, "1.3424e-1 / 1.0024"),
                    (8, "3.4998e-2 / 5.0967e-1"),
                    (16, "8.9024e-3 / 2.5761e-1"),
                ],
            ),
            ("wopsip 10", &[(4, "2.9948e-1 / 1.8675"), (8, "8.4869e-2 / 7.3280e-1")]),
            ("sipg 20", &[(4, "2.2219e-1 / 1.3386"), (8, "5.1733e-2 / 6.3660e-1")]),
        ],
    );
}

/// `u = (1 - x^2)(1 - y^2)(1 - z^2) Re (x - 1/5 + iz)^{3/2}`: the line on which contact changes is
/// not a union of edges.
fn signorini_line() -> Scene<3> {
    let power = |x: &Point<f64, 3>| {
        let root = Complex::new(x[0] - 0.2, x[2]).sqrt();
        (root * root * root, root * 1.5)
    };
    let value = move |x: &Point<f64, 3>| {
        let q: f64 = x.iter().map(|t| 1.0 - t * t).product();
        q * power(x).0.re
    };
    let parts = move |x: &Point<f64, 3>| {
        let [a, b, c] = [0, 1, 2].map(|k| 1.0 - x[k] * x[k]);
        let slope =
            Point::<f64, 3>::new(-2.0 * x[0] * b * c, -2.0 * x[1] * a * c, -2.0 * x[2] * a * b);
        let (w, derivative) = power(x);
        let steepness = Point::<f64, 3>::new(derivative.re, 0.0, -derivative.im);
        (a * b * c, slope, -2.0 * (b * c + a * c + a * b), w.re, steepness)
    };
    let gradient = move |x: &Point<f64, 3>| {
        let (q, slope, _, w, steepness) = parts(x);
        slope * w + steepness * q
    };
    let load = move |x: &Point<f64, 3>| {
        let (_, slope, laplacian, w, steepness) = parts(x);
        -(w * laplacian + 2.0 * slope.dot(&steepness))
    };
    let problem = Problem::new().source(load).signorini(|_| 0.0).exact(value, gradient);
    let near = |ours: f64, theirs: f64| assert!((ours - theirs).abs() < 5e-9, "{ours} {theirs}");
    for (x, u, f) in [
        (Point::<f64, 3>::new(0.3, 0.4, 0.2), -0.006_968_24, 0.309_409_46),
        (Point::<f64, 3>::new(0.1, 0.2, 0.5), -0.229_082_05, -2.929_858_92),
    ] {
        near(value(&x), u);
        near(load(&x), f);
    }
    own_scene("signorini-line-3d", BoxDomain::above_contact(), problem)
}

#[test]
fn signorini_in_space() {
    compare(
        |_| signorini_line(),
        &[
            (
                "p1",
                &[
                    (4, "1.3089e-1 / 8.1047e-1"),
                    (8, "3.9790e-2 / 4.4653e-1"),
                    (16, "1.0554e-2 / 2.2919e-1"),
                ],
            ),
            ("wopsip 10", &[(4, "1.3382e-1 / 6.8487e-1"), (8, "3.3598e-2 / 3.5527e-1")]),
            ("sipg 20", &[(4, "7.3183e-2 / 6.7373e-1"), (8, "2.3772e-2 / 3.6564e-1")]),
        ],
    );
}
