//! Tables of an independent implementation, compared figure by figure.

use crate::support::checks::{Checks, figure};
use crate::support::schemes::{Boxed, sipg, wopsip};
use crate::support::tables::{norms_by_rule, solve_by_rule};
use unilateral::inequality::Outcome;
use unilateral::measure::Errors;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::scenes::Scene;

/// Rows of a table: subdivisions of the longest side, then for each scheme L2, H1 and, where
/// printed, the norm of the jumps.
pub type Table<'a> = &'a [(&'a str, &'a [(usize, &'a str)])];

/// The scheme of a column.
pub fn column<const D: usize>(name: &str) -> Boxed<D> {
    match name {
        "p1" => Box::new(ConformingP1),
        "cr" => Box::new(NonconformingP1),
        "wopsip 1" => Box::new(wopsip(1.0)),
        "wopsip 10" => Box::new(wopsip(10.0)),
        "sipg 4" => Box::new(sipg(4.0)),
        "sipg 10" => Box::new(sipg(10.0)),
        "sipg 20" => Box::new(sipg(20.0)),
        "nipg" => Box::new(Nipg::default()),
        _ => unreachable!("no column {name}"),
    }
}

/// The penalty part of WOPSIP's energy norm, where coefficient and reaction are numbers.
fn jump_norm<const D: usize>(problem: &Problem<D>, error: &Errors) -> f64 {
    let [l2, h1, energy] = [error.l2, error.h1, error.energy].map(Option::unwrap);
    let reaction = match problem.reaction.everywhere {
        None => 0.0,
        Some(Datum::Constant(c)) => c,
        Some(_) => unreachable!("no table has such a reaction"),
    };
    (energy * energy - h1 * h1 - reaction * l2 * l2).sqrt()
}

/// Compares every figure of a table with ours, to its last digit. Its rules have five points of
/// Gauss in each direction, on intervals six.
pub fn compare<const D: usize>(build: impl Fn(usize) -> Scene<D>, table: Table<'_>) {
    let degree = if D == 1 { 11 } else { 9 };
    let mut checks = Checks::default();
    for (name, rows) in table {
        for (n, figures) in *rows {
            let domain = build(*n).domain.bounding_box();
            let sides = domain.upper - domain.lower;
            let level = n * sides.min() as usize / sides.max() as usize;
            let scene = build(level);
            let (mesh, solved) = solve_by_rule(&scene, &*column(name), level, degree);
            let what = format!("{name} on {}, n = {n}", scene.name);
            let (outcome, found) = (solved.outcome, solved.certificate.largest());
            checks.that(outcome == Outcome::Converged && found < 1e-9, || {
                format!("{what}: {outcome}, certificate {found:e}")
            });
            let [l2, h1] = norms_by_rule(&scene, &mesh, &solved.fields.unwrap().u, degree);
            let jump = jump_norm(&scene.problem, &solved.error);
            let ours = [("L2", l2), ("H1", h1), ("jump", jump)];
            for ((norm, ours), printed) in ours.into_iter().zip(figures.split(" / ")) {
                checks.printed(&format!("{norm} of {what}"), ours, printed, 0.5);
            }
        }
    }
    checks.finish();
}

impl Checks {
    /// The figure is what is printed but for this much and half a unit of the last digit.
    pub fn printed_within(&mut self, what: &str, ours: f64, printed: &str, tolerance: f64) {
        println!("{what}: {ours:.6e}, in print {printed}");
        let (theirs, unit) = figure(printed);
        self.close(what, ours, theirs, tolerance + 0.5 * unit);
    }
}
