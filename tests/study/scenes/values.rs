//! Check values, from an independent program with symbolic derivatives.

use unilateral::mesh::BoundaryCondition;
use unilateral::real::Point;
use unilateral::scenes::{
    Scene, ball_2d, ball_3d, biactive_half_2d, biactive_ring_2d, bilateral_1d, cone, contrast,
    contrast_disc_2d, degenerate, disc_2d, hertz_2d, hertz_3d, hill, icelike_1d, lshape_2d,
    oscillating_1d, parabola_1d, polynomial, radial_quarter_2d, signorini_2d,
    signorini_biactive_2d, signorini_closed_1d, signorini_disc, signorini_halves_2d,
    signorini_harmonic, signorini_irrational_2d, signorini_layers_2d, signorini_line_3d,
    signorini_open_1d, signorini_reaction_1d, signorini_shifted_2d, signorini_smooth,
    signorini_two_2d,
};

use super::{assert_close, exact, gradient, source, value};

fn multiplier<const D: usize>(scene: &Scene<D>, x: [f64; D]) -> f64 {
    (exact(scene).multiplier.as_ref().unwrap())(&Point::from(x))
}

/// Value and load at points, to the digits printed.
fn check<const D: usize>(scene: &Scene<D>, table: &[([f64; D], f64, f64)], digits: f64) {
    for &(x, u, f) in table {
        assert_close(value(scene, x), u, digits);
        assert_close(source(scene, x), f, digits);
    }
}

#[test]
fn signorini_scenes_in_the_plane_take_their_check_values() {
    let (a, b) = ([0.3, 0.4], [-0.6, 0.2]);
    let table = [(a, 0.0483449, 0.48699076), (b, -0.14342142, -1.79012171)];
    check(&signorini_2d(), &table, 6e-9);
    let table = [(a, 0.0206388, -1.00926), (b, -0.02654208, -0.304128)];
    check(&signorini_smooth(3), &table, 6e-9);
    let table = [(a, 0.001911, -1.41925), (b, -0.0150528, -0.21792)];
    check(&signorini_biactive_2d(), &table, 6e-9);
    let halves = signorini_halves_2d();
    assert_close(value(&halves, a), 0.91 * 0.84 * 0.09, 1e-15);
    assert_close(value(&halves, b), -0.64 * 0.96 * 0.2 * 0.36, 1e-15);
    assert_close(multiplier(&halves, [-0.6, 0.0]), 0.64 * 0.36, 1e-15);
    let table = [(a, -0.22768518, -1.7533293), (b, 0.03536783, 1.72599565)];
    check(&signorini_two_2d(), &table, 6e-9);
}

#[test]
fn signorini_scenes_in_space_take_their_check_values() {
    let (a, b) = ([0.3, 0.4, 0.2], [0.1, 0.2, 0.5]);
    let table = [(a, -0.00696824, 0.30940946), (b, -0.22908205, -2.92985892)];
    check(&signorini_line_3d(), &table, 6e-9);
    // the first point lies where contact changes and the load jumps: the value from outside
    let outside = a.map(|t| t * (1.0 + 1e-12));
    check(&signorini_disc(2), &[(outside, 0.0, -2.0), (b, -0.02, -0.6)], 1e-11);
    let hertz = hertz_3d();
    check(&hertz, &[(a, 0.10185526, 0.0), (b, 0.08649823, 0.0)], 6e-9);
    for (found, expected) in
        gradient(&hertz, a).into_iter().zip([-0.09389105, -0.12518807, -0.11982264])
    {
        assert_close(found, expected, 6e-9);
    }
}

#[test]
fn the_l_shape_takes_its_check_values() {
    let table = [
        ([-0.3, 0.2], 0.46432466, 17.36169572),
        ([0.2, 0.3], 0.28538733, 10.67099909),
        ([-1.5, 0.5], 0.0, -1.0),
        ([0.0, 0.0], 0.0, 0.0),
    ];
    check(&lshape_2d(), &table, 6e-9);
}

