//! Names, parameters, and every scene held to its own equations.

use std::collections::HashSet;

use unilateral::error::Error;
use unilateral::in_its_dimension;
use unilateral::scenes::{AnyScene, Entry, Parameters, Scene, by_name, catalogue, radial};

use super::{check_any, source};

#[test]
fn every_registered_scene_solves_its_inequality() {
    for entry in catalogue() {
        let scene = entry.make(&Parameters::default()).unwrap();
        check_any(&scene).unwrap_or_else(|violation| panic!("{violation}"));
    }
}

#[test]
fn every_scaled_scene_solves_its_inequality_at_extreme_scales() {
    for entry in catalogue().into_iter().filter(|entry| entry.accepts.scale) {
        for scale in [1e-6, 1e-3, 1e6] {
            let scene = entry.make(&Parameters::new().with_scale(scale)).unwrap();
            check_any(&scene).unwrap_or_else(|violation| panic!("scale {scale}: {violation}"));
        }
    }
}

#[test]
fn names_are_unique_and_end_in_the_dimension() {
    let entries = catalogue();
    let names: HashSet<_> = entries.iter().map(|entry| entry.name.clone()).collect();
    assert_eq!(names.len(), entries.len());
    for entry in &entries {
        assert!(entry.name.ends_with(&format!("-{}d", entry.dimension)), "{}", entry.name);
        assert!(!entry.summary.is_empty() && !entry.summary.contains('\n'));
    }
}

/// The names of the scenes that were agreed on.
const NAMES: &str = "
    parabola-1d icelike-1d oscillating-1d ridge-1d ridge-2d ridge-3d radial-1d radial-2d
    radial-3d radial-quarter-2d polynomial-1d polynomial-2d polynomial-3d ball-2d ball-3d
    disc-2d biactive-half-2d biactive-ring-2d lshape-2d cone-2d cone-3d pyramid-full-2d
    bilateral-1d hill-1d hill-2d hill-3d degenerate2-2d degenerate3-2d degenerate4-2d contrast-1d contrast-2d
    contrast-disc-2d signorini-reaction-1d signorini-open-1d signorini-closed-1d
    signorini-grazing-1d signorini-harmonic-2d signorini-2d signorini-shifted-2d
    signorini-irrational-2d signorini-smooth2-2d signorini-smooth3-2d signorini-smooth4-2d
    signorini-biactive-2d signorini-halves-2d hertz-2d signorini-two-2d signorini-harmonic-3d
    signorini-line-3d signorini-disc2-3d signorini-disc3-3d hertz-3d signorini-layers-2d spiral-2d
    signorini-sine-2d torsion-2d pyramid-2d friction-1d friction-both-1d friction-2d friction-3d
";

#[test]
fn the_catalogue_holds_the_scenes_agreed_on_and_no_others() {
    let agreed: HashSet<&str> = NAMES.split_whitespace().collect();
    let entries = catalogue();
    let found: HashSet<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    let missing: Vec<_> = agreed.difference(&found).collect();
    let unknown: Vec<_> = found.difference(&agreed).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "missing {missing:?}, unknown {unknown:?}");
}

#[test]
fn every_contrast_scene_solves_its_inequality_in_both_directions() {
    let takers: Vec<_> = catalogue().into_iter().filter(|entry| entry.accepts.contrast).collect();
    assert_eq!(takers.len(), 4);
    for entry in takers {
        for contrast in [1e-6, 1e-4, 0.5, 1.0, 1e4, 1e6] {
            let scene = entry.make(&Parameters::new().with_contrast(contrast)).unwrap();
            check_any(&scene).unwrap_or_else(|violation| panic!("{contrast}: {violation}"));
        }
    }
}

/// A solution, or an energy in its place.
#[test]
fn every_scene_says_what_it_can_be_held_to() {
    fn known<const D: usize>(scene: &Scene<D>) -> bool {
        scene.problem.exact.is_some() != scene.problem.reference_energy.is_some()
    }
    for entry in catalogue() {
        let scene = entry.make(&Parameters::default()).unwrap();
        let known = in_its_dimension!(scene, |scene| known(&scene));
        assert!(known, "{}", entry.name);
    }
}

#[test]
fn scenes_are_found_by_name_only() {
    let entry = by_name("radial-3d").unwrap();
    assert_eq!((entry.dimension, entry.accepts.scale), (3, true));
    assert!(matches!(entry.make(&Parameters::default()).unwrap(), AnyScene::Three(_)));
    assert!(by_name("radial").is_none());
    assert!(by_name("Radial-3d").is_none());
}

#[test]
fn a_scale_must_be_positive_and_finite() {
    let entry = by_name("radial-2d").unwrap();
    for (scale, text) in [
        (0.0, "0"),
        (-1.0, "-1"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (1e-200, "1e-200"),
        (1e200, "1e200"),
    ] {
        let made = entry.make(&Parameters::new().with_scale(scale));
        let Err(Error::Parameter(why)) = made else { panic!("scale {scale} was admitted") };
        assert!(why.starts_with(&format!("scale = {text}: ")), "{why}");
    }
}

#[test]
fn a_parameter_that_a_scene_does_not_take_is_refused() {
    let cases = [
        ("ball-2d", "scale", Parameters::new().with_scale(1.0)),
        ("radial-2d", "contrast", Parameters::new().with_contrast(1.0)),
        ("radial-2d", "load", Parameters::new().with_load(1.0)),
    ];
    for (name, expected, parameters) in cases {
        let Err(error) = by_name(name).unwrap().make(&parameters) else {
            panic!("{name} took a {expected}")
        };
        let said = format!("{expected} = ");
        assert!(matches!(&error, Error::Parameter(why) if why.starts_with(&said)), "{error}");
        assert!(error.to_string().contains(&format!("{name} takes no {expected}")), "{error}");
    }
}

#[test]
fn entries_outside_the_catalogue_hand_their_parameter_on() {
    let loaded = Entry::with_load(-2.0, |load| {
        let mut scene = radial::<1>(1.0);
        scene.problem.source.everywhere = Some(load.into());
        scene
    });
    assert!(loaded.accepts.load && !loaded.accepts.scale);
    let load_of = |parameters: &Parameters| match loaded.make(parameters).unwrap() {
        AnyScene::One(scene) => source(&scene, [0.0]),
        _ => unreachable!("the scene is one-dimensional"),
    };
    assert_eq!(load_of(&Parameters::default()), -2.0);
    assert_eq!(load_of(&Parameters::new().with_load(-5.0)), -5.0);
    let made = loaded.make(&Parameters::new().with_load(f64::NAN));
    assert!(matches!(made, Err(Error::Parameter(why)) if why.starts_with("load = ")));
    let contrasted = Entry::with_contrast(1e4, |_| radial::<1>(1.0));
    let made = contrasted.make(&Parameters::new().with_contrast(0.0));
    assert!(matches!(made, Err(Error::Parameter(why)) if why.starts_with("contrast = ")));
}
