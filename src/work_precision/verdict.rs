//! One sentence for a scene, made from the figures.

use super::work_at_error::{Standing, WorkAtError};
use crate::measure::ErrorNorm;
use crate::study::Variant;

/// The work of all variants in a scene at the smallest error that the most of them reach: in L2, and by the bound where
/// meshes are adaptive or no error is known. Empty without errors and bounds.
pub(super) fn at_common_error<'a>(reach: &'a [WorkAtError], scene: &str) -> Vec<&'a WorkAtError> {
    let mut of_scene: Vec<&WorkAtError> =
        reach.iter().filter(|r| r.variant.scene == scene).collect();
    let in_l2 = |r: &&WorkAtError| r.norm == ErrorNorm::L2;
    let by_bound =
        !of_scene.iter().any(in_l2) || of_scene.iter().any(|r| r.variant.theta.is_some());
    let norm = if by_bound { ErrorNorm::Bound } else { ErrorNorm::L2 };
    of_scene.retain(|r| r.norm == norm);
    let reached =
        |error: f64| of_scene.iter().filter(|r| r.error == error && r.seconds.is_some()).count();
    let most = of_scene.iter().map(|r| reached(r.error)).max();
    let errors = of_scene.iter().map(|r| r.error).filter(|&e| Some(reached(e)) == most);
    let error = errors.fold(f64::INFINITY, f64::min);
    of_scene.retain(|r| r.error == error);
    of_scene
}

/// The sentence about a scene: at the error of [`at_common_error`], how many times the time of each
/// other variant the subject takes. The subject is the first variant of that label that gets there,
/// otherwise the fastest. Nothing without errors and bounds.
pub(super) fn verdict(reach: &[WorkAtError], scene: &str, subject: Option<&str>) -> Option<String> {
    let here = at_common_error(reach, scene);
    let error = here.first()?.error;
    let variants: Vec<Variant> = here.iter().map(|r| r.variant.clone()).collect();
    let (there, missing): (Vec<&WorkAtError>, Vec<&WorkAtError>) =
        here.into_iter().partition(|r| r.seconds.is_some());
    let fastest = || there.iter().find(|r| r.ratio == Some(1.0));
    let named = there.iter().find(|r| Some(&r.variant.label[..]) == subject);
    let chosen = *named.or_else(fastest)?;
    let seconds_of = |r: &WorkAtError| r.seconds.expect("those that get there have a time");
    let others = there.iter().filter(|r| r.variant != chosen.variant).map(|r| {
        let ratio = seconds_of(chosen) / seconds_of(r);
        (two_digits(ratio), r.variant.name_among(&variants))
    });
    let name = chosen.variant.name_among(&variants);
    let seconds = seconds_of(chosen);
    let kind = if there[0].norm == ErrorNorm::L2 { "L2 error" } else { "error bound" };
    let mut text = format!("{scene}: at an {kind} of {error:e} {name} takes {seconds:.2e} s");
    for (k, (ratio, other)) in others.enumerate() {
        let comma = if k == 0 { ", " } else { "; " };
        let time = if k == 0 { "the time" } else { "that" };
        text += &format!("{comma}{ratio} times {time} of {other}");
    }
    for (standing, words) in [
        (Standing::NotReached, "not reached by"),
        (Standing::Undercut, "undercut on the coarsest mesh by"),
        (Standing::Failed, "lost with levels that failed by"),
        (Standing::NotRun, "not run far enough for"),
    ] {
        let these = missing.iter().filter(|r| r.standing == standing);
        let names: Vec<String> = these.map(|r| r.variant.name_among(&variants)).collect();
        if !names.is_empty() {
            text += &format!("; {words} {}", names.join(", "));
        }
    }
    Some(text + ".")
}

/// Two digits, which is what a time is good for.
fn two_digits(ratio: f64) -> String {
    match ratio {
        r if r >= 9.95 => format!("{r:.0}"),
        r if r >= 0.995 => format!("{r:.1}"),
        r if r >= 0.0995 => format!("{r:.2}"),
        r => format!("{r:.1e}"),
    }
}
