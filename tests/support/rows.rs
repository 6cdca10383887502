//! Rows of studies, and what is asserted of each.

use super::checks::Checks;
use super::schemes::Entry;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// Scheme, constraint, scene and level of a row, for messages.
pub fn label(row: &Row) -> String {
    format!("{} ({}) on {} at level {}", row.scheme, row.constraint, row.scene, row.level)
}

/// The rows of schemes on levels of a scene.
pub fn rows<const D: usize>(
    scene: Scene<D>,
    schemes: Vec<impl Into<Entry<D>>>,
    levels: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    rows_in(Precision::Double, scene, schemes, levels)
}

/// The rows of schemes on levels of a scene, solved in a precision.
pub fn rows_in<const D: usize>(
    precision: Precision,
    scene: Scene<D>,
    schemes: Vec<impl Into<Entry<D>>>,
    levels: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    let study = Study::<'static, D>::new(scene).levels(levels);
    let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
    let add =
        |study: Study<'static, D>, entry: Entry<D>| study.boxed_scheme_on(entry.scheme, entry.set);
    schemes.into_iter().map(Into::into).fold(study, add).run().unwrap().rows
}

impl Checks {
    /// The row converged, with a certificate that says so.
    pub fn certified(&mut self, row: &Row, largest: f64) {
        let (status, found) = (&row.status, row.certificate.largest());
        self.that(row.converged() && found < largest, || {
            format!("{}: {status}, certificate {found:e}", label(row))
        });
    }
}
