//! Work against precision: what schemes and linear solvers take to reach a given error.
//!
//! `cargo run --release -- work-precision --help` lists the options; `--quick` ends within a minute.
//! Exit codes: 0 if every run converged, 1 otherwise, 2 if the request was wrong.

mod options;

use std::cell::RefCell;
use std::collections::BTreeSet;

use indicatif::ProgressBar;
pub use options::Options;
use unilateral::in_its_dimension;
use unilateral::input::excerpt;
use unilateral::scenes::{self, AnyScene, Parameters, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::work_precision::{WorkPrecision, WorkProgress, WorkReport};

use crate::adaptive::words;
use crate::one_run::take_directory;
use crate::shared::{
    Failure, Request, bar, end_at_interrupt, print, problem, tick, use_threads, warn,
};

/// The label of which the verdicts speak by default.
const SUBJECT: &str = "wopsip";

/// Whether every run converged.
pub fn run(options: &Options) -> Result<bool, Failure> {
    options.check()?;
    let schemes = options.schemes()?;
    use_threads(options.threads())?;
    let mut report = WorkReport::new("work_precision", options.rounds());
    report.setting = setting(options);
    let template = "{bar:24} {pos} of {len} runs, {elapsed}, {eta} to go: {wide_msg}";
    let bar = bar(options.quiet, 0, template);
    let labels = RefCell::new(BTreeSet::new());
    let mut studies = Vec::new();
    for scene in scenes_of(options)? {
        studies.push(in_its_dimension!(scene, |scene| {
            prepare(options, &schemes, &bar, scene, &labels)
        })?);
    }
    if let (Some(subject), labels) = (&options.subject, labels.borrow())
        && !labels.contains(subject)
    {
        let labels = labels.iter().cloned().collect::<Vec<_>>().join(", ");
        let subject = excerpt(subject);
        return Err(
            format!("--subject {subject}: no scheme has this label; there are: {labels}").into()
        );
    }
    take_directory(&options.out)?;
    end_at_interrupt("the report has the runs so far and is not complete")?;
    // rows of an earlier request do not stand for this one
    report.write_data(&options.out).map_err(Failure::of_work)?;
    tick(&bar);
    for run in studies {
        run(&mut report).map_err(Failure::Work)?;
    }
    finish(options, report, &bar).map_err(Failure::Work)
}

/// Writes and prints the report. Whether every run converged.
fn finish(options: &Options, mut report: WorkReport, bar: &ProgressBar) -> Request<bool> {
    report.provenance.complete = true;
    report.write_data(&options.out).map_err(|e| e.to_string())?;
    bar.finish_and_clear();
    if !options.quiet {
        print(&report.to_text())?;
        print(&format!("\nReport and plots are in {}\n", options.out.display()))?;
    }
    Ok(report.failures().is_empty())
}

/// The mesh, the parameter of the scenes and the adaptive refinement, for the heading of the report.
fn setting(options: &Options) -> String {
    let mesh = options.mesh.path.as_ref().and_then(|path| path.file_name());
    let mesh = mesh.map(|name| format!("refinements of {}", excerpt(name.as_encoded_bytes())));
    let contrast = options.contrast.map(|x| format!("contrast {x:e}"));
    let adaptive = options.adaptive.as_ref().map(|of| format!("adaptive meshes: {}", words(of)));
    [mesh, contrast, adaptive].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The scenes by name on the mesh of the command line if there is one, or the problem of a file. Warnings of the mesh
/// are those of its first scene.
fn scenes_of(options: &Options) -> Request<Vec<AnyScene>> {
    let warn = |warning: String| {
        if !options.quiet {
            warn(&warning);
        }
    };
    if let Some(path) = &options.problem {
        return Ok(vec![problem(path, &warn)?.scene]);
    }
    let file = options.mesh.read()?;
    let of = |(place, name): (usize, &String)| {
        let warn = |warning| {
            if place == 0 {
                warn(warning)
            }
        };
        options.mesh.under(scene(options, name)?, file.as_ref(), &warn)
    };
    options.scenes().iter().enumerate().map(of).collect()
}

/// A scene by name with the parameter of the options, if it takes one.
fn scene(options: &Options, name: &str) -> Request<AnyScene> {
    let entry = scenes::by_name(name).ok_or_else(|| format!("there is no scene {name}"))?;
    let contrast = options.contrast.filter(|_| entry.accepts.contrast);
    entry.make(&Parameters::new().with_contrast(contrast)).map_err(|e| e.to_string())
}

/// A study that has been checked, which adds itself to a report.
type Run<'a> = Box<dyn FnOnce(&mut WorkReport) -> Request<()> + 'a>;

/// Checks a study with the settings of the options.
fn prepare<'a, const D: usize>(
    options: &'a Options,
    schemes: &[NamedScheme],
    bar: &'a ProgressBar,
    scene: Scene<D>,
    labels: &RefCell<BTreeSet<String>>,
) -> Request<Run<'a>> {
    let place = match &options.problem {
        Some(path) => path.display().to_string(),
        None => format!("scene {}", scene.name),
    };
    if scene.problem.exact.is_none() && options.reference.is_none() && !options.quiet {
        let reference = "--reference N measures against a fine solution";
        warn(&format!(
            "warning: {place}: only bounds are reached, for no error is known; {reference}"
        ));
    }
    let levels = options.levels(D, scene.domain.is_mesh());
    let mut study = WorkPrecision::new(scene).levels(levels);
    if let Some(adaptivity) = options.adaptive {
        study = study.adaptive(adaptivity);
    }
    let study = with_settings(options, schemes, bar, study);
    let cases = study.check().map_err(|e| format!("{place}: {e}"))?;
    labels.borrow_mut().extend(cases.iter().map(|case| case.variant.label.clone()));
    bar.inc_length((cases.len() * options.rounds()) as u64);
    Ok(Box::new(move |report| study.run_into(report).map_err(|e| format!("{place}: {e}"))))
}

/// A study with schemes and settings of the options.
fn with_settings<'a, const D: usize>(
    options: &'a Options,
    schemes: &[NamedScheme],
    bar: &'a ProgressBar,
    study: WorkPrecision<'a, D>,
) -> WorkPrecision<'a, D> {
    let study = study
        .linear(options.linear())
        .precision(options.precision())
        .rounds(options.rounds())
        .limit(options.limit)
        .subject(options.subject.as_deref().unwrap_or(SUBJECT))
        .write_to(&options.out)
        .observer(|progress| match progress {
            WorkProgress::Finished => bar.inc(1),
            WorkProgress::Started(case, round) => {
                let v = &case.variant;
                let meshes = match case.is_adaptive() {
                    true => v.meshes.name().to_owned(),
                    false => format!("level {}", case.level),
                };
                bar.set_message(format!("{}, {}, {meshes}, round {}", v.scene, v.label, round + 1));
            }
            // what is planned counts for nothing: the bar was made for all scenes
            _ => {}
        });
    let mut study = schemes.iter().fold(study, WorkPrecision::named_scheme);
    if let Some((scheme, level)) = &options.reference {
        study = study.named_reference(scheme, *level);
    }
    study
}
