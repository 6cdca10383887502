//! Schemes side by side on the same inequality: errors, observed orders, times and a certificate.
//!
//! `cargo run --release -- compare --help` lists the options.

mod dump;
mod interrupt;
mod options;
#[cfg(feature = "petsc")]
mod over_processes;
mod prepare;
mod watcher;

use std::path::PathBuf;

use dump::write_requests;
use interrupt::Interrupt;
pub use options::{Options, list};
use options::{check_numbers, choose_schemes};
pub use prepare::with_solvers;
use prepare::{Run, prepare};
use watcher::Watcher;

use crate::asked::{FoundScenes, choose};
use crate::one_run::take_directory;
use crate::shared::{
    Request, check_writable, complain, print, print_to, terminal_width, use_threads, write,
};

use unilateral::in_its_dimension;
use unilateral::inequality::SOLVERS;
use unilateral::input::excerpt;
use unilateral::scenes::AnyScene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Journal, Program, Report, Row, RowKey};

/// The label of which the verdicts of rounds speak by default.
const SUBJECT: &str = "wopsip";

/// The message where scenes that nobody named do not fit the mesh.
const NO_SCENE_FITS: &str = "no scene fits the mesh; name one to be told why";

/// Whether every row converged.
pub fn run(options: &Options) -> Request<bool> {
    if options.list {
        return print(&list()).map(|()| true);
    }
    if processes_of_job() > 1 || options.engine.is_some() {
        return run_over_processes(options);
    }
    check_numbers(options)?;
    use_threads(options.asked.threads)?;
    let copy = options.clone();
    let cannot_resume = [options.asked.adaptive.is_some(), options.dump.is_some()];
    let resumes = options.rounds.is_none() && cannot_resume == [false; 2];
    let interrupt = Interrupt::install(resumes, move |report| write_all(&copy, report))?;
    let watcher = Watcher::new(options);
    Chosen::new(options, &watcher)?.run(options, &watcher, &interrupt)
}

/// How many processes the launcher of an MPI job has started; one without a launcher.
fn processes_of_job() -> usize {
    let variables = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"];
    let count = |name: &&str| std::env::var(name).ok()?.parse().ok();
    variables.iter().find_map(count).unwrap_or(1)
}

#[cfg(feature = "petsc")]
fn run_over_processes(options: &Options) -> Request<bool> {
    over_processes::run(options)
}
#[cfg(not(feature = "petsc"))]
fn run_over_processes(_: &Options) -> Request<bool> {
    Err("several processes and --engine need a program with PETSc: cargo build --release --features petsc"
        .to_owned())
}

/// The program, with all that its rows depend on and do not say.
fn program(options: &Options, files: &[(&str, String)]) -> Program {
    let threads = rayon::current_num_threads();
    let (name, repeat) =
        options.rounds.map_or(("compare", options.repeat), |count| ("work-precision", count));
    let program = Program::new(name, &options.precision, threads, repeat);
    let mut program = options.asked.stated_in(program, files);
    program.subject = Some(options.subject.clone().unwrap_or(SUBJECT.to_owned()));
    let program = match options.history {
        true => program.with_request("history", "after every outer step"),
        false => program,
    };
    let program = match options.tolerance {
        Some(share) => program.with_request("tolerance", share),
        None => program,
    };
    match options.linear == "by-size" {
        true => program,
        false => program.with_request("linear", &options.linear),
    }
}

/// Refuses a subject that no scheme is.
fn check_subject(options: &Options, schemes: &[NamedScheme]) -> Request<()> {
    let labels: Vec<String> = schemes.iter().map(NamedScheme::to_string).collect();
    match options.subject.as_ref().filter(|subject| !labels.contains(subject)) {
        None => Ok(()),
        Some(subject) => Err(format!(
            "--subject {}: no scheme has this label; there are: {}",
            excerpt(subject),
            labels.join(", ")
        )),
    }
}

/// The scenes, schemes and solvers that the options name.
struct Chosen {
    /// The scenes, on the mesh of the command line if there is one, or the problem of a file.
    scenes: Vec<AnyScene>,
    schemes: Vec<NamedScheme>,
    solvers: Vec<String>,
    /// The names and fingerprints of the files that have been read.
    fingerprints: Vec<(&'static str, String)>,
    /// The paths of these files.
    inputs: Vec<PathBuf>,
}

impl Chosen {
    fn new(options: &Options, watcher: &Watcher) -> Request<Self> {
        let schemes = choose_schemes(options)?;
        check_subject(options, &schemes)?;
        let solvers: Vec<&str> = SOLVERS.iter().map(|s| s.0).collect();
        let solvers = choose("solver", &options.solvers, &["active-set"], &solvers)?;
        let warn = |warning| watcher.warn_once(warning);
        let default = match options.asked.mesh.path {
            None => ["hill-2d", "signorini-halves-2d"],
            // their data are those of the solution on any mesh
            Some(_) => ["radial-2d", "signorini-2d"],
        };
        let FoundScenes { scenes, fingerprints, paths } = options.asked.scenes(&default, &warn)?;
        Ok(Self { scenes, schemes, solvers, fingerprints, inputs: paths })
    }

