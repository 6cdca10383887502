//! Contact forces under over-penalty: the same in both precisions and for every weight, or none.

use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::{Scene, hertz_2d, signorini_2d, torsion_2d};
use unilateral::study::Row;

const SCENES: [fn() -> Scene<2>; 5] = [
    || scenes::radial::<2>(1.0),
    hertz_2d,
    signorini_2d,
    scenes::polynomial::<2>,
    || scenes::contrast::<2>(1e6),
];

fn rows(
    precision: Precision,
    scene: Scene<2>,
    (scheme, on_means): (Wopsip, bool),
    levels: &[usize],
) -> Vec<Row> {
    let study = Study::<2>::new(scene).levels(levels.iter().copied());
    let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
    let study = match on_means {
        true => study.scheme_on(scheme, FacetMeans),
        false => study.scheme(scheme),
    };
    let rows = study.run().unwrap().rows;
    for row in &rows {
        assert!(row.converged(), "{} {}: {}", row.scene, row.level, row.status);
    }
    rows
}

fn near(found: Option<f64>, right: Option<f64>, share: f64, what: &str) {
    let (found, right) = (found.unwrap(), right.unwrap());
    assert!((found - right).abs() <= share * right.abs(), "{what}: {found} for {right}");
}

/// The forces of a row are null, with a warning.
fn is_left_out(row: &Row, what: &str) {
    assert_eq!(row.resultant, None, "{what}");
    assert_eq!([row.contact.multiplier_l1, row.contact.multiplier_l2], [None; 2], "{what}");
    let is_told = |warning: &String| warning.contains("no digit of the contact forces");
    assert!(row.warnings.iter().any(is_told), "{what}: {:?}", row.warnings);
}

/// Multipliers of jumps from differences of single precision values have no digit here: 4.1 was found for the resultant
/// 6.28 of radial-2d at level 256, and 2.19 for the error 0.008 of its multiplier.
fn single_precision(levels: &[usize]) {
    for scene in SCENES {
        for on_means in [false, true] {
            let scheme = (Wopsip::default(), on_means);
            let of = |precision| rows(precision, scene(), scheme, levels);
            let [single, double] = [of(Precision::Single), of(Precision::Double)];
            for (single, double) in single.iter().zip(&double) {
                let what = format!("{} {} {}", single.scene, single.label, single.level);
                if double.scene == "contrast-2d" {
                    // the energy of the stiff half hides the forces on the other one from the certificate of `f32`
                    is_left_out(single, &what);
                    continue;
                }
                near(single.resultant, double.resultant, 0.01, &format!("{what}, resultant"));
                let [found, right] = [single, double].map(|row| row.contact.multiplier_l1);
                // within the certificate of `f32` one more unknown is active at an end of contact of hertz-2d, and forces
                // there are a fifth of the error on the finest mesh of signorini-2d
                let is_fine = double.scene == "signorini-2d" && double.level >= 256;
                let has_other_end = (double.scene == "hertz-2d" || is_fine) && !on_means;
                let share = if has_other_end { 0.3 } else { 0.1 };
                near(found, right, share, &format!("{what}, multiplier"));
            }
        }
    }
}

#[test]
fn forces_in_single_precision_are_those_in_double_precision() {
    single_precision(&[64]);
}

#[test]
#[ignore = "takes minutes"]
fn forces_in_single_precision_are_those_in_double_precision_on_fine_meshes() {
    single_precision(&[32, 128, 256]);
}

/// At 1e14 the resultant of hertz-2d was -0.49 for 0.392.
#[test]
fn forces_do_not_depend_on_a_large_weight() {
    for scene in SCENES {
        for on_means in [false, true] {
            let of = |eta: f64| {
                let scheme = Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() };
                rows(Precision::Double, scene(), (scheme, on_means), &[32]).remove(0)
            };
            let right = of(1e5);
            for eta in [1e9, 1e12, 1e14] {
                let found = of(eta);
                let what = format!("{} {} {eta:e}", found.scene, found.label);
                near(found.resultant, right.resultant, 0.01, &format!("{what}, resultant"));
                let [l1, of_right] = [&found, &right].map(|row| row.contact.multiplier_l1);
                near(l1, of_right, 0.1, &format!("{what}, multiplier"));
            }
        }
    }
}

/// On the boundary of torsion-2d the obstacle equals the Dirichlet datum: unknowns there carry the flux through the
/// boundary, with which the resultant would be the whole load, -5.
#[test]
fn the_flux_through_weakly_imposed_data_is_no_contact_force() {
    let study = Study::<2>::new(torsion_2d(5.0)).levels([32]);
    let study = study.scheme(ConformingP1).scheme(NonconformingP1).scheme(Sipg::default());
    let study = study.scheme(Wopsip::default()).scheme_on(Wopsip::default(), FacetMeans);
    let rows = study.run().unwrap().rows;
    let [p1, cr, sipg, at_vertices, on_means] = &rows[..] else { panic!("{} rows", rows.len()) };
    near(sipg.resultant, p1.resultant, 0.01, "sipg against p1");
    near(at_vertices.resultant, p1.resultant, 0.01, "wopsip against p1");
    near(on_means.resultant, cr.resultant, 0.01, "facet means against cr");
}

/// With a contrast of 1e12 forces of two solvers, whose certificates are within their limits, differ by half a per cent: the
/// rows say that rounding may do so.
#[test]
fn forces_that_rounding_changes_have_a_warning() {
    let warnings = |contrast: f64| {
        let scheme: NamedScheme = "ldg-switch-p2".parse().unwrap();
        let study = Study::<1>::new(scenes::contrast(contrast)).named_scheme(&scheme);
        let mut rows = study.levels([4]).run().unwrap().rows;
        assert!(rows[0].converged());
        rows.remove(0).warnings
    };
    let is_told = |warning: &String| warning.contains("rounding changes contact forces by up to");
    assert!(warnings(1e12).iter().any(is_told));
    assert!(!warnings(1e6).iter().any(is_told));
}
