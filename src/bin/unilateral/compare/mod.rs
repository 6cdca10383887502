//! Schemes side by side on the same inequality: errors, observed orders, times and a certificate.
//!
//! `cargo run --release -- compare --help` lists the options. Exit codes: 0 if every row converged,
//! 1 if some did not or the run could not go on, 2 if the request was wrong, 130 if it was interrupted.

mod interrupt;
mod options;
mod watcher;

use std::fs::{self, OpenOptions};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use interrupt::Interrupt;
pub use options::{Options, list};
use options::{check_numbers, choose, choose_schemes};
use watcher::Watcher;

use crate::shared::{
    ORDER_TOLERANCE, Request, cannot_write, complain, each_once, print, print_to, read,
    use_threads, write,
};

use unilateral::error::Error;
use unilateral::inequality::{SOLVERS, SolverOptions, solver_by_name};
use unilateral::linear::LinearMethod;
use unilateral::mesh::{Mesh, gmsh};
use unilateral::nested::Solved;
use unilateral::paraview::FieldScalar;
use unilateral::plot::Picture;
use unilateral::real::Real;
use unilateral::scenes::{self, AcceptedParameters, AnyScene, Parameters, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::orders_table;
use unilateral::study::{
    Journal, Program, Report, Row, RowKey, Study, available_memory_bytes, file_name,
};

/// Whether every row converged.
pub fn run(options: &Options) -> Request<bool> {
    if options.list {
        return print(&list()).map(|()| true);
    }
    check_numbers(options)?;
    use_threads(options.threads)?;
    let copy = options.clone();
    let interrupt = Interrupt::install(move |report| write_all(&copy, report))?;
    let chosen = Chosen::new(options)?;
    match &options.precision[..] {
        "f32" => chosen.run::<f32>(options, &interrupt),
        _ => chosen.run::<f64>(options, &interrupt),
    }
}

/// The program, with all that its rows depend on and do not say.
fn program<T: Real>(options: &Options, mesh: Option<&[u8]>) -> Program {
    let threads = rayon::current_num_threads();
    let mut program = Program::new("compare", T::NAME, threads, options.repeat);
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
    if let Some(bytes) = mesh {
        // the hash of Fowler, Noll and Vo, which has the same value on every machine
        let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325, step);
        program = program.with_request("mesh", format!("{} bytes {hash:016x}", bytes.len()));
    }
    program
}

/// What the options ask for, with every name found.
struct Chosen {
    scenes: Vec<AnyScene>,
    schemes: Vec<NamedScheme>,
    solvers: Vec<String>,
    mesh: Option<(usize, Vec<u8>)>,
}

