//! Work against precision: what schemes and linear solvers take to reach a given error.
//!
//! `cargo run --release -- work-precision --help` lists the options; `--quick` ends within a minute.

mod options;

use indicatif::ProgressBar;
pub use options::Options;
use unilateral::error::Error;
use unilateral::in_its_dimension;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::input::excerpt;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Program, Progress, Report, Row, Study};
use unilateral::work_precision::{Rounds, WorkPrecision};

use crate::asked::FoundScenes;
use crate::one_run::take_directory;
use crate::shared::{
    Failure, Request, bar, check_apart, complain, each_once, end_at_interrupt, print,
    terminal_width, tick, use_threads, warn,
};

const SCENES: [&str; 5] = ["radial-2d", "ball-2d", "signorini-2d", "hertz-2d", "radial-3d"];

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

/// Whether every run converged.
pub fn run(options: &Options) -> Result<bool, Failure> {
    options.check()?;
    let schemes = options.schemes()?;
    use_threads(options.asked.threads)?;
    let quiet = options.asked.quiet;
    let warn = |warning: String| {
        if !quiet {
            warn(&warning);
        }
    };
    let bar = bar(quiet, "{bar:24} {pos} of {len} runs, {elapsed}, {eta} to go: {wide_msg}");
    let found = options.asked.scenes(&SCENES, &warn)?;
    let FoundScenes { scenes, fingerprints: files, paths } = found;
    let mut runs = Vec::new();
    for scene in scenes {
        runs.push(in_its_dimension!(scene, |scene| prepare(
            options, &schemes, &bar, scene, &warn
        ))?);
    }
    check_subject(options, &runs)?;
    check_apart(&paths, None, [&options.out])?;
    take_directory(&options.out)?;
    end_at_interrupt("the report has the runs so far and is not complete")?;
    let threads = rayon::current_num_threads();
    let program =
        Program::new("work-precision", options.precision().name(), threads, options.rounds());
    let mut report = Report::new(options.asked.stated_in(program, &files), Vec::new());
    report.complete = false;
    let subject = options.subject.as_deref().unwrap_or(SUBJECT);
    let mut keep = |report: &Report| {
        WorkPrecision::of(report).subject(subject).write(&options.out).map(|_| ())
    };
    // files of an earlier request do not stand for this one
    if let Ok(earlier) = Report::read(&options.out) {
        earlier.remove_files(&options.out);
    }
    keep(&report).map_err(Failure::of_work)?;
    tick(&bar);
    let mut failed = false;
    for Run { place, run, .. } in runs {
        match run(&mut report, &mut keep) {
            // the next scene could not be written either
            Err(error @ Error::Write { .. }) => return Err(Failure::of_work(error)),
            Err(error) => {
                bar.suspend(|| complain(&format!("{place}: {error}")));
                failed = true;
            }
            Ok(()) => {}
        }
    }
    bar.finish_and_clear();
    report.complete = !failed;
    keep(&report).map_err(Failure::of_work)?;
    if !quiet {
        print(&WorkPrecision::of(&report).subject(subject).to_text(terminal_width()))?;
        let is_whole = report.complete;
        let files = if is_whole { "Report and plots are" } else { "The incomplete report is" };
        print(&format!("\n{files} in {}\n", options.out.display()))?;
    }
    Ok(report.complete && report.rows.iter().all(Row::converged))
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
/// meshes.
fn prepare<'a, const D: usize>(
    options: &'a Options,
    schemes: &[NamedScheme],
    bar: &'a ProgressBar,
    scene: Scene<D>,
    warn: &dyn Fn(String),
) -> Request<Run<'a>> {
    let asked = &options.asked;
    let place = asked.place(&scene.name);
    if scene.problem.exact.is_none() && asked.reference.is_none() {
        let reference = "--reference N measures against a fine solution";
        warn(format!(
            "warning: {place}: only bounds are reached, for no error is known; {reference}"
        ));
    }
    let levels = options.levels(D, scene.domain.is_mesh());
    let study = |(name, linear): (&str, _)| {
        let solver = in_precision(options.precision(), ActiveSet::default().linear(linear));
        let study = Study::new(scene.clone()).boxed_solver(solver).linear_asked(name);
        let study = study.observer(|progress| {
            if let Progress::Started(scene, label, level) = progress {
                bar.inc(1);
                bar.set_message(format!("{scene}, {label}, level {level}"));
            }
        });
        schemes.iter().fold(study, Study::named_scheme)
    };
    let mut studies = Vec::new();
    for linear in options.linear() {
        let uniform = study(linear).levels(levels.iter().copied());
        studies.push(match &asked.reference {
            Some((scheme, level)) => uniform.named_reference(scheme, *level),
            None => uniform,
        });
        let first = levels.first().copied();
        studies.extend(asked.adaptive.map(|of| study(linear).levels(first).adaptive(of)));
    }
    let labels = studies.iter().flat_map(Study::keys).map(|key| key.label).collect();
    let rounds = Rounds::new(options.rounds()).limit(options.limit);
    let count = rounds.check(&studies).map_err(|e| format!("{place}: {e}"))?;
    bar.inc_length(count as u64);
    let run =
        move |report: &mut Report, keep: &mut Keep<'_>| rounds.run_into(&studies, report, keep);
    Ok(Run { place, labels, run: Box::new(run) })
}
