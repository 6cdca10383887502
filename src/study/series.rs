//! Series: the rows of a report that belong together, from coarse to fine.

use std::borrow::Borrow;

use super::row::Row;
#[cfg(feature = "report")]
use super::row::distinct;

/// The meshes of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Meshes {
    /// Levels: subdivisions, or uniform refinements of a mesh.
    Uniform,
    /// Steps that follow the error bound.
    Adaptive {
        /// The share of the bound that each refinement marks.
        theta: f64,
    },
}

impl Meshes {
    /// The meshes to which that of a row belongs.
    #[must_use]
    pub fn of(row: &Row) -> Self {
        row.theta.map_or(Self::Uniform, |theta| Self::Adaptive { theta })
    }
    /// `uniform` or `adaptive`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Adaptive { .. } => "adaptive",
        }
    }
    /// Whether the meshes follow the error bound.
    pub fn is_adaptive(self) -> bool {
        matches!(self, Self::Adaptive { .. })
    }
}

#[cfg(feature = "report")]
impl serde::Serialize for Meshes {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

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
    /// The linear solver asked for; none where the rows do not say.
    pub linear_asked: Option<String>,
    /// The meshes.
    pub meshes: Meshes,
}

impl Variant {
    /// The variant of a row.
    #[must_use]
    pub fn of(row: &Row) -> Self {
        let [scene, label, solver] = [&row.scene, &row.label, &row.solver].map(String::clone);
        let linear_asked = row.linear_asked.clone();
        Self { scene, label, solver, linear_asked, meshes: Meshes::of(row) }
    }
    /// The name of the variant among others of a report: its label, and what else varies in the report.
    pub fn name_among<'v>(&self, all: impl IntoIterator<Item = &'v Variant> + Clone) -> String {
        let varies = |differs: fn(&Variant, &Variant) -> bool| {
            all.clone().into_iter().any(|other| differs(self, other))
        };
        let mut name = self.label.clone();
        let mut add = |text: &str| name += &format!(", {text}");
        if varies(|a, b| a.solver != b.solver) {
            add(&self.solver);
        }
        if varies(|a, b| a.linear_asked != b.linear_asked) {
            self.linear_asked.iter().for_each(|linear| add(linear));
        }
        if varies(|a, b| a.meshes.name() != b.meshes.name()) {
            add(self.meshes.name());
        }
        if let Meshes::Adaptive { theta } = self.meshes
            && varies(|a, b| b.meshes.is_adaptive() && a.meshes != b.meshes)
        {
            add(&format!("theta {theta}"));
        }
        name
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
