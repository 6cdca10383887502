//! Work against precision: what schemes, linear solvers and precisions take to reach a given error.
//!
//! `cargo run --release -- work-precision --help` lists the options; `--quick` ends within a minute.
//! Exit codes: 0 if every run converged and nothing changed against the baseline, 1 otherwise, 2 if
//! the request was wrong.

mod options;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::process::Command;

use indicatif::ProgressBar;
pub use options::Options;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::input::excerpt;
use unilateral::linear::LinearMethod;
use unilateral::mesh::gmsh::GmshFile;
use unilateral::problem_file::{self, AnyOwnProblem};
use unilateral::scenes::{self, AnyScene, Parameters};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Study, peak_memory_bytes};
use unilateral::work_precision::{Case, WorkPrecision, WorkProgress, WorkReport, changes};

use crate::adaptive::words;
use crate::one_run::take_directory;
use crate::posed::Posed;
use crate::shared::{
    Failure, Request, bar, check_writable, end_at_interrupt, print, read, tick, use_threads, warn,
    write,
};

/// The label of which the verdicts speak by default.
const SUBJECT: &str = "wopsip";

/// Whether every run converged and nothing changed.
pub fn run(options: &Options) -> Result<bool, Failure> {
    options.check()?;
    let schemes = options.schemes()?;
    if options.peak {
        return peak(options).map_err(Failure::Work);
    }
    use_threads(options.threads())?;
    // what cannot be read or written is better known before the work
    let baseline = match &options.against {
        Some(path) => Some(
            String::from_utf8(read(path)?)
                .map_err(|e| format!("cannot read {}: {e}", path.display()))?,
        ),
        None => None,
    };
    let mut report = WorkReport::new("work_precision", options.rounds());
    report.setting = setting(options);
    if let Some(text) = &baseline {
        changes(text, &report).map_err(|e| e.to_string())?;
    }
    let template = "{bar:24} {pos} of {len} runs, {elapsed}, {eta} to go: {wide_msg}";
    let bar = bar(options.quiet, 0, template);
    let labels = RefCell::new(BTreeSet::new());
    let file = options.mesh.read()?;
    let with = (&schemes[..], file.as_ref());
    let mut studies = Vec::new();
    for name in options.scenes() {
        studies.push(match scene(options, &name)? {
            AnyScene::One(s) => prepare::<1>(options, with, &bar, s.into(), &labels),
            AnyScene::Two(s) => prepare::<2>(options, with, &bar, s.into(), &labels),
            AnyScene::Three(s) => prepare::<3>(options, with, &bar, s.into(), &labels),
        }?);
    }
    if let Some(path) = &options.problem {
        studies.push(match problem_file::read(path).map_err(|e| e.to_string())? {
            AnyOwnProblem::One(own) => prepare::<1>(options, with, &bar, own.into(), &labels),
            AnyOwnProblem::Two(own) => prepare::<2>(options, with, &bar, own.into(), &labels),
            AnyOwnProblem::Three(own) => prepare::<3>(options, with, &bar, own.into(), &labels),
        }?);
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
    // the studies have the meshes they need
    drop(file);
    check_writable(&options.save)?;
    take_directory(&options.out)?;
    end_at_interrupt("the report has the runs so far and is not complete")?;
    // rows of an earlier request do not stand for this one
    report.write_data(&options.out).map_err(Failure::of_work)?;
    tick(&bar);
    for run in studies {
        run(&mut report).map_err(Failure::Work)?;
    }
    finish(options, report, &bar, baseline.as_deref()).map_err(Failure::Work)
}

/// Writes and prints the report. Whether every run converged and nothing changed.
fn finish(
    options: &Options,
    mut report: WorkReport,
    bar: &ProgressBar,
    baseline: Option<&str>,
) -> Request<bool> {
    report.provenance.complete = true;
    report.write_data(&options.out).map_err(|e| e.to_string())?;
    bar.finish_and_clear();
    if let Some(path) = &options.save {
        write(path, report.to_json())?;
    }
    if !options.quiet {
        print(&report.to_text())?;
        print(&format!("\nReport and plots are in {}\n", options.out.display()))?;
    }
    let mut same = true;
    if let Some(text) = baseline {
        let changes = changes(text, &report).map_err(|e| e.to_string())?;
        print(&format!("\n{changes}"))?;
        print("ratios of times, of runs made now:\n")?;
        print(&report.verdicts().iter().map(|v| format!("  {v}\n")).collect::<String>())?;
        same = changes.changed.is_empty();
    }
    Ok(same && report.failures().is_empty())
}

/// The mesh, the parameter of the scenes and the adaptive refinement, for the heading of the report.
fn setting(options: &Options) -> String {
    let mesh = options.mesh.path.as_ref().and_then(|path| path.file_name());
    let mesh = mesh.map(|name| format!("refinements of {}", excerpt(name.as_encoded_bytes())));
    let contrast = options.contrast.map(|x| format!("contrast {x:e}"));
    let adaptive = options.adaptive.as_ref().map(|of| format!("adaptive meshes: {}", words(of)));
    [mesh, contrast, adaptive].into_iter().flatten().collect::<Vec<_>>().join(", ")
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
    (schemes, file): (&[NamedScheme], Option<&GmshFile>),
    bar: &'a ProgressBar,
    posed: Posed<D>,
    labels: &RefCell<BTreeSet<String>>,
) -> Request<Run<'a>> {
    let place = match &options.problem {
        Some(path) => path.display().to_string(),
        None => format!("scene {}", posed.name()),
    };
    if !posed.has_exact() && options.reference.is_none() && !options.quiet {
        let reference = "--reference N measures against a fine solution";
        warn(&format!(
            "warning: {place}: only bounds are reached, for no error is known; {reference}"
        ));
    }
    // warnings of a mesh are those of its first scene
    let is_first = labels.borrow().is_empty();
    let warn = |warning: String| {
        if is_first && !options.quiet {
            warn(&warning)
        }
    };
    let mesh = file.map(|file| options.mesh.mesh::<D>(file, &warn)).transpose()?;
    let has_mesh = mesh.is_some() || posed.has_mesh();
    let mut study = posed.work_precision(&warn)?.levels(options.levels(D, has_mesh));
    if let Some(mesh) = mesh {
        study = study.on_mesh(mesh);
    }
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
        .precisions(options.precisions())
        .rounds(options.rounds())
        .limit(options.limit)
        .subject(options.subject.as_deref().unwrap_or(SUBJECT))
        .write_to(&options.out)
        .memory(|case| memory_of(case, options))
        .empty_memory(empty_memory(options))
        .observer(|progress| match progress {
            WorkProgress::Finished => bar.inc(1),
            WorkProgress::Started(case, round) => {
                let v = &case.variant;
                let meshes = match case.is_adaptive() {
                    true => v.meshes.clone(),
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

/// The peak of memory of a process that runs this case and nothing else.
fn memory_of(case: &Case, options: &Options) -> Option<u64> {
    let v = &case.variant;
    let mut command = peak_command(options)?;
    match &options.problem {
        Some(path) => command.arg(path),
        None => command.args(["--scene", &v.scene]),
    };
    command.args(["--scheme", &v.label]);
    command.args(["--linear", &v.linear_asked, "--precision", &v.precision]);
    command.args(["--levels", &case.level.to_string()]);
    if let Some(path) = &options.mesh.path {
        command.arg("--mesh").arg(path);
    }
    for (name, part) in &options.mesh.boundary {
        command.args(["--boundary", &format!("{name}={}", part.name())]);
    }
    if let Some(x) = options.contrast {
        command.args(["--contrast", &format!("{x:e}")]);
    }
    printed_number(command)
}

/// The peak of memory of a process that runs nothing.
fn empty_memory(options: &Options) -> Option<u64> {
    let mut command = peak_command(options)?;
    command.arg("--empty");
    printed_number(command)
}

/// This program, to print a peak of memory.
fn peak_command(options: &Options) -> Option<Command> {
    let mut command = Command::new(std::env::current_exe().ok()?);
    command.args(["work-precision", "--peak"]);
    if let Some(threads) = options.threads() {
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    Some(command)
}

fn printed_number(mut command: Command) -> Option<u64> {
    let output = command.output().ok()?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}

/// Runs one case, or none, and prints what memory it took.
fn peak(options: &Options) -> Request<bool> {
    if !options.empty {
        run_one(options)?;
    }
    let bytes = peak_memory_bytes().ok_or("the system does not tell")?;
    print(&format!("{bytes}\n"))?;
    Ok(true)
}

fn run_one(options: &Options) -> Request<()> {
    let one = "--peak runs one case";
    if let Some(path) = &options.problem {
        return match problem_file::read(path).map_err(|e| e.to_string())? {
            AnyOwnProblem::One(own) => once::<1>(options, own.into()),
            AnyOwnProblem::Two(own) => once::<2>(options, own.into()),
            AnyOwnProblem::Three(own) => once::<3>(options, own.into()),
        };
    }
    let name = options.scenes().pop().ok_or(one)?;
    match scene(options, &name)? {
        AnyScene::One(s) => once::<1>(options, s.into()),
        AnyScene::Two(s) => once::<2>(options, s.into()),
        AnyScene::Three(s) => once::<3>(options, s.into()),
    }
}

fn once<const D: usize>(options: &Options, posed: Posed<D>) -> Request<()> {
    let mesh = options.mesh.read_mesh(&|_| {})?;
    let has_mesh = mesh.is_some() || posed.has_mesh();
    let mut study = posed.study(&|_| {})?;
    if let Some(mesh) = mesh {
        study = study.on_mesh(mesh);
    }
    let linear = options.linear().first().copied().unwrap_or(LinearMethod::BySize);
    let precision = options.precisions().first().copied().unwrap_or_default();
    let solver = in_precision(precision, ActiveSet::default().linear(linear));
    let study = study.levels(options.levels(D, has_mesh)).boxed_solver(solver);
    let schemes = options.schemes()?;
    let study = schemes.iter().fold(study, Study::named_scheme);
    study.run().map(drop).map_err(|e| e.to_string())
}