#[test]
fn strings_take_the_values_of_their_formulas() {
    let load = |x: f64| 2.0 * (10.0 * std::f64::consts::PI).powi(2) * x;
    check(&parabola_1d(), &[([0.25], 0.5625, -2.0), ([0.5], 1.0, -2.0)], 1e-15);
    check(&icelike_1d(), &[([0.15], 0.15, -16.0), ([0.5], 0.61, 8.0)], 1e-15);
    check(&oscillating_1d(), &[([0.15], -3.0, load(-1.0)), ([0.05], 1.0, load(1.0))], 1e-10);
    let m = 0.5_f64.sqrt() * (1.0 - std::f64::consts::FRAC_PI_4);
    let force = std::f64::consts::PI.powi(2);
    check(&bilateral_1d(), &[([0.5], m, force), ([-0.5], -m, -force)], 1e-14);
    // the constants join the pieces
    for (x, inside) in [(0.038_276_475_303_830_01, 1e-9), (0.853_422_907_268_890_2, -1e-9)] {
        let scene = oscillating_1d();
        assert_close(value(&scene, [x - inside]), 1.0, 1e-13);
        assert_close(gradient(&scene, [x - inside])[0], 0.0, 1e-5);
        assert_eq!(value(&scene, [x + inside]), 1.0);
    }
}

#[test]
fn a_string_with_reaction_has_the_coefficients_of_its_conditions() {
    let scene = signorini_reaction_1d();
    assert_close(value(&scene, [-1.0]), 0.0, 1e-15);
    assert_close(multiplier(&scene, [-1.0]), 0.20725624423, 6e-12);
    assert_close(value(&scene, [1.0]), 0.27213476182, 6e-12);
    assert_close(gradient(&scene, [1.0])[0], 0.0, 1e-15);
    assert_eq!(value(&signorini_open_1d(), [1.0]), 0.5);
    assert_eq!(multiplier(&signorini_closed_1d(), [1.0]), 0.5);
}

#[test]
fn radii_of_contact_are_the_roots_of_their_equations() {
    fn transition<const D: usize>(scene: &Scene<D>) -> f64 {
        exact(scene).contact.as_ref().unwrap().free_boundary[0].norm()
    }
    let a: f64 = transition(&ball_3d());
    assert_close(2.0 * a * a - a.powi(3) / 2.0, 1.0, 1e-14);
    assert_close(value(&ball_3d(), [1.0, 0.0, 0.0]), 0.800_588_621_249_054_4 / 2.0, 1e-15);
    let a: f64 = transition(&disc_2d());
    assert_close(-a * a * a.ln(), 0.25 - a * a, 1e-15);
    let half = value(&disc_2d(), [0.6, 0.0]);
    assert_close(half, -0.340_129_705_945_858_5 * 0.6_f64.ln(), 1e-15);
    assert_eq!(value(&disc_2d(), [0.0, -1.0]), 0.0);
}

#[test]
fn membranes_take_the_values_of_their_formulas() {
    let r: f64 = 0.9;
    let s = r * r - 0.49;
    let load = |d: f64| -8.0 * r * r - 4.0 * d * s;
    check(&polynomial::<1>(), &[([r], s * s, load(1.0))], 1e-14);
    check(&polynomial::<2>(), &[([0.0, r], s * s, load(2.0))], 1e-14);
    check(&polynomial::<3>(), &[([0.0, 0.0, r], s * s, load(3.0))], 1e-14);
    let inside = -8.0 * 0.49 * (1.0 - 0.25 + 0.49);
    check(&polynomial::<2>(), &[([0.3, 0.4], 0.0, inside)], 1e-14);
    // in the ball and outside of it, 8 r0^2 - 16 r^2 in the plane
    check(&hill::<1>(), &[([0.5], 0.24 * 0.24, -1.04), ([r], 0.0, 1.96 - 12.0 * 0.81)], 1e-14);
    check(&hill::<2>(), &[([0.3, 0.4], 0.24 * 0.24, -0.08), ([0.0, r], 0.0, -9.04)], 1e-14);
    check(
        &hill::<3>(),
        &[([0.3, 0.4, 0.0], 0.24 * 0.24, 0.88), ([0.0, 0.0, r], 0.0, -10.32)],
        1e-14,
    );
    for k in [2, 3, 4] {
        let order = f64::from(k);
        let load =
            -order * (order - 1.0) * s.powi(k - 2) * 4.0 * r * r - 4.0 * order * s.powi(k - 1);
        check(&degenerate(k), &[([0.0, r], s.powi(k), load), ([0.1, 0.2], 0.0, 0.0)], 1e-13);
    }
    check(&biactive_half_2d(), &[([0.5, 0.1], 0.0625, -3.0), ([-0.5, 0.1], 0.0, 0.0)], 1e-15);
    let s: f64 = 0.25 - 0.13;
    let load = -256.0 * 8.0 * s * s * ((6.0 * 0.04 - s) + (6.0 * 0.09 - s));
    let table =
        [([0.2, 0.3], 256.0 * s.powi(4), load), ([0.6, 0.3], 0.0, 0.0), ([0.9, 0.3], 0.0, -1.0)];
    check(&biactive_ring_2d(), &table, 1e-12);
    let r: f64 = 0.8;
    let in_plane = -0.5 * r.ln() + 0.5 * (std::f64::consts::E / 2.0).ln();
    check(&cone::<2>(), &[([r, 0.0], in_plane, 0.0), ([0.3, 0.4], 0.5, 0.0)], 1e-15);
    check(&cone::<3>(), &[([r, 0.0, 0.0], 1.0 / (4.0 * r), 0.0)], 1e-15);
    assert_close(multiplier(&cone::<3>(), [0.0, 0.0, 0.25]), 8.0, 1e-14);
    check(&radial_quarter_2d(), &[([1.2, 0.5], 1.69 / 2.0 - 1.3_f64.ln() - 0.5, -2.0)], 1e-15);
}