impl Chosen {
    fn new(options: &Options) -> Request<Self> {
        let mesh = match &options.mesh {
            None => None,
            Some(path) => {
                let bytes = read(path)?;
                let dimension =
                    gmsh::dimension(&bytes).map_err(|e| format!("{}: {e}", path.display()))?;
                Some((dimension, bytes))
            }
        };
        let schemes = choose_schemes(options)?;
        let solvers: Vec<&str> = SOLVERS.iter().map(|s| s.0).collect();
        let solvers = choose("solver", &options.solvers, &["active-set"], &solvers)?;
        let scenes = Self::scenes(options, mesh.as_ref().map(|m| m.0))?;
        Ok(Self { scenes, schemes, solvers, mesh })
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
    fn run<T: Real>(self, options: &Options, interrupt: &Interrupt) -> Request<bool> {
        let Self { scenes, schemes, solvers, mesh } = self;
        let names = (&schemes[..], &solvers[..]);
        let mesh = mesh.as_ref();
        let watcher = Watcher::new(options);
        let mut runs = Vec::new();
        for scene in scenes {
            runs.extend(match scene {
                AnyScene::One(scene) => prepare::<T, 1>(scene, options, names, mesh, &watcher)?,
                AnyScene::Two(scene) => prepare::<T, 2>(scene, options, names, mesh, &watcher)?,
                AnyScene::Three(scene) => prepare::<T, 3>(scene, options, names, mesh, &watcher)?,
            });
        }
        if runs.is_empty() {
            return Err("no scene fits the mesh; name one to be told why".to_owned());
        }
        let program = program::<T>(options, mesh.map(|(_, bytes)| &bytes[..]));
        let journal = start(options, program.clone(), &runs)?;
        interrupt.watch(journal);
        let all = || -> Request<Vec<Vec<Row>>> {
            runs.into_iter().map(|Run { run, .. }| run(journal)).collect()
        };
        // a panic has printed its message
        let rows = catch_unwind(AssertUnwindSafe(all)).unwrap_or_else(|_| Err(String::new()));
        watcher.clear();
        let report = match &rows {
            Ok(rows) => Report::new(program, rows.concat()),
            Err(_) => journal.report(),
        };
        let messages = [rows.err(), interrupt.at_end(|| write_all(options, &report)).err()];
        messages.iter().flatten().filter(|text| !text.is_empty()).for_each(|text| complain(text));
        Ok(messages == [None, None] && report.rows.iter().all(Row::converged))
    }
}

/// Makes sure that the files can be written and starts the journal. With `--resume` it has the rows that
/// are there, of which the runs must ask for every one.
fn start(options: &Options, program: Program, runs: &[Run<'_>]) -> Request<&'static Journal> {
    check_output(options)?;
    let journal = match options.resume {
        true => {
            let keys: Vec<RowKey> = runs.iter().flat_map(|run| run.keys.clone()).collect();
            Journal::resume(&options.out, program, &keys)
        }
        false => Journal::create(&options.out, program),
    };
    let journal = journal.map_err(|e| e.to_string())?;
    // the thread that ends an interrupted run may need the journal as long as the process lives
    Ok(Box::leak(Box::new(journal)))
}

/// A study that has been checked.
struct Run<'a> {
    /// What tells its rows apart.
    keys: Vec<RowKey>,
    run: Box<dyn FnOnce(&'a Journal) -> Request<Vec<Row>> + 'a>,
}

/// Most cells of a solution that is drawn: pictures of more are large and show no more.
const MOST_CELLS: usize = 5000;

/// Checks a study. Nothing is left of one that does not fit the mesh and was not asked for by name.
fn prepare<'a, T: Real, const D: usize>(
    scene: Scene<D>,
    options: &'a Options,
    (schemes, solvers): (&[NamedScheme], &[String]),
    mesh: Option<&(usize, Vec<u8>)>,
    watcher: &'a Watcher,
) -> Request<Option<Run<'a>>> {
    let name = scene.name.clone();
    let levels = match &options.levels[..] {
        [] => default_levels(D, mesh.is_some()),
        some => each_once(some),
    };
    let linear = match options.linear.as_deref() {
        Some("direct") => LinearMethod::Direct,
        Some(_) => LinearMethod::Iterative,
        None => LinearMethod::BySize,
    };
    let mut study = Study::<T, D>::new(scene)
        .levels(levels)
        .repeat(options.repeat)
        .observer(|progress| watcher.tell(&progress));
    let scene_name = name.clone();
    study = study.each_solution(move |label, level, solved| {
        draw(&format!("{scene_name}-{label}"), level, solved, &options.out)
    });
    if !options.no_fields {
        let is_double = options.fields == "f64";
        let scalar = if is_double { FieldScalar::Double } else { FieldScalar::Single };
        study = study.fields_to(&options.out).field_scalar(scalar);
    }
    if options.fields_of_all_levels {
        study = study.fields_of_all_levels();
    }
    study = schemes.iter().fold(study, Study::named_scheme);
    for name in solvers {
        study = solver_by_name(name, &SolverOptions::default().linear(linear))
            .map(|solver| study.boxed_solver(solver))
            .ok_or_else(|| format!("there is no solver {name}"))?;
    }
    let mut place = format!("scene {name}");
    if let (Some((_, bytes)), Some(path)) = (mesh, &options.mesh) {
        place = format!("{}, {place}", path.display());
        study = study.on_mesh(read_mesh(bytes, path, watcher)?);
    }
    match study.check() {
        Err(Error::UnfitMesh { .. }) if !options.scenes_are_named() => return Ok(None),
        other => other.map_err(|e| format!("{place}: {e}"))?,
    }
    if let (Some(need), Some(free)) = (study.memory_estimate(), available_memory_bytes())
        && need.bytes > free as f64
    {
        return Err(format!(
            "scene {name}, scheme {}, level {}: would need about {:.1} GB of memory, {:.1} GB are available; choose a lower level",
            need.scheme,
            need.level,
            need.bytes / 1e9,
            free as f64 / 1e9
        ));
    }
    let keys = study.keys();
    watcher.expect(D, keys.iter().map(|key| key.level));
    let run = move |journal| match study.journal(journal).run() {
        Ok(report) => Ok(report.rows),
        Err(e) => Err(format!("{place}: {e}")),
    };
    Ok(Some(Run { keys, run: Box::new(run) }))
}

/// Draws a solution with few cells as `NAME.svg`; one on a finer mesh takes the place of a coarser one.
fn draw<T: Real, const D: usize>(
    name: &str,
    level: usize,
    solved: &Solved<'_, T, D>,
    directory: &Path,
) -> Result<(), Error> {
    let Some(fields) = solved.fields().filter(|_| solved.mesh().n_cells() <= MOST_CELLS) else {
        return Ok(());
    };
    let title = format!("{name}, level {level}");
    let problem = solved.discretisation().problem();
    let picture = Picture::of(&title, problem, solved.mesh(), &fields, None)?;
    picture.write_svg(&directory.join(file_name(name) + ".svg"))
}

fn read_mesh<T: Real, const D: usize>(
    bytes: &[u8],
    path: &Path,
    watcher: &Watcher,
) -> Request<Mesh<T, D>> {
    let read = gmsh::parse::<T, D>(bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    for warning in &read.warnings {
        watcher.warn_once(format!("warning: {}: {warning}", path.display()));
    }
    Ok(read.mesh)
}

fn default_levels(dimension: usize, on_mesh: bool) -> Vec<usize> {
    match dimension {
        _ if on_mesh => vec![0, 1],
        3 => vec![2, 4, 8],
        _ => vec![16, 32, 64, 128, 256],
    }
}

/// Makes sure before the work, not after it, that the report can be written.
fn check_output(options: &Options) -> Request<()> {
    let json = options.json.as_ref().filter(|p| p.as_os_str() != "-");
    for path in json.into_iter().chain(&options.orders) {
        let file_is_new = !path.exists();
        OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .map_err(|e| cannot_write(path, e))?;
        if file_is_new {
            fs::remove_file(path).map_err(|e| cannot_write(path, e))?;
        }
    }
    Ok(())
}

/// Writes the report and prints its tables, of an incomplete one the files only.
fn write_all(options: &Options, report: &Report) -> Request<()> {
    let to_stdout = options.json.as_deref().is_some_and(|p| p.as_os_str() == "-");
    report.write(&options.out).map_err(|e| e.to_string())?;
    match &options.json {
        Some(_) if to_stdout => print(&report.to_json())?,
        Some(path) => write(path, report.to_json())?,
        None => {}
    }
    if let Some(path) = &options.orders {
        write(path, orders_table(&report.observed_orders(), ORDER_TOLERANCE))?;
    }
    if options.quiet || !report.complete {
        return Ok(());
    }
    let out = options.out.display();
    let end = format!("\nTimes are in seconds. Report, plots and fields are in {out}\n");
    let text = report.to_string() + &end;
    if to_stdout { print_to(std::io::stderr(), &text) } else { print(&text) }
}
