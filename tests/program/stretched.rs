//! Cells a thousand times as long as high.

use super::run::{Scratch, data, number, rows};

/// The means of Crouzeix-Raviart and over-penalised functions are a bad conforming function there: the bound takes the
/// conforming solution beside their flux.
#[test]
fn bounds_of_broken_linears_stay_near_their_errors() {
    let scratch = Scratch::new("stretched");
    let schemes = "--scheme cr,wopsip@weight=anisotropic --levels 0,1 --reference p2@level=3";
    let report = scratch.report(&format!("{} {schemes} --no-fields", data("stretched")));
    for row in rows(&report) {
        assert_eq!(row["status"], "converged");
        let effectivity = number(row, &["bound", "effectivity"]);
        assert!((1.0..7.0).contains(&effectivity), "{}: {effectivity}", row["label"]);
    }
}
