//! The places of sweeps: scenes on levels or meshes; schemes, scenes and norms by name.

use crate::in_its_dimension;
use crate::real::Precision;
use crate::scenes::{AnyScene, Parameters, by_name, sines};
use crate::scheme::NamedScheme;
use crate::study::Row;

/// A scene of the catalogue, or Poisson's equation.
fn scene(name: &str) -> AnyScene {
    match name {
        "sines-1d" => sines::<1>().into(),
        "sines-2d" => sines::<2>().into(),
        _ => {
            let found = by_name(name).and_then(|entry| entry.make(&Parameters::default()).ok());
            found.expect("cases name scenes of the catalogue")
        }
    }
}

/// A scheme that a case names.
pub(crate) fn scheme(name: &str) -> NamedScheme {
    name.parse().expect("cases name schemes that exist")
}

/// Schemes that a case names, separated by blanks.
pub(crate) fn schemes(names: &str) -> Vec<NamedScheme> {
    names.split_whitespace().map(scheme).collect()
}

/// A scheme with powers of ten as its over-penalty factor `eta`.
pub(crate) fn with_eta(name: &str, exponents: &[i32]) -> Vec<NamedScheme> {
    exponents.iter().map(|exponent| scheme(&format!("{name}@eta=1e{exponent}"))).collect()
}

/// A place of a sweep.
pub(crate) struct Place {
    pub scene: AnyScene,
    /// The level of the study.
    pub level: usize,
    /// The level that rows show: subdivisions, also of a mesh that is made by hand.
    pub shown: Option<usize>,
    /// The value of the parameter.
    pub value: Option<f64>,
    /// The scalar of assembly and solve.
    pub precision: Precision,
    /// Whether schemes start without contact and without coarser levels.
    pub is_cold: bool,
    /// Whether every scheme runs with the interior point method too.
    pub has_interior_point: bool,
}

impl Place {
    /// A scene on a level.
    pub fn new(scene: impl Into<AnyScene>, level: usize) -> Self {
        Self {
            scene: scene.into(),
            level,
            shown: Some(level),
            value: None,
            precision: Precision::Double,
            is_cold: false,
            has_interior_point: false,
        }
    }
    /// A scene of the catalogue, or Poisson's equation as `sines-2d`, on levels.
    pub fn levels(name: &str, levels: &[usize]) -> Vec<Self> {
        levels.iter().map(|&level| Self::new(scene(name), level)).collect()
    }
    /// A scene whose domain is a mesh, for which rows show this level.
    pub fn on_mesh(scene: impl Into<AnyScene>, shown: Option<usize>) -> Self {
        Self { shown, ..Self::new(scene, 0) }
    }
    /// At a value of the parameter.
    pub fn at(self, value: f64) -> Self {
        Self { value: Some(value), ..self }
    }
    /// At the mesh size of the level as the value of the parameter.
    pub fn at_size(self) -> Self {
        let length = in_its_dimension!(&self.scene, |scene| scene.domain.length());
        let size = length / self.level as f64;
        self.at(size)
    }
    /// With the interior point method too, perhaps from a cold start.
    pub fn with_interior_point(self, is_cold: bool) -> Self {
        Self { is_cold, has_interior_point: true, ..self }
    }
    /// In a precision.
    pub fn precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }
}

/// A norm of the error by name.
pub(crate) type Norm = (&'static str, fn(&Row) -> Option<f64>);

pub(crate) const L2: Norm = ("L2", |row| row.error.l2);
pub(crate) const H1: Norm = ("H1", |row| row.error.h1);
pub(crate) const ENERGY: Norm = ("energy", |row| row.error.energy);
/// The jump seminorm: the penalty's part of the energy norm.
pub(crate) const JUMPS: Norm = ("jumps", |row| {
    let (energy, h1) = (row.error.energy?, row.error.h1?);
    Some((energy * energy - h1 * h1).max(0.0).sqrt())
});