#[test]
fn membranes_of_two_materials_take_the_values_of_their_formulas() {
    let a1 = 10.0;
    let table = [([0.4, 0.3], 0.0225 / (2.0 * a1), -1.0)];
    check(&contrast::<2>(a1), &table, 1e-15);
    let outer = 0.0625 / (2.0 * a1) + (0.5625 - 0.0625) / 2.0;
    check(&contrast::<1>(a1), &[([1.0], outer, -1.0)], 1e-15);
    let inner = |r: f64| (r * r / 2.0 - r.ln() / 4.0 - 0.125 + 0.5_f64.ln() / 4.0) / a1;
    let r: f64 = 1.3;
    let outer = inner(1.0) + ((r * r - 1.0) / 2.0 - r.ln() / 4.0);
    let table = [([0.0, 0.8], inner(0.8), -2.0), ([0.5, 1.2], outer, -2.0)];
    check(&contrast_disc_2d(a1), &table, 1e-15);
    let m = 0.5 / a1 + 0.25;
    let table = [([-0.5, 0.75], -m * 0.125, 3.0 * m), ([0.5, 0.25], 0.125, -a1 * 3.0)];
    check(&signorini_layers_2d(a1), &table, 1e-14);
}

/// The table of scenes: for which `s` solutions lie in `H^s`, and whether there is contact without
/// force.
#[test]
fn regularity_is_that_of_the_derivations() {
    fn stated<const D: usize>(scene: Scene<D>, sobolev: f64, strictly: bool) {
        let found = (scene.regularity.sobolev, scene.regularity.strictly_complementary);
        assert_eq!(found, (sobolev, strictly), "{}", scene.name);
    }
    stated(ball_2d(), 2.5, true);
    stated(hill::<2>(), 2.5, true);
    stated(cone::<2>(), 2.0, true);
    stated(cone::<3>(), 2.5, true);
    stated(lshape_2d(), 5.0 / 3.0, false);
    stated(biactive_half_2d(), 4.5, false);
    stated(degenerate(3), 3.5, false);
    stated(signorini_smooth(4), 4.5, true);
    stated(signorini_biactive_2d(), 2.5, false);
    stated(hertz_3d(), 2.5, true);
}

#[test]
fn contact_changes_where_the_name_says() {
    for (scene, expected) in [
        (signorini_2d(), vec![0.0]),
        (signorini_shifted_2d(), vec![0.3]),
        (signorini_irrational_2d(), vec![2.0_f64.sqrt() / 10.0]),
        (signorini_two_2d(), vec![-0.4, 0.5]),
        (hertz_2d(), vec![-0.5, 0.5]),
        (signorini_harmonic::<2>(), vec![0.0]),
    ] {
        assert_eq!(scene.domain.bounding_box().sides[1][0], BoundaryCondition::Contact);
        let contact = exact(&scene).contact.as_ref().unwrap();
        let found: Vec<f64> = contact.free_boundary.iter().map(|x| x[0]).collect();
        for (found, expected) in found.iter().zip(&expected) {
            assert_close(*found, *expected, 1e-15);
        }
        assert_eq!(found.len(), expected.len(), "{}", scene.name);
        for x in found {
            let side = |x: f64| (contact.indicator)(&Point::from([x, 0.0]));
            assert!(side(x - 1e-3) * side(x + 1e-3) < 0.0, "{} at {x}", scene.name);
        }
    }
}
