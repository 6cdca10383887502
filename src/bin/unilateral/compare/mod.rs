//! Schemes side by side on the same inequality: errors, observed orders, times and a certificate.
//!
//! `cargo run --release -- compare --help` lists the options. Exit codes: 0 if every row converged,
//! 1 if some did not or the run could not go on, 2 if the request was wrong, 130 if it was interrupted.

mod interrupt;
mod options;
#[cfg(feature = "petsc")]
mod over_processes;
mod prepare;
mod watcher;

use interrupt::Interrupt;
pub use options::{Options, list};
use options::{check_numbers, choose, choose_schemes};
use prepare::{Run, prepare};
use watcher::Watcher;

use crate::judge::write_requests;
use crate::one_run::take_directory;
use crate::shared::{
    ORDER_TOLERANCE, Request, check_writable, complain, print, print_to, problem, terminal_width,
    use_threads, warn, write,
};

use std::path::Path;

use unilateral::in_its_dimension;
use unilateral::inequality::SOLVERS;
use unilateral::input::excerpt;
use unilateral::mesh::gmsh::GmshFile;
use unilateral::problem_file::ProblemFile;
use unilateral::scenes::{self, AcceptedParameters, AnyScene, Parameters};
use unilateral::scheme::NamedScheme;
use unilateral::study::orders_table;
use unilateral::study::{Journal, Program, Report, Row, RowKey};

/// Whether every row converged.
pub fn run(options: &Options) -> Request<bool> {
    if options.list {
        return print(&list()).map(|()| true);
    }
    if processes_of_job() > 1 || options.engine.is_some() || options.verify {
        return run_over_processes(options);
    }
    check_numbers(options)?;
    use_threads(options.threads)?;
    let copy = options.clone();
    let resumes = options.adaptive.is_none() && options.dump.is_none();
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
    Err("several processes, --engine and --verify need a program with PETSc: cargo build --release --features petsc"
        .to_owned())
}

/// The program, with all that its rows depend on and do not say.
fn program(options: &Options, files: &[(&str, String)]) -> Program {
    let threads = rayon::current_num_threads();
    let words = std::env::args().skip(1);
    let mut program = Program::new("compare", &options.precision, threads, options.repeat)
        .with_command(std::iter::once("unilateral".to_owned()).chain(words));
    for (name, value) in
        [("scale", options.scale), ("contrast", options.contrast), ("load", options.load)]
    {
        if let Some(x) = value {
            program = program.with_request(name, format!("{x:?}"));
        }
    }
    if let Some(linear) = &options.linear {
        program = program.with_request("linear", linear);
    }
    if let Some((scheme, level)) = &options.reference {
        program = program.with_request("reference", format!("{scheme} at level {level}"));
    }
    if let Some(of) = &options.adaptive {
        program = program.with_request("adaptive", crate::adaptive::words(of));
        if let [level] = options.levels[..] {
            program = program.with_request("first level", level);
        }
    }
    for (name, part) in &options.mesh.boundary {
        program = program.with_request(&format!("boundary {name}"), part.name());
    }
    for (name, fingerprint) in files {
        program = program.with_request(name, fingerprint);
    }
    program
}

/// What the options ask for, with every name found.
struct Chosen {
    /// The scenes, on the mesh of the command line if there is one, or the problem of a file.
    scenes: Vec<AnyScene>,
    schemes: Vec<NamedScheme>,
    solvers: Vec<String>,
    /// The names and fingerprints of the files that have been read.
    fingerprints: Vec<(&'static str, String)>,
}

impl Chosen {
    fn new(options: &Options, watcher: &Watcher) -> Request<Self> {
        let warn = |warning| watcher.warn_once(warning);
        let mesh = options.mesh.read()?;
        let schemes = choose_schemes(options)?;
        let solvers: Vec<&str> = SOLVERS.iter().map(|s| s.0).collect();
        let solvers = choose("solver", &options.solvers, &["active-set"], &solvers)?;
        if let Some(path) = &options.problem {
            Self::check_problem(options, path)?;
            let ProblemFile { scene, fingerprints, .. } = problem(path, &warn)?;
            return Ok(Self { scenes: vec![scene], schemes, solvers, fingerprints });
        }
        let scenes = Self::scenes(options, mesh.as_ref().map(GmshFile::dimension))?;
        let on_mesh = |scene| options.mesh.under(scene, mesh.as_ref(), &warn);
        let scenes = scenes.into_iter().map(on_mesh).collect::<Request<_>>()?;
        let fingerprints = mesh.iter().map(|file| ("mesh", file.fingerprint())).collect();
        Ok(Self { scenes, schemes, solvers, fingerprints })
    }

    /// Refuses a problem file that is not there, and parameters of scenes beside one.
    fn check_problem(options: &Options, path: &Path) -> Request<()> {
        if !path.exists() {
            let path = excerpt(path.as_os_str().as_encoded_bytes());
            return Err(format!("there is no file {path}; scenes are named by --scene"));
        }
        let parameters =
            [("scale", options.scale), ("contrast", options.contrast), ("load", options.load)];
        match parameters.iter().find_map(|(n, x)| Some((n, (*x)?))) {
            None => Ok(()),
            Some((name, x)) => {
                let path = path.display();
                Err(format!("--{name} {x:?}: a parameter of scenes; {path} has none"))
            }
        }
    }

