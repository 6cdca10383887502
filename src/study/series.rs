//! Series: the rows of a report that belong together, from coarse to fine.

use std::borrow::Borrow;

use super::row::Row;
#[cfg(feature = "report")]
use super::row::distinct;

/// A scheme with a solver on a scene and one kind of meshes: the rows of a series have it in common.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Variant {
    /// Name of the scene.
    pub scene: String,
    /// Scheme, constraint set and choices without what is default.
    pub label: String,
    /// Name of the solver.
    pub solver: String,
    /// The share of the error bound that each refinement marks; none of uniform meshes. In files the kind of meshes.
    #[cfg_attr(feature = "report", serde(rename = "meshes", serialize_with = "kind_of_meshes"))]
    pub theta: Option<f64>,
}

/// Writes `uniform` or `adaptive`.
#[cfg(feature = "report")]
fn kind_of_meshes<S: serde::Serializer>(theta: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(if theta.is_some() { "adaptive" } else { "uniform" })
}

impl Variant {
    /// The variant of a row.
    #[must_use]
    pub fn of(row: &Row) -> Self {
        let [scene, label, solver] = [&row.scene, &row.label, &row.solver].map(String::clone);
        Self { scene, label, solver, theta: row.theta }
    }
    /// The name of the variant among others of a report: its label, with the solver where there are several.
    pub fn name_among<'v>(&self, all: impl IntoIterator<Item = &'v Variant>) -> String {
        let mut solvers = all.into_iter().map(|other| &other.solver);
        match solvers.any(|solver| *solver != self.solver) {
            true => format!("{}, {}", self.label, self.solver),
            false => self.label.clone(),
        }
    }
}

/// The rows of one variant.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Series<'r> {
    /// Scene, scheme, solver and kind of meshes of the rows.
    pub variant: Variant,
    /// The entry in a legend: the label, with all that varies between the series of the report but the scene.
    pub name: String,
    /// The rows, from coarse to fine.
    pub rows: Vec<&'r Row>,
}

/// The series of each scene, in the order in which scenes first occur.
#[cfg(feature = "report")]
pub(crate) fn by_scene<'s, 'r>(series: &'s [Series<'r>]) -> Vec<(&'s str, Vec<&'s Series<'r>>)> {
    let of = |scene| (scene, series.iter().filter(|s| s.variant.scene == scene).collect());
    distinct(series.iter().map(|s| s.variant.scene.as_str())).into_iter().map(of).collect()
}

/// The series of rows, in the order in which they first occur.
pub(crate) fn series_of<R: Borrow<Row>>(rows: &[R]) -> Vec<Series<'_>> {
    let mut all: Vec<Series<'_>> = Vec::new();
    for row in rows.iter().map(R::borrow) {
        let variant = Variant::of(row);
        match all.iter_mut().find(|series| series.variant == variant) {
            Some(series) => series.rows.push(row),
            None => all.push(Series { variant, name: String::new(), rows: vec![row] }),
        }
    }
    for k in 0..all.len() {
        all[k].rows.sort_by_key(|row| row.level);
        all[k].name = all[k].variant.name_among(all.iter().map(|series| &series.variant));
    }
    all
}
