//! A string below a ceiling under a load of high frequency: a table of a paper.

use crate::support::checks::Checks;
use crate::support::tables::{norms_by_rule, solve_by_rule};
use unilateral::inequality::Outcome;
use unilateral::prelude::*;

/// A row: unknowns, which the ends are not; the norm in the paper and the relative distance within
/// which ours agrees, where it does; the norm by an independent program.
type Row<'a> = (usize, Option<(f64, f64)>, &'a str);

/// Full H1 norms of the error, in I. P. A. Papadopoulos, Hierarchical proximal Galerkin, arXiv
/// 2412.13733, and by an independent program with twelve points of Gauss on each cell, whose last
/// digits are those of this rule (exact are 43.469565, 19.139569, 4.945136 in the first rows). The
/// paper measures against an interpolated solution, which shows on coarse meshes by a share of the
/// order of the mesh size.
#[test]
fn linear_elements_under_a_load_of_high_frequency() {
    let cases: [Row<'_>; 8] = [
        (9, None, "43.468608"),
        (19, None, "19.137493"),
        (79, Some((4.952_869, 2e-3)), "4.944987"),
        (319, Some((1.240_057, 2e-4)), "1.239936"),
        (1279, Some((0.310_143, 3e-5)), "0.310135"),
        (5119, Some((0.077_537_4, 1e-5)), "0.077537"),
        (20479, Some((0.019_384_5, 5e-6)), "0.019384"),
        (40959, Some((0.009_692_21, 5e-6)), "0.009692"),
    ];
    let scene = scenes::oscillating_1d();
    let mut checks = Checks::default();
    for (unknowns, paper, printed) in cases {
        let (mesh, solved) = solve_by_rule(&scene, &ConformingP1, unknowns + 1, 23);
        let what = format!("{unknowns} unknowns");
        checks.that(solved.outcome == Outcome::Converged, || what.clone());
        let [l2, h1] = norms_by_rule(&scene, &mesh, &solved.fields.unwrap().u, 23);
        let ours = l2.hypot(h1);
        checks.printed(&what, ours, printed, 0.5);
        if let Some((theirs, share)) = paper {
            println!("{what}: {ours:.7e}, in the paper {theirs:.6e}");
            checks.close(&format!("{what} in the paper"), ours, theirs, share * theirs);
        }
    }
    checks.finish();
}
