//! Interior penalty across its threshold of coercivity, by inertia.

use crate::inequality::Outcome;
use crate::kit::spectrum::negative_eigenvalues;
use crate::stability::table::*;

const INERTIA: Criterion = Criterion::new(
    "inertia",
    &[ExpectedRange::at_most(0.0)],
    "Interior penalty sigma/h_F on the unit square, threshold sigma = 3: the number of negative eigenvalues, counted by the pivots of a factorisation, is at most 0. Below the threshold there are some, whatever the size of the error.",
);
const REFUSED: Criterion = Criterion::new(
    "refused-or-warned",
    &[ExpectedRange::at_least(1.0), ExpectedRange::at_most(0.0)],
    "A penalty below its proven bound is not accepted silently. The figure is one if the library refuses to solve or warns: at least 1 below the bound, at most 0 from the bound on.",
);
const ERROR: Criterion = Criterion::new(
    "error-of-interior-penalty",
    &[ExpectedRange::at_most(1.25)],
    "With interior penalty sigma/h_F from the proven bound on, the broken H1 error is at most 1.25 times that of Crouzeix-Raviart elements. Between the threshold and the bound the matrix is definite by little, and the error is known to be larger.",
);
pub(crate) const CASE: Case =
    Case { name: "coercivity", criteria: &[INERTIA, REFUSED, ERROR], sweeps };

/// The factor below which `sigma/h_F` is indefinite on right isosceles triangles.
const THRESHOLD: f64 = 3.0;

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let level = study.effort.pick(8, 16);
    let factors = ["0.5", "1", "2", "2.9", "3.1", "4", "10", "1000"];
    let with_sigma = schemes(&factors.map(|sigma| format!("sipg@sigma={sigma}")).join(" "));
    // on Dirichlet facets |dK|/|K| with |dK| = (2 + root 2) h and |K| = h^2 / 2
    let proven = 2.0 * (2.0 + 2.0_f64.sqrt());
    let is_below = |at: &At<'_>, bound: f64| at.value().is_some_and(|sigma| sigma < bound);
    let is_told = |at: &At<'_>| {
        let row = at.rows().first()?;
        let is_told = row.status == Outcome::NotCoercive || !row.warnings.is_empty();
        Some(f64::from(u8::from(is_told)))
    };
    Ok(vec![
        Sweep {
            compares: true,
            schemes: with_sigma.clone(),
            parameter: "sigma",
            places: Place::levels("sines-2d", &[level]),
            columns: vec![
                Column::new(&INERTIA, "negative eigenvalues", |at| {
                    negative_eigenvalues(&at.matrix(None)?).map(|n| n as f64)
                })
                .asked(move |at| Asked::limit_unless(is_below(at, THRESHOLD))),
            ],
            ..Sweep::default()
        },
        Sweep {
            schemes: with_sigma.clone(),
            beside: schemes("cr"),
            parameter: "sigma",
            places: Place::levels("radial-2d", &[2 * level]),
            columns: vec![
                Column::new(&ERROR, "H1 error over that of cr", |at| at.over("cr", H1))
                    .asked(move |at| Asked::limit_unless(is_below(at, proven))),
                Column::new(&REFUSED, "refused to solve, or warned", is_told)
                    .asked(move |at| Asked::Limit(usize::from(!is_below(at, proven)))),
            ],
            ..Sweep::default()
        },
    ])
}
