//! Agreement with an independent implementation, whose figures are in `tests/data/reference.json`.

use serde_json::Value;
use unilateral::prelude::*;
use unilateral::study::Row;

/// Figures of the independent implementation.
const FIGURES: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/reference.json"));

fn close(what: &str, row: &Row, ours: f64, theirs: f64, tolerance: f64) {
    assert!(
        (ours - theirs).abs() <= tolerance * theirs.abs(),
        "{what} of {} on {} at level {}: {ours:e} against {theirs:e}",
        row.scheme,
        row.scene,
        row.level
    );
}

fn check(row: &Row, reference: &Value) {
    let number = |key: &str| reference[key].as_f64().expect(key);
    assert_eq!(row.unknowns.unwrap() as f64, number("unknowns"));
    assert!(row.converged());
    close("L2 error", row, row.error.l2.unwrap(), number("error_l2"), 1e-4);
    close("H1 error", row, row.error.h1.unwrap(), number("error_h1"), 1e-4);
    // half a per cent of the count, and never more than rounding to a whole number allows
    close("active count", row, row.active.unwrap() as f64, number("active"), 0.005);
    close("objective", row, row.objective.unwrap(), number("objective"), 1e-8);
    assert!(row.certificate.largest() < 1e-9, "{:?}", row.certificate);
}

/// Runs the scheme of a reference row; none for schemes that are not here.
fn scheme(reference: &Value) -> Option<Box<dyn Scheme<2>>> {
    let eta = || Eta::Absolute(reference["eta"].as_f64().unwrap());
    Some(match reference["scheme"].as_str()? {
        "p1" => Box::new(ConformingP1),
        "cr" => Box::new(NonconformingP1),
        "sipg" => {
            let sigma = reference["sigma"].as_f64().unwrap();
            Box::new(Sipg { penalty: PenaltyRule::Diameter(sigma) })
        }
        "wopsip" => Box::new(Wopsip { eta: eta(), weight: WeightRule::Isotropic }),
        _ => return None,
    })
}

fn check_scene(name: &str, build: fn() -> scenes::Scene<2>) {
    let file: Value = serde_json::from_str(FIGURES).unwrap();
    let mut checked = 0;
    for reference in file["rows"].as_array().unwrap() {
        if reference["scene"] != name {
            continue;
        }
        let Some(scheme) = scheme(reference) else { continue };
        let level = reference["level"].as_u64().unwrap() as usize;
        let report = Study::<2>::new(build()).boxed_scheme(scheme).levels([level]).run().unwrap();
        check(&report.rows[0], reference);
        checked += 1;
    }
    assert_eq!(checked, 15, "p1, cr, sipg, wopsip with two factors, on three levels");
}

#[test]
fn radial_obstacle() {
    check_scene("radial-2d", || scenes::radial(1.0));
}

#[test]
fn harmonic_signorini() {
    check_scene("signorini-harmonic-2d", scenes::signorini_harmonic);
}
