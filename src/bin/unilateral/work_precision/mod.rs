//! Work against precision: what schemes, linear solvers and scalars take to reach a given error.
//!
//! `cargo run --release -- work-precision --help` lists the options; `--quick` ends within a minute.
//! Exit codes: 0 if every run converged and nothing changed against the baseline, 1 otherwise, 2 if
//! the request was wrong.

mod options;

use std::process::Command;

use indicatif::ProgressBar;
pub use options::Options;
use unilateral::inequality::ActiveSet;
use unilateral::input::excerpt;
use unilateral::linear::LinearMethod;
use unilateral::problem_file::{self, AnyOwnProblem, Geometry, OwnProblem};
use unilateral::real::Real;
use unilateral::scenes::{self, AnyScene, Parameters, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Study, peak_memory_bytes};
use unilateral::work_precision::{
    Case, Precision, WorkPrecision, WorkProgress, WorkReport, changes,
};

use crate::posed::Posed;
use crate::shared::{Request, bar, print, read, tick, use_threads, write};

/// Whether every run converged and nothing changed.
pub fn run(options: &Options) -> Request<bool> {
    options.check()?;
    let schemes = options.schemes()?;
    if options.peak {
        return peak(options);
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
    let bar = bar(options.quiet, planned(options, &schemes), template);
    tick(&bar);
    for name in options.scenes() {
        match scene(options, &name)? {
            AnyScene::One(s) => study(options, &schemes, &bar, s, &mut report),
            AnyScene::Two(s) => study(options, &schemes, &bar, s, &mut report),
            AnyScene::Three(s) => study(options, &schemes, &bar, s, &mut report),
        }
        .map_err(|e| format!("scene {name}: {e}"))?;
    }
    if let Some(path) = &options.problem {
        match problem_file::read(path).map_err(|e| e.to_string())? {
            AnyOwnProblem::One(own) => study_own(options, &schemes, &bar, own, &mut report),
            AnyOwnProblem::Two(own) => study_own(options, &schemes, &bar, own, &mut report),
            AnyOwnProblem::Three(own) => study_own(options, &schemes, &bar, own, &mut report),
        }
        .map_err(|e| format!("{}: {e}", path.display()))?;
    }
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
    if let Some(text) = &baseline {
        let changes = changes(text, &report).map_err(|e| e.to_string())?;
        print(&format!("\n{changes}"))?;
        print("ratios of times, of runs made now:\n")?;
        print(&report.verdicts().iter().map(|v| format!("  {v}\n")).collect::<String>())?;
        same = changes.changed.is_empty();
    }
    Ok(same && report.failures().is_empty())
}

/// The mesh and the parameter of the scenes, for the heading of the report.
fn setting(options: &Options) -> String {
    let mesh = options.mesh.path.as_ref().and_then(|path| path.file_name());
    let mesh = mesh.map(|name| format!("refinements of {}", excerpt(name.as_encoded_bytes())));
    let contrast = options.contrast.map(|x| format!("contrast {x:e}"));
    [mesh, contrast].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// A scene by name with the parameter of the options, if it takes one.
fn scene(options: &Options, name: &str) -> Request<AnyScene> {
    let entry = scenes::by_name(name).ok_or_else(|| format!("there is no scene {name}"))?;
    let contrast = options.contrast.filter(|_| entry.accepts.contrast);
    entry.make(&Parameters::new().with_contrast(contrast)).map_err(|e| e.to_string())
}

/// How many runs there will be on all scenes, unless some take too long.
fn planned(options: &Options, schemes: &[NamedScheme]) -> usize {
    let variants = schemes.len() * options.linear().len() * options.precisions().len();
    let of_scene = |name: &String| {
        let has_mesh = options.mesh.path.is_some();
        let levels = scenes::by_name(name).map(|entry| options.levels(entry.dimension, has_mesh));
        let mut levels = levels.unwrap_or_default();
        levels.sort_unstable();
        levels.dedup();
        levels.len()
    };
    variants * options.rounds() * options.scenes().iter().map(of_scene).sum::<usize>()
}

/// Measures a scene and adds it to the report.
fn study<const D: usize>(
    options: &Options,
    schemes: &[NamedScheme],
    bar: &ProgressBar,
    first: Scene<D>,
    report: &mut WorkReport,
) -> Request<()>
where
    AnyScene: Pick<D>,
{
    let name = first.name.clone();
    let remake = move || match scene(options, &name).ok().and_then(Pick::<D>::pick) {
        Some(scene) => scene,
        None => unreachable!("it was made before"),
    };
    let mut study = WorkPrecision::<D>::new(remake);
    let on_mesh = options.mesh.read(&|_| {})?;
    let has_mesh = on_mesh.is_some();
    if let Some(mesh) = on_mesh {
        study = study.on_mesh(mesh);
    }
    run_study(options, schemes, bar, study.levels(options.levels(D, has_mesh)), report)
}

/// Measures a problem of a file and adds it to the report.
fn study_own<const D: usize>(
    options: &Options,
    schemes: &[NamedScheme],
    bar: &ProgressBar,
    own: OwnProblem<D>,
    report: &mut WorkReport,
) -> Request<()> {
    let (study, has_mesh) = match own.mesh::<f64>().map_err(|e| e.to_string())? {
        Some(read) => {
            let study = WorkPrecision::of_problem(&own.name, own.problem, read.mesh);
            (study.map_err(|e| e.to_string())?, true)
        }
        None => {
            let Geometry::Box(domain) = own.geometry else {
                return Err("a problem has a mesh or a box".to_owned());
            };
            let scene = Scene::new(own.name, domain, own.problem);
            (WorkPrecision::new(move || scene.clone()), false)
        }
    };
    let levels = options.levels(D, has_mesh);
    let variants = schemes.len() * options.linear().len() * options.precisions().len();
    bar.inc_length((variants * options.rounds() * levels.len()) as u64);
    run_study(options, schemes, bar, study.levels(levels), report)
}

/// Runs a study with the settings of the options and adds it to the report.
fn run_study<const D: usize>(
    options: &Options,
    schemes: &[NamedScheme],
    bar: &ProgressBar,
    study: WorkPrecision<'_, D>,
    report: &mut WorkReport,
) -> Request<()> {
    let study = study
        .linear(options.linear())
        .precisions(options.precisions())
        .rounds(options.rounds())
        .limit(options.limit)
        .subject(&options.subject)
        .write_to(&options.out)
        .memory(|case| memory_of(case, options))
        .empty_memory(empty_memory(options))
        .observer(|progress| match progress {
            WorkProgress::Finished => bar.inc(1),
            WorkProgress::Started(case, round) => {
                let v = &case.variant;
                bar.set_message(format!(
                    "{}, {}, level {}, round {}",
                    v.scene,
                    v.label,
                    case.level,
                    round + 1
                ));
            }
            // what is planned counts for nothing: the bar was made for all scenes
            _ => {}
        });
    let mut study = schemes.iter().fold(study, WorkPrecision::named_scheme);
    if let Some((scheme, level)) = &options.reference {
        study = study.named_reference(scheme, *level);
    }
    study.run_into(report).map_err(|e| e.to_string())
}

/// The scene of a dimension, if it is of that dimension.
trait Pick<const D: usize> {
    fn pick(self) -> Option<Scene<D>>;
}

impl Pick<1> for AnyScene {
    fn pick(self) -> Option<Scene<1>> {
        if let AnyScene::One(scene) = self { Some(scene) } else { None }
    }
}

impl Pick<2> for AnyScene {
    fn pick(self) -> Option<Scene<2>> {
        if let AnyScene::Two(scene) = self { Some(scene) } else { None }
    }
}

impl Pick<3> for AnyScene {
    fn pick(self) -> Option<Scene<3>> {
        if let AnyScene::Three(scene) = self { Some(scene) } else { None }
    }
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
    let is_single = options.precisions().first() == Some(&Precision::Single);
    if let Some(path) = &options.problem {
        return match problem_file::read(path).map_err(|e| e.to_string())? {
            AnyOwnProblem::One(own) if is_single => once::<f32, 1>(options, own.into()),
            AnyOwnProblem::One(own) => once::<f64, 1>(options, own.into()),
            AnyOwnProblem::Two(own) if is_single => once::<f32, 2>(options, own.into()),
            AnyOwnProblem::Two(own) => once::<f64, 2>(options, own.into()),
            AnyOwnProblem::Three(own) if is_single => once::<f32, 3>(options, own.into()),
            AnyOwnProblem::Three(own) => once::<f64, 3>(options, own.into()),
        };
    }
    let name = options.scenes().pop().ok_or(one)?;
    match scene(options, &name)? {
        AnyScene::One(s) if is_single => once::<f32, 1>(options, s.into()),
        AnyScene::One(s) => once::<f64, 1>(options, s.into()),
        AnyScene::Two(s) if is_single => once::<f32, 2>(options, s.into()),
        AnyScene::Two(s) => once::<f64, 2>(options, s.into()),
        AnyScene::Three(s) if is_single => once::<f32, 3>(options, s.into()),
        AnyScene::Three(s) => once::<f64, 3>(options, s.into()),
    }
}

fn once<T: Real, const D: usize>(options: &Options, posed: Posed<D>) -> Request<()> {
    let mesh = options.mesh.read(&|_| {})?;
    let has_mesh = mesh.is_some() || posed.has_mesh();
    let mut study = posed.study::<T>(&|_| {})?;
    if let Some(mesh) = mesh {
        study = study.on_mesh(mesh);
    }
    let linear = options.linear().first().copied().unwrap_or(LinearMethod::BySize);
    let study =
        study.levels(options.levels(D, has_mesh)).solver(ActiveSet::default().linear(linear));
    let schemes = options.schemes()?;
    let study = schemes.iter().fold(study, Study::named_scheme);
    study.run().map(drop).map_err(|e| e.to_string())
}