    /// Whether every row converged. Nothing runs and nothing is written before everything has been
    /// checked; afterwards no finished row is lost.
    fn run(self, options: &Options, watcher: &Watcher, interrupt: &Interrupt) -> Request<bool> {
        let Self { scenes, schemes, solvers, fingerprints: files, inputs } = self;
        let names = (&schemes[..], &solvers[..]);
        let mut runs = Vec::new();
        for scene in scenes {
            let run = in_its_dimension!(scene, |scene| prepare(scene, options, names, watcher));
            runs.extend(run?);
        }
        if runs.is_empty() {
            return Err(NO_SCENE_FITS.to_owned());
        }
        let program = program(options, &files);
        let contents: Vec<String> = files.into_iter().map(|(_, fingerprint)| fingerprint).collect();
        check_output(options, &inputs)?;
        let journal = start(options, program.clone(), &runs)?;
        interrupt.watch(journal);
        let (rows, mut messages) = run_all(runs, options, &contents, journal);
        watcher.clear();
        let report = match messages.is_empty() {
            true => Report::new(program, rows),
            false => journal.report(),
        };
        messages.extend(interrupt.at_end(|| write_all(options, &report)).err());
        messages.extend(show(options, &report).err());
        messages.iter().for_each(|text| complain(text));
        Ok(messages.is_empty() && report.rows.iter().all(Row::converged))
    }
}

/// The rows of all runs, and why there are not more.
fn run_all(
    runs: Vec<Run<'_>>,
    options: &Options,
    contents: &[String],
    journal: &'static Journal,
) -> (Vec<Row>, Vec<String>) {
    let (mut rows, mut messages) = (Vec::new(), Vec::new());
    let mut requests = runs.iter().map(|run| write_requests(options, contents, &run.keys));
    if let Err(why) = requests.try_for_each(|written| written) {
        return (rows, vec![why]);
    }
    for Run { place, run, .. } in runs {
        match run(journal) {
            Ok(found) => rows.extend(found),
            Err(error) => {
                messages.push(format!("{place}: {error}"));
                // the next scene could not be written either
                if journal.is_closed() {
                    break;
                }
            }
        }
    }
    (rows, messages)
}

/// Starts the journal. With `--resume` it has the rows that are there, of which the runs must ask for every one.
fn start(options: &Options, program: Program, runs: &[Run<'_>]) -> Request<&'static Journal> {
    let journal = match options.resume {
        true => {
            let keys: Vec<RowKey> = runs.iter().flat_map(|run| run.keys.clone()).collect();
            Journal::resume(&options.out, program, &keys)
        }
        false => {
            if let Ok(earlier) = Report::read(&options.out) {
                earlier.remove_files(&options.out);
            }
            Journal::create(&options.out, program)
        }
    };
    let journal = journal.map_err(|e| e.to_string())?;
    // the thread that ends an interrupted run may need the journal as long as the process lives
    Ok(Box::leak(Box::new(journal)))
}

/// Makes sure before the work, not after it, that the report can be written, over no file that was read, and by no
/// other run.
fn check_output(options: &Options, inputs: &[PathBuf]) -> Request<()> {
    if let Some(json) = options.json.as_ref().filter(|path| path.as_os_str() != "-") {
        check_writable(json, inputs)?;
    }
    let mut directories = options.dump.iter().chain([&options.out]);
    directories.try_for_each(|directory| take_directory(directory))
}

/// Writes the report and prints its tables, of an incomplete one the files only.
fn write_all(options: &Options, report: &Report) -> Request<()> {
    let to_stdout = options.json.as_deref().is_some_and(|p| p.as_os_str() == "-");
    let files = report.write(&options.out);
    let json = match &options.json {
        Some(_) if to_stdout => print(&report.to_json()),
        Some(path) => write(path, report.to_json()),
        None => Ok(()),
    };
    files.map_err(|e| e.to_string()).and(json)
}

/// Prints the tables of a run that ended of itself.
fn show(options: &Options, report: &Report) -> Request<()> {
    if options.asked.quiet || report.rows.is_empty() {
        return Ok(());
    }
    let (out, is_whole, width) = (options.out.display(), report.complete, terminal_width());
    let tables = match (options.rounds, options.details) {
        (Some(_), _) => {
            format!("{}\n{}", report.details_to_text(width), report.work_to_text(width))
        }
        (None, true) => {
            format!("{}\n{}", report.summary_to_text(width), report.details_to_text(width))
        }
        (None, false) => report.summary_to_text(width),
    };
    let shows_all = options.details || options.rounds.is_some();
    let more = if shows_all { "" } else { "; --details shows all levels" };
    let files = match (is_whole, options.rounds) {
        (false, _) => "The incomplete report is",
        (_, Some(_)) => "Report and plots are",
        (_, None) => "Report, plots and fields are",
    };
    let dump = options.dump.as_ref().map(|to| format!(". Inequalities are in {}", to.display()));
    let dump = dump.unwrap_or_default();
    let text = format!("{tables}\nTimes are in seconds{more}. {files} in {out}{dump}\n");
    match options.json.as_deref().is_some_and(|path| path.as_os_str() == "-") {
        true => print_to(std::io::stderr(), &text),
        false => print(&text),
    }
}