    fn scenes(options: &Options, mesh: Option<usize>) -> Request<Vec<AnyScene>> {
        let mut catalogue = scenes::catalogue();
        let names: Vec<&str> = catalogue.iter().map(|s| &s.name[..]).collect();
        let default = if mesh.is_some() { &names[..] } else { &["radial-2d", "signorini-2d"] };
        let wanted = choose("scene", &options.scenes, default, &names)?;
        // with a mesh, all scenes are all that live in its dimension
        let any_fitting = !options.scenes_are_named();
        catalogue.retain(|s| !any_fitting || mesh.is_none_or(|d| d == s.dimension));
        let takers = |parameter: &str,
                      accepts: fn(&AcceptedParameters) -> bool,
                      value: Option<f64>| {
            let takers: Vec<&str> =
                catalogue.iter().filter(|s| accepts(&s.accepts)).map(|s| &s.name[..]).collect();
            match value {
                Some(x) if !takers.iter().any(|s| wanted.iter().any(|w| w == s)) => Err(format!(
                    "--{parameter} {x:?}: none of the scenes chosen takes it; there are: {}",
                    if takers.is_empty() { "none".to_owned() } else { takers.join(", ") }
                )),
                _ => Ok(()),
            }
        };
        takers("scale", |t| t.scale, options.scale)?;
        takers("contrast", |t| t.contrast, options.contrast)?;
        takers("load", |t| t.load, options.load)?;
        let mut scenes = Vec::new();
        for entry in wanted.iter().filter_map(|name| catalogue.iter().find(|s| s.name == *name)) {
            if let Some(d) = mesh.filter(|&d| d != entry.dimension) {
                return Err(format!(
                    "the mesh has dimension {d}, scene {} has {}: choose a scene of dimension {d} (--list names them)",
                    entry.name, entry.dimension
                ));
            }
            // a parameter goes to the scenes that take it
            let parameters = Parameters::new()
                .with_scale(options.scale.filter(|_| entry.accepts.scale))
                .with_contrast(options.contrast.filter(|_| entry.accepts.contrast))
                .with_load(options.load.filter(|_| entry.accepts.load));
            scenes.push(entry.make(&parameters));
        }
        scenes.into_iter().collect::<Result<_, _>>().map_err(|e| e.to_string())
    }

    /// Whether every row converged. Nothing runs and nothing is written before everything has been
    /// checked; afterwards no finished row is lost.
    fn run(self, options: &Options, watcher: &Watcher, interrupt: &Interrupt) -> Request<bool> {
        let Self { scenes, schemes, solvers, fingerprints: files } = self;
        let names = (&schemes[..], &solvers[..]);
        let mut runs = Vec::new();
        for scene in scenes {
            let run = in_its_dimension!(scene, |scene| prepare(scene, options, names, watcher));
            runs.extend(run?);
        }
        if runs.is_empty() {
            return Err("no scene fits the mesh; name one to be told why".to_owned());
        }
        let program = program(options, &files);
        let contents: Vec<String> = files.into_iter().map(|(_, fingerprint)| fingerprint).collect();
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
    let write = |run: &Run<'_>| write_requests(options, contents, &run.keys);
    if let Err(why) = runs.iter().try_for_each(write) {
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

/// Makes sure that the files can be written and starts the journal. With `--resume` it has the rows that
/// are there, of which the runs must ask for every one.
fn start(options: &Options, program: Program, runs: &[Run<'_>]) -> Request<&'static Journal> {
    check_output(options)?;
    let journal = match options.resume {
        true => {
            if Journal::has_rows_alone(&options.out) {
                let out = options.out.display();
                warn(&format!(
                    "warning: {out}/report.jsonl does not say of which problem and options its rows are, and \
                     report.json is missing: rows of the same scene, scheme, solver and level are kept"
                ));
            }
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

/// Makes sure before the work, not after it, that the report can be written, and by no other run.
fn check_output(options: &Options) -> Request<()> {
    let json = options.json.as_ref().filter(|p| p.as_os_str() != "-");
    check_writable(json.into_iter().chain(&options.orders))?;
    options.dump.iter().chain([&options.out]).try_for_each(|directory| take_directory(directory))
}

/// Writes the report and prints its tables, of an incomplete one the files only.
fn write_all(options: &Options, report: &Report) -> Request<()> {
    let to_stdout = options.json.as_deref().is_some_and(|p| p.as_os_str() == "-");
    let files = report.write(&options.out).map_err(|e| e.to_string());
    let json = match &options.json {
        Some(_) if to_stdout => print(&report.to_json()),
        Some(path) => write(path, report.to_json()),
        None => Ok(()),
    };
    let orders = options.orders.as_ref().map_or(Ok(()), |path| {
        write(path, orders_table(&report.observed_orders(), ORDER_TOLERANCE))
    });
    files.and(json).and(orders)
}

/// Prints the tables of a run that ended of itself.
fn show(options: &Options, report: &Report) -> Request<()> {
    if options.quiet || report.rows.is_empty() {
        return Ok(());
    }
    let (out, is_whole) = (options.out.display(), report.complete);
    let files = if is_whole { "Report, plots and fields are" } else { "The incomplete report is" };
    let width = terminal_width();
    let details = match options.details {
        true => format!("\n{}", report.details_to_text(width)),
        false => String::new(),
    };
    let more = if options.details { "" } else { "; --details shows all levels" };
    let summary = report.summary_to_text(width);
    let text = format!("{summary}{details}\nTimes are in seconds{more}. {files} in {out}\n");
    match options.json.as_deref().is_some_and(|path| path.as_os_str() == "-") {
        true => print_to(std::io::stderr(), &text),
        false => print(&text),
    }
}
