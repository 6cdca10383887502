//! Contact forces on a body that contact alone holds balance its load, or a warning says that they do not.

use super::run::{Scratch, data, read_json, rows};

/// The load that presses the body down: two regions with constant sources.
const LOAD: f64 = 0.493411;

/// Coefficients 1 and 1e-16: certificates are relative to the energy, in which the stiff region is nothing.
#[test]
fn forces_on_a_body_of_large_contrast_balance_its_load_or_a_warning_says_so() {
    let scratch = Scratch::new("contrast-forces");
    let options =
        "--scheme p1,p2,cr,sipg,wopsip,wopsip:facet-means,nipg,ldg --levels 0,1,2 --quiet";
    scratch.run(&format!("{} {options}", data("contrast_forces")));
    let report = read_json(&scratch.0.join("out/report.json"));
    let mut n_balanced = 0;
    assert_eq!(rows(&report).len(), 24);
    for row in rows(&report).iter().filter(|row| row["status"] == "converged") {
        let resultant = row["resultant"].as_f64();
        let warnings = row["warnings"].to_string();
        let is_balanced = resultant.is_some_and(|found| (found - LOAD).abs() < 2e-6 * LOAD);
        let is_told = warnings.contains(match resultant {
            Some(_) => "contact forces on a body that contact alone holds differ",
            None => "no digit of the contact forces",
        });
        assert_ne!(is_balanced, is_told, "{} {}: {resultant:?}", row["label"], row["level"]);
        n_balanced += usize::from(is_balanced);
    }
    assert!(n_balanced > 0);
}
