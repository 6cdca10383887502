//! The work that schemes take to reach an error: `compare --rounds N`.

use unilateral::error::Error;
use unilateral::in_its_dimension;
use unilateral::input::excerpt;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Report, Row, Study};
use unilateral::work_precision::{Rounds, WorkPrecision};

use super::options::Options;
use super::prepare::{study, with_solvers};
use super::watcher::Watcher;
use super::{Chosen, check_output, program, show, write_all};
use crate::shared::{Request, complain, each_once, end_at_interrupt};

/// The scenes where none are named.
pub const SCENES: [&str; 5] = ["radial-2d", "ball-2d", "signorini-2d", "hertz-2d", "radial-3d"];
/// The schemes where none are named.
pub const SCHEMES: [&str; 6] = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2"];
/// The label of which the verdicts speak by default.
const SUBJECT: &str = "wopsip";

/// Receives the report after every round.
type Keep<'k> = dyn FnMut(&Report) -> Result<(), Error> + 'k;

/// Runs studies and adds their rows to a report.
type RunInto<'a> = Box<dyn FnOnce(&mut Report, &mut Keep<'_>) -> Result<(), Error> + 'a>;

/// Studies that have been checked.
struct Run<'a> {
    /// The scene, for messages.
    place: String,
    labels: Vec<String>,
    run: RunInto<'a>,
}

/// A report as work against precision.
pub fn work<'r>(options: &'r Options, report: &'r Report) -> WorkPrecision<'r> {
    WorkPrecision::of(report).subject(options.subject.as_deref().unwrap_or(SUBJECT))
}

/// Whether every run converged.
pub fn run(chosen: Chosen, options: &Options, watcher: &Watcher, count: usize) -> Request<bool> {
    let Chosen { scenes, schemes, solvers, fingerprints: files, inputs } = chosen;
    let rounds = (Rounds::new(count).limit(options.limit), count);
    let names = (&schemes[..], &solvers[..]);
    let mut runs = Vec::new();
    for scene in scenes {
        let run = in_its_dimension!(scene, |scene| prepare(scene, options, names, watcher, rounds));
        runs.extend(run?);
    }
    check_subject(options, &runs)?;
    check_output(options, &inputs)?;
    end_at_interrupt("the report has the runs so far and is not complete")?;
    let mut report = Report::new(program(options, &files), Vec::new());
    report.complete = false;
    // files of an earlier request do not stand for this one
    if let Ok(earlier) = Report::read(&options.out) {
        earlier.remove_files(&options.out);
    }
    let mut keep = |report: &Report| work(options, report).write(&options.out).map(|_| ());
    let mut messages: Vec<String> = keep(&report).err().iter().map(Error::to_string).collect();
    for Run { place, run, .. } in runs {
        if let Err(error) = run(&mut report, &mut keep) {
            messages.push(format!("{place}: {error}"));
            // the next scene could not be written either
            if matches!(error, Error::Write { .. }) {
                break;
            }
        }
    }
    watcher.clear();
    report.complete = messages.is_empty();
    messages.extend(write_all(options, &report).err());
    messages.extend(show(options, &report).err());
    messages.iter().for_each(|text| complain(text));
    Ok(messages.is_empty() && report.rows.iter().all(Row::converged))
}

/// Refuses a subject that no scheme is.
fn check_subject(options: &Options, runs: &[Run<'_>]) -> Request<()> {
    let labels: Vec<String> = runs.iter().flat_map(|run| run.labels.clone()).collect();
    let mut labels = each_once(&labels);
    labels.sort_unstable();
    match options.subject.as_ref().filter(|subject| !labels.contains(subject)) {
        None => Ok(()),
        Some(subject) => Err(format!(
            "--subject {}: no scheme has this label; there are: {}",
            excerpt(subject),
            labels.join(", ")
        )),
    }
}

/// Checks the studies of a scene: one for each linear solver, on levels and, where they are asked for, on adaptive
/// meshes. Nothing is left of a scene that does not fit the mesh and was not asked for by name.
fn prepare<'a, const D: usize>(
    scene: Scene<D>,
    options: &'a Options,
    (schemes, solvers): (&[NamedScheme], &[String]),
    watcher: &'a Watcher,
    (rounds, count): (Rounds, usize),
) -> Request<Option<Run<'a>>> {
    let asked = &options.asked;
    let place = asked.place(&scene.name);
    let mut studies: Vec<Study<'_, D>> = Vec::new();
    for (name, linear) in options.linear() {
        let of = || {
            let study = study(scene.clone(), options, schemes, watcher).linear_asked(name);
            with_solvers(study, solvers, linear, options)
        };
        let uniform = of()?;
        let first = uniform.keys().iter().map(|key| key.level).min();
        studies.push(match &asked.reference {
            Some((scheme, level)) => uniform.named_reference(scheme, *level),
            None => uniform,
        });
        if let Some(adaptivity) = asked.adaptive {
            studies.push(of()?.levels(first).adaptive(adaptivity));
        }
    }
    match rounds.check(&studies) {
        Err(Error::UnfitMesh(_)) if !asked.scenes_are_named() => return Ok(None),
        checked => checked.map_err(|e| format!("{place}: {e}"))?,
    };
    if scene.problem.exact.is_none() && asked.reference.is_none() {
        let reference = "--reference N measures against a fine solution";
        watcher.warn_once(format!(
            "warning: {place}: only bounds are reached, for no error is known; {reference}"
        ));
    }
    let keys: Vec<_> = studies.iter().flat_map(Study::keys).collect();
    for _ in 0..count + usize::from(asked.reference.is_some()) {
        watcher.expect(D, scene.domain.is_mesh(), keys.iter().map(|key| key.level));
    }
    let labels = keys.into_iter().map(|key| key.label).collect();
    let run =
        move |report: &mut Report, keep: &mut Keep<'_>| rounds.run_into(&studies, report, keep);
    Ok(Some(Run { place, labels, run: Box::new(run) }))
}
