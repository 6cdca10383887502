//! Rows of studies, and what is asserted of each.

use super::checks::Checks;
use super::schemes::Entry;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

/// Scheme, constraint, scene and level of a row, for messages.
pub fn label(row: &Row) -> String {
    format!("{} ({}) on {} at level {}", row.scheme, row.constraint, row.scene, row.level)
}

/// The rows of schemes on levels of a scene.
pub fn rows<T: Real, const D: usize>(
    scene: Scene<D>,
    schemes: Vec<impl Into<Entry<T, D>>>,
    levels: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    let study = Study::<'static, T, D>::new(scene).levels(levels);
    let add = |study: Study<'static, T, D>, entry: Entry<T, D>| {
        study.boxed_scheme_on(entry.scheme, entry.set)
    };
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
