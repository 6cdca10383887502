//! Scenes by name.

use std::ops::RangeInclusive;

use super::*;
use crate::error::Error;

/// All registered scenes: obstacle problems, those without a solution in closed form last, then
/// Signorini problems in one, two and three dimensions, then friction. A line of the list registers a scene.
pub fn catalogue() -> Vec<Entry> {
    vec![
        Entry::new(parabola_1d),
        Entry::new(icelike_1d),
        Entry::new(oscillating_1d),
        Entry::new(bilateral_1d),
        Entry::new(ridge::<1>),
        Entry::new(ridge::<2>),
        Entry::new(ridge::<3>),
        Entry::with_scale(radial::<1>),
        Entry::with_scale(radial::<2>),
        Entry::with_scale(radial::<3>),
        Entry::new(radial_quarter_2d),
        Entry::new(polynomial::<1>),
        Entry::new(polynomial::<2>),
        Entry::new(polynomial::<3>),
        Entry::new(hill::<1>),
        Entry::new(hill::<2>),
        Entry::new(hill::<3>),
        Entry::new(ball_2d),
        Entry::new(ball_3d),
        Entry::new(disc_2d),
        Entry::new(biactive_half_2d),
        Entry::new(biactive_ring_2d),
        Entry::new(lshape_2d),
        Entry::new(cone::<2>),
        Entry::new(cone::<3>),
        Entry::new(pyramid_full_2d),
        Entry::new(|| degenerate(2)),
        Entry::new(|| degenerate(3)),
        Entry::new(|| degenerate(4)),
        Entry::with_contrast(1e6, contrast::<1>),
        Entry::with_contrast(1e6, contrast::<2>),
        Entry::with_contrast(1e6, contrast_disc_2d),
        Entry::new(spiral_2d),
        Entry::with_load(5.0, torsion_2d),
        Entry::with_load(-4.0, pyramid_2d),
        Entry::new(signorini_reaction_1d),
        Entry::new(signorini_open_1d),
        Entry::new(signorini_closed_1d),
        Entry::new(signorini_grazing_1d),
        Entry::new(signorini_harmonic::<2>),
        Entry::new(signorini_2d),
        Entry::new(signorini_shifted_2d),
        Entry::new(signorini_irrational_2d),
        Entry::new(|| signorini_smooth(2)),
        Entry::new(|| signorini_smooth(3)),
        Entry::new(|| signorini_smooth(4)),
        Entry::new(signorini_biactive_2d),
        Entry::new(signorini_halves_2d),
        Entry::new(hertz_2d),
        Entry::new(signorini_two_2d),
        Entry::with_contrast(1e4, signorini_layers_2d),
        Entry::new(signorini_sine_2d),
        Entry::new(signorini_harmonic::<3>),
        Entry::new(signorini_line_3d),
        Entry::new(|| signorini_disc(2)),
        Entry::new(|| signorini_disc(3)),
        Entry::new(hertz_3d),
        Entry::new(friction_1d),
        Entry::new(friction_both_1d),
        Entry::new(friction::<2>),
        Entry::new(friction::<3>),
    ]
}

/// The registered scene of this name.
pub fn by_name(name: &str) -> Option<Entry> {
    catalogue().into_iter().find(|entry| entry.name == name)
}

/// A scene of any dimension; [`in_its_dimension`](crate::in_its_dimension) names it in its own.
#[derive(Clone, Debug)]
pub enum AnyScene {
    /// In one dimension.
    One(Scene<1>),
    /// In two dimensions.
    Two(Scene<2>),
    /// In three dimensions.
    Three(Scene<3>),
}

/// The value of an expression for a scene in its dimension, which is known at run time alone.
///
/// ```
/// use unilateral::{in_its_dimension, scenes};
///
/// let cells = |name: &str| {
///     let scene = scenes::by_name(name)?.make(&scenes::Parameters::new()).ok()?;
///     Some(in_its_dimension!(scene, |scene| scene.domain.cells(4)))
/// };
/// assert_eq!([cells("radial-1d"), cells("radial-2d")], [Some(4.0), Some(32.0)]);
/// ```
#[macro_export]
macro_rules! in_its_dimension {
    ($any:expr, |$scene:ident| $value:expr) => {
        match $any {
            $crate::scenes::AnyScene::One($scene) => $value,
            $crate::scenes::AnyScene::Two($scene) => $value,
            $crate::scenes::AnyScene::Three($scene) => $value,
        }
    };
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

/// Parameters of a scene, each absent where the default of the scene is meant. None is ignored
/// silently: [`Entry::make`] refuses what [`Entry::accepts`] does not list.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Parameters {
    /// Length scale of the domain.
    pub scale: Option<f64>,
    /// Ratio of coefficients.
    pub contrast: Option<f64>,
    /// Size of the load.
    pub load: Option<f64>,
}

