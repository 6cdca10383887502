//! Scenes by name.

use crate::error::Error;
use crate::scenes::{
    Parameters, Scene, ball_2d, hertz_2d, radial, signorini_2d, signorini_harmonic,
};

/// All registered scenes: obstacle problems first, then Signorini problems, those in three
/// dimensions last. Registering a scene is one line here.
pub fn catalogue() -> Vec<Entry> {
    vec![
        Entry::scaled(radial::<1>),
        Entry::scaled(radial::<2>),
        Entry::scaled(radial::<3>),
        Entry::fixed(ball_2d),
        Entry::fixed(signorini_harmonic::<2>),
        Entry::fixed(signorini_2d),
        Entry::fixed(hertz_2d),
        Entry::fixed(signorini_harmonic::<3>),
    ]
}

/// The registered scene of this name.
pub fn by_name(name: &str) -> Option<Entry> {
    catalogue().into_iter().find(|entry| entry.name == name)
}

/// A scene of any dimension.
pub enum AnyScene {
    /// In one dimension.
    One(Scene<1>),
    /// In two dimensions.
    Two(Scene<2>),
    /// In three dimensions.
    Three(Scene<3>),
}

impl From<Scene<1>> for AnyScene {
    fn from(scene: Scene<1>) -> Self {
        AnyScene::One(scene)
    }
}

impl From<Scene<2>> for AnyScene {
    fn from(scene: Scene<2>) -> Self {
        AnyScene::Two(scene)
    }
}

impl From<Scene<3>> for AnyScene {
    fn from(scene: Scene<3>) -> Self {
        AnyScene::Three(scene)
    }
}

/// Which parameters a scene takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Takes {
    /// The length scale of the domain.
    pub scale: bool,
    /// The ratio of coefficients.
    pub contrast: bool,
    /// The size of the load.
    pub load: bool,
}

/// A scene that can be listed and made.
pub struct Entry {
    /// The name users type.
    pub name: String,
    /// One line for lists.
    pub summary: &'static str,
    /// Dimension of space.
    pub dimension: usize,
    /// Parameters the scene takes.
    pub takes: Takes,
    build: Box<dyn Fn(&Parameters) -> AnyScene + Send + Sync>,
}

/// Scales whose square and cube, and the reciprocals of these, are ordinary numbers.
const SCALES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

impl Entry {
    /// A scene without parameters.
    pub fn fixed<S: Into<AnyScene>>(build: impl Fn() -> S + Send + Sync + 'static) -> Self {
        Self::new(Takes::default(), move |_| build().into())
    }
    /// A scene that takes a length scale; one where the user gives none.
    pub fn scaled<S: Into<AnyScene>>(build: impl Fn(f64) -> S + Send + Sync + 'static) -> Self {
        let takes = Takes { scale: true, ..Takes::default() };
        Self::new(takes, move |p| build(p.scale.unwrap_or(1.0)).into())
    }
    /// A scene that takes a ratio of coefficients, with the one for users who give none.
    pub fn contrasted<S: Into<AnyScene>>(
        default: f64,
        build: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Self {
        let takes = Takes { contrast: true, ..Takes::default() };
        Self::new(takes, move |p| build(p.contrast.unwrap_or(default)).into())
    }
    /// A scene that takes the size of its load, with the one for users who give none.
    pub fn loaded<S: Into<AnyScene>>(
        default: f64,
        build: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Self {
        let takes = Takes { load: true, ..Takes::default() };
        Self::new(takes, move |p| build(p.load.unwrap_or(default)).into())
    }
    /// Name, summary and dimension are read off the scene itself, so that they stand in one place.
    fn new(takes: Takes, build: impl Fn(&Parameters) -> AnyScene + Send + Sync + 'static) -> Self {
        let (name, summary, dimension) = match build(&Parameters::default()) {
            AnyScene::One(scene) => (scene.name, scene.summary, 1),
            AnyScene::Two(scene) => (scene.name, scene.summary, 2),
            AnyScene::Three(scene) => (scene.name, scene.summary, 3),
        };
        Self { name, summary, dimension, takes, build: Box::new(build) }
    }

    /// The scene with these parameters.
    ///
    /// # Errors
    ///
    /// [`Error::Parameter`] for a parameter the scene does not take, a scale that is not positive
    /// and finite (or so large or small that its cube is not), a contrast that is not positive and
    /// finite, and a load that is not finite.
    pub fn make(&self, parameters: &Parameters) -> Result<AnyScene, Error> {
        let Parameters { scale, contrast, load } = *parameters;
        self.admit(
            "scale",
            self.takes.scale,
            scale,
            "positive and finite, 1e-100 to 1e100",
            |x| SCALES.contains(&x),
        )?;
        self.admit("contrast", self.takes.contrast, contrast, "positive and finite", |x| {
            x > 0.0 && x.is_finite()
        })?;
        self.admit("load", self.takes.load, load, "finite", f64::is_finite)?;
        Ok((self.build)(parameters))
    }

    fn admit(
        &self,
        parameter: &'static str,
        taken: bool,
        value: Option<f64>,
        range: &str,
        is_in_range: impl Fn(f64) -> bool,
    ) -> Result<(), Error> {
        let Some(value) = value else { return Ok(()) };
        let allowed = if !taken {
            format!("scene {} takes no {parameter}", self.name)
        } else if !is_in_range(value) {
            format!("must be {range}")
        } else {
            return Ok(());
        };
        Err(Error::Parameter { parameter, value: format!("{value:?}"), allowed })
    }
}
