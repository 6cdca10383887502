//! A string below a ceiling under a load of high frequency: a table of a paper.

use crate::support::accuracy::Checks;
use unilateral::assemble::DataQuadrature;
use unilateral::prelude::*;
use unilateral::study::Study;

/// Full H1 norms of the error by number of unknowns, of which the ends are none: those printed in
/// I. P. A. Papadopoulos, Hierarchical proximal Galerkin, arXiv 2412.13733, and those of an
/// independent program. The paper measures against an interpolated solution, which shows on coarse
/// meshes: from 5119 unknowns on its figures are ours but for some units of the last digit.
#[test]
fn linear_elements_under_a_load_of_high_frequency() {
    let cases = [
        (9, 47.724_367, "43.468608"),
        (19, 19.757_610, "19.137493"),
        (79, 4.952_869, "4.944987"),
        (319, 1.240_057, "1.239936"),
        (1279, 0.310_143, "0.310135"),
        (5119, 0.077_537_4, "0.077537"),
        (20479, 0.019_384_5, "0.019384"),
        (40959, 0.009_692_21, "0.009692"),
    ];
    let rows = Study::<f64, 1>::new(scenes::oscillating_1d())
        .scheme(ConformingP1)
        .levels(cases.map(|(unknowns, ..)| unknowns + 1))
        .quadrature(DataQuadrature { cell: 29, ..DataQuadrature::default() })
        .run()
        .unwrap()
        .rows;
    let mut checks = Checks::default();
    for (row, (unknowns, paper, printed)) in rows.iter().zip(cases) {
        checks.certified(row, 1e-9);
        let [l2, h1] = [row.error.l2, row.error.h1].map(Option::unwrap);
        let ours = l2.hypot(h1);
        eprintln!("{unknowns} {ours:.8} paper {:.2e}", ours / paper - 1.0);
        checks.printed(&format!("{unknowns} unknowns"), ours, printed, 0.5);
    }
    checks.finish();
}