impl Parameters {
    /// No parameter: every scene with its defaults.
    pub fn new() -> Self {
        Self::default()
    }
    /// Sets the length scale of the domain.
    #[must_use]
    pub fn with_scale(self, scale: impl Into<Option<f64>>) -> Self {
        Self { scale: scale.into(), ..self }
    }
    /// Sets the ratio of coefficients.
    #[must_use]
    pub fn with_contrast(self, contrast: impl Into<Option<f64>>) -> Self {
        Self { contrast: contrast.into(), ..self }
    }
    /// Sets the size of the load.
    #[must_use]
    pub fn with_load(self, load: impl Into<Option<f64>>) -> Self {
        Self { load: load.into(), ..self }
    }
}

/// Which parameters a scene accepts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AcceptedParameters {
    /// The length scale of the domain.
    pub scale: bool,
    /// The ratio of coefficients.
    pub contrast: bool,
    /// The size of the load.
    pub load: bool,
}

/// The function that makes a scene from its parameters.
type Builder = Box<dyn Fn(&Parameters) -> AnyScene + Send + Sync>;

/// A registered scene: what lists show of it, and a function that builds it.
#[non_exhaustive]
pub struct Entry {
    /// The name users type.
    pub name: String,
    /// One line for lists.
    pub summary: &'static str,
    /// Dimension of space.
    pub dimension: usize,
    /// Parameters the scene accepts.
    pub accepts: AcceptedParameters,
    build: Builder,
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Entry").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Scales whose squares and cubes neither overflow nor underflow, and contrasts for which the solution does not.
const RATIOS: RangeInclusive<f64> = 1e-100..=1e100;

impl Entry {
    /// A scene without parameters.
    pub fn new<S: Into<AnyScene>>(build: impl Fn() -> S + Send + Sync + 'static) -> Self {
        Self::with(AcceptedParameters::default(), move |_| build())
    }
    /// A scene that accepts a length scale, one by default.
    pub fn with_scale<S: Into<AnyScene>>(build: impl Fn(f64) -> S + Send + Sync + 'static) -> Self {
        let accepts = AcceptedParameters { scale: true, ..AcceptedParameters::default() };
        Self::with(accepts, move |p| build(p.scale.unwrap_or(1.0)))
    }
    /// A scene that accepts a ratio of coefficients, and its default.
    pub fn with_contrast<S: Into<AnyScene>>(
        default: f64,
        build: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Self {
        let accepts = AcceptedParameters { contrast: true, ..AcceptedParameters::default() };
        Self::with(accepts, move |p| build(p.contrast.unwrap_or(default)))
    }
    /// A scene that accepts the size of its load, and its default.
    pub fn with_load<S: Into<AnyScene>>(
        default: f64,
        build: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Self {
        let accepts = AcceptedParameters { load: true, ..AcceptedParameters::default() };
        Self::with(accepts, move |p| build(p.load.unwrap_or(default)))
    }
    /// An entry whose name, summary and dimension are those of the scene with its defaults.
    fn with<S: Into<AnyScene>>(
        accepts: AcceptedParameters,
        build: impl Fn(&Parameters) -> S + Send + Sync + 'static,
    ) -> Self {
        let (name, summary, dimension) = match build(&Parameters::default()).into() {
            AnyScene::One(scene) => (scene.name, scene.summary, 1),
            AnyScene::Two(scene) => (scene.name, scene.summary, 2),
            AnyScene::Three(scene) => (scene.name, scene.summary, 3),
        };
        Self { name, summary, dimension, accepts, build: Box::new(move |p| build(p).into()) }
    }

    /// The scene with these parameters.
    ///
    /// # Errors
    ///
    /// [`Error::Parameter`] for a parameter the scene does not accept, a scale that is not positive
    /// and finite (or so large or small that its cube is not), a contrast likewise, and a
    /// load that is not finite.
    pub fn make(&self, parameters: &Parameters) -> Result<AnyScene, Error> {
        let Parameters { scale, contrast, load } = *parameters;
        let ratio = ("positive and finite, 1e-100 to 1e100", RATIOS);
        let finite = ("finite", f64::MIN..=f64::MAX);
        for (parameter, accepted, value, (range, numbers)) in [
            ("scale", self.accepts.scale, scale, ratio.clone()),
            ("contrast", self.accepts.contrast, contrast, ratio),
            ("load", self.accepts.load, load, finite),
        ] {
            let Some(value) = value else { continue };
            let allowed = match accepted {
                false => format!("scene {} takes no {parameter}", self.name),
                true if numbers.contains(&value) => continue,
                true => format!("must be {range}"),
            };
            let value = format!("{value:?}").trim_end_matches(".0").to_owned();
            return Err(Error::parameter(parameter, value, allowed));
        }
        Ok((self.build)(parameters))
    }
}
