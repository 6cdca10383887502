//! Scenes by name.

use std::ops::RangeInclusive;

use super::{
    Parameters, Scene, ball_2d, ball_3d, biactive_half_2d, biactive_ring_2d, bilateral_1d, cone,
    contrast, contrast_disc_2d, degenerate, disc_2d, hertz_2d, hertz_3d, icelike_1d, lshape_2d,
    oscillating_1d, parabola_1d, polynomial, pyramid_2d, pyramid_full_2d, radial,
    radial_quarter_2d, ridge, signorini_2d, signorini_biactive_2d, signorini_closed_1d,
    signorini_disc, signorini_grazing_1d, signorini_harmonic, signorini_irrational_2d,
    signorini_layers_2d, signorini_line_3d, signorini_open_1d, signorini_reaction_1d,
    signorini_shifted_2d, signorini_sine_2d, signorini_smooth, signorini_two_2d, spiral_2d,
    torsion_2d,
};
use crate::error::Error;

/// All registered scenes: obstacle problems first, those without a closed solution last among them,
/// then Signorini problems in one, two and three dimensions. Registering a scene is one line here.
pub fn catalogue() -> Vec<Entry> {
    vec![
        Entry::fixed(parabola_1d),
        Entry::fixed(icelike_1d),
        Entry::fixed(oscillating_1d),
        Entry::fixed(bilateral_1d),
        Entry::fixed(ridge::<1>),
        Entry::fixed(ridge::<2>),
        Entry::fixed(ridge::<3>),
        Entry::scaled(radial::<1>),
        Entry::scaled(radial::<2>),
        Entry::scaled(radial::<3>),
        Entry::fixed(radial_quarter_2d),
        Entry::fixed(polynomial::<1>),
        Entry::fixed(polynomial::<2>),
        Entry::fixed(polynomial::<3>),
        Entry::fixed(ball_2d),
        Entry::fixed(ball_3d),
        Entry::fixed(disc_2d),
        Entry::fixed(biactive_half_2d),
        Entry::fixed(biactive_ring_2d),
        Entry::fixed(lshape_2d),
        Entry::fixed(cone::<2>),
        Entry::fixed(cone::<3>),
        Entry::fixed(pyramid_full_2d),
        Entry::fixed(|| degenerate(2)),
        Entry::fixed(|| degenerate(3)),
        Entry::fixed(|| degenerate(4)),
        Entry::contrasted(1e6, contrast::<1>),
        Entry::contrasted(1e6, contrast::<2>),
        Entry::contrasted(1e6, contrast_disc_2d),
        Entry::fixed(spiral_2d),
        Entry::loaded(5.0, torsion_2d),
        Entry::loaded(-4.0, pyramid_2d),
        Entry::fixed(signorini_reaction_1d),
        Entry::fixed(signorini_open_1d),
        Entry::fixed(signorini_closed_1d),
        Entry::fixed(signorini_grazing_1d),
        Entry::fixed(signorini_harmonic::<2>),
        Entry::fixed(signorini_2d),
        Entry::fixed(signorini_shifted_2d),
        Entry::fixed(signorini_irrational_2d),
        Entry::fixed(|| signorini_smooth(2)),
        Entry::fixed(|| signorini_smooth(3)),
        Entry::fixed(|| signorini_smooth(4)),
        Entry::fixed(signorini_biactive_2d),
        Entry::fixed(hertz_2d),
        Entry::fixed(signorini_two_2d),
        Entry::contrasted(1e4, signorini_layers_2d),
        Entry::fixed(signorini_sine_2d),
        Entry::fixed(signorini_harmonic::<3>),
        Entry::fixed(signorini_line_3d),
        Entry::fixed(|| signorini_disc(2)),
        Entry::fixed(|| signorini_disc(3)),
        Entry::fixed(hertz_3d),
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
const SCALES: RangeInclusive<f64> = 1e-100..=1e100;
/// Contrasts that neither overflow nor vanish in the solution.
const CONTRASTS: RangeInclusive<f64> = 1e-100..=1e100;

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
    /// and finite (or so large or small that its cube is not), a contrast likewise, and a
    /// load that is not finite.
    pub fn make(&self, parameters: &Parameters) -> Result<AnyScene, Error> {
        let Parameters { scale, contrast, load } = *parameters;
        self.admit(
            "scale",
            self.takes.scale,
            scale,
            "positive and finite, 1e-100 to 1e100",
            |x| SCALES.contains(&x),
        )?;
        self.admit(
            "contrast",
            self.takes.contrast,
            contrast,
            "positive and finite, 1e-100 to 1e100",
            |x| CONTRASTS.contains(&x),
        )?;
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
        Err(Error::Parameter {
            parameter,
            value: format!("{value:?}").trim_end_matches(".0").to_owned(),
            allowed,
        })
    }
}
