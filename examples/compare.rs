//! Schemes side by side on the same inequality: errors, observed orders, times and a certificate.
//!
//! `cargo run --release --example compare -- --help` tells the options. Exit codes: 0 if every row
//! converged, 1 if some did not, 2 if the request was wrong.

use std::fs;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use unilateral::error::Error;
use unilateral::mesh::{Mesh, gmsh};
use unilateral::real::Real;
use unilateral::scenes::{self, AnyScene, Parameters, Scene};
use unilateral::study::{
    Program, Progress, Report, Row, SCHEMES, SchemeOptions, Study, scheme_by_name,
};

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Placement {
    Vertices,
    FacetMeans,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Precision {
    F64,
    F32,
}

/// Compares finite element schemes on obstacle and Signorini problems.
#[derive(Parser, Debug)]
#[command(name = "compare", version, about)]
struct Options {
    /// Name every scene, scheme, constraint placement and solver, and end
    #[arg(long)]
    list: bool,
    /// Scenes by name, or `all`
    #[arg(long = "scene", value_delimiter = ',', value_name = "A[,B...]")]
    scenes: Vec<String>,
    /// Schemes by name, or `all`
    #[arg(long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    schemes: Vec<String>,
    /// Subdivisions of the scene's shortest side; with --mesh: uniform refinements, from 0
    #[arg(long, value_delimiter = ',', value_name = "N[,N...]")]
    levels: Vec<usize>,
    /// Run on this Gmsh mesh; physical groups dirichlet, neumann, contact name the boundary parts
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Length scale of scenes that have one
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Ratio of coefficients of scenes that have one
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    contrast: Option<f64>,
    /// Load of scenes that have one
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    load: Option<f64>,
    /// Interior penalty X / h_F on every facet, instead of the proven bound with its margin
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// WOPSIP weight X / h_F^3 on every facet, instead of the dimensionless default
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    eta: Option<f64>,
    /// Where discontinuous schemes impose the inequality
    #[arg(long, value_enum, default_value = "vertices")]
    constraint: Placement,
    /// Solver of the inequality
    #[arg(long, value_name = "NAME")]
    solver: Option<String>,
    /// Linear solver inside it: direct or iterative
    #[arg(long, value_name = "NAME")]
    linear: Option<String>,
    /// Scalar of assembly and solve
    #[arg(long, value_enum, default_value = "f64")]
    precision: Precision,
    /// Number of threads; all cores by default
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Every time is the smallest of K runs
    #[arg(long, value_name = "K", default_value_t = 1)]
    repeat: usize,
    /// Where the report goes
    #[arg(long, value_name = "DIR", default_value = "target/compare")]
    out: PathBuf,
    /// Also write the JSON report here; `-` for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// No progress, no tables
    #[arg(long)]
    quiet: bool,
}

/// Solvers of the inequality and linear solvers inside them, with one line each.
const SOLVERS: &[(&str, &str)] =
    &[("active-set", "primal-dual active set, started from coarser levels in conforming P1")];
const LINEAR: &[(&str, &str)] = &[("direct", "sparse Cholesky or LU")];
const PLACEMENTS: &[(&str, &str)] = &[
    ("vertices", "bounds on the values at the vertices of each cell"),
    ("facet-means", "bounds on the means over the facets of each cell"),
];

/// Wrong requests, as one message.
type Request<T> = Result<T, String>;

fn main() -> ExitCode {
    let options = Options::parse();
    if options.list {
        print(&list(), false);
        return ExitCode::SUCCESS;
    }
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Prints to standard output, or to standard error; whoever closed the pipe wants no more.
fn print(text: &str, to_error: bool) {
    let result = if to_error {
        std::io::stderr().write_all(text.as_bytes())
    } else {
        std::io::stdout().write_all(text.as_bytes())
    };
    if result.is_err() {
        std::process::exit(0);
    }
}

fn list() -> String {
    let scenes: Vec<(String, String)> =
        scenes::catalogue().into_iter().map(|s| (s.name, s.summary.to_owned())).collect();
    let mut text = String::new();
    let mut group = |title: &str, rows: &mut dyn Iterator<Item = (&str, &str)>| {
        text += &format!("{title}\n");
        for (name, summary) in rows {
            text += &format!("  {name:<24}{summary}\n");
        }
    };
    group("scenes", &mut scenes.iter().map(|(n, s)| (&n[..], &s[..])));
    group("schemes", &mut SCHEMES.iter().copied());
    group("constraint placements", &mut PLACEMENTS.iter().copied());
    group("solvers", &mut SOLVERS.iter().copied());
    group("linear solvers", &mut LINEAR.iter().copied());
    text
}

/// A name of a list, or a message with the list.
fn known(kind: &str, name: &str, names: &[&str]) -> Request<()> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(format!("unknown {kind} \"{name}\"; there are: {}", names.join(", ")))
}

/// Whether every row converged.
fn run(options: &Options) -> Request<bool> {
    check_numbers(options)?;
    if let Some(threads) = options.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|e| format!("--threads {threads}: {e}"))?;
    }
    let chosen = Chosen::new(options)?;
    let rows = match options.precision {
        Precision::F64 => chosen.run::<f64>(options)?,
        Precision::F32 => chosen.run::<f32>(options)?,
    };
    let precision = if options.precision == Precision::F64 { f64::NAME } else { f32::NAME };
    let program = Program::new("compare", precision, rayon::current_num_threads(), options.repeat);
    let report = Report { program, rows };
    write(options, &report).map_err(|e| e.to_string())?;
    Ok(report.rows.iter().all(Row::converged))
}

fn check_numbers(options: &Options) -> Request<()> {
    for (name, value) in [("--sigma", options.sigma), ("--eta", options.eta)] {
        if let Some(x) = value
            && !(x > 0.0 && x.is_finite())
        {
            return Err(format!("{name} {x}: a penalty factor must be positive and finite"));
        }
    }
    for (name, value) in [("--repeat", Some(options.repeat)), ("--threads", options.threads)] {
        if value == Some(0) {
            return Err(format!("{name} 0: at least 1"));
        }
    }
    let names = |list: &[(&'static str, &str)]| list.iter().map(|s| s.0).collect::<Vec<_>>();
    if let Some(name) = &options.solver {
        known("solver", name, &names(SOLVERS))?;
    }
    if let Some(name) = &options.linear {
        known("linear solver", name, &names(LINEAR))?;
    }
    Ok(())
}

/// What the options ask for, with every name found.
struct Chosen {
    scenes: Vec<AnyScene>,
    schemes: Vec<String>,
    mesh: Option<(usize, Vec<u8>)>,
}

impl Chosen {
    fn new(options: &Options) -> Request<Self> {
        let mesh = match &options.mesh {
            None => None,
            Some(path) => {
                let bytes =
                    fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
                let dimension =
                    gmsh::dimension(&bytes).map_err(|e| format!("{}: {e}", path.display()))?;
                Some((dimension, bytes))
            }
        };
        let scheme_names: Vec<&str> = SCHEMES.iter().map(|s| s.0).collect();
        let schemes = match &options.schemes[..] {
            [] => ["p1", "sipg", "wopsip"].map(str::to_owned).to_vec(),
            [all] if all == "all" => scheme_names.iter().map(|&s| s.to_owned()).collect(),
            some => some.to_vec(),
        };
        schemes.iter().try_for_each(|name| known("scheme", name, &scheme_names))?;
        let scenes = Self::scenes(options, mesh.as_ref().map(|m| m.0))?;
        Ok(Self { scenes, schemes, mesh })
    }

    fn scenes(options: &Options, dimension: Option<usize>) -> Request<Vec<AnyScene>> {
        let catalogue = scenes::catalogue();
        let names: Vec<&str> = catalogue.iter().map(|s| &s.name[..]).collect();
        let all = matches!(&options.scenes[..], [all] if all == "all");
        let wanted: Vec<String> = match &options.scenes[..] {
            // with a mesh, all scenes are all that live in its dimension
            _ if all => catalogue
                .iter()
                .filter(|s| dimension.is_none_or(|d| d == s.dimension))
                .map(|s| s.name.clone())
                .collect(),
            [] => ["radial-2d", "signorini-2d"].map(str::to_owned).to_vec(),
            some => some.to_vec(),
        };
        let given =
            Parameters { scale: options.scale, contrast: options.contrast, load: options.load };
        let mut scenes = Vec::new();
        for name in &wanted {
            known("scene", name, &names)?;
            let Some(entry) = catalogue.iter().find(|s| s.name == *name) else { continue };
            // a parameter goes to the scenes that take it, and must find one
            let parameters = Parameters {
                scale: given.scale.filter(|_| entry.takes.scale),
                contrast: given.contrast.filter(|_| entry.takes.contrast),
                load: given.load.filter(|_| entry.takes.load),
            };
            if let Some(d) = dimension
                && d != entry.dimension
            {
                return Err(format!(
                    "the mesh has dimension {d}, scene {name} has {}: choose a scene of dimension {d} (--list names them)",
                    entry.dimension
                ));
            }
            scenes.push(entry.make(&parameters).map_err(|e| e.to_string())?);
        }
        let taken = |takes: fn(&scenes::Takes) -> bool| {
            catalogue.iter().any(|s| wanted.contains(&s.name) && takes(&s.takes))
        };
        for (name, value, takes) in [
            ("scale", given.scale, taken(|t| t.scale)),
            ("contrast", given.contrast, taken(|t| t.contrast)),
            ("load", given.load, taken(|t| t.load)),
        ] {
            if let (Some(x), false) = (value, takes) {
                return Err(format!("--{name} {x}: none of the scenes chosen takes it"));
            }
        }
        Ok(scenes)
    }

    fn run<T: Real>(self, options: &Options) -> Request<Vec<Row>> {
        let Self { scenes, schemes, mesh } = self;
        let mesh = mesh.as_ref();
        let watcher = Watcher::new(options);
        let mut runs: Vec<Box<dyn Fn() -> Request<Vec<Row>> + '_>> = Vec::new();
        for scene in scenes {
            runs.push(match scene {
                AnyScene::One(scene) => prepare::<T, 1>(scene, options, &schemes, mesh, &watcher)?,
                AnyScene::Two(scene) => prepare::<T, 2>(scene, options, &schemes, mesh, &watcher)?,
                AnyScene::Three(scene) => {
                    prepare::<T, 3>(scene, options, &schemes, mesh, &watcher)?
                }
            });
        }
        // nothing runs before everything has been checked
        let mut rows = Vec::new();
        for run in runs {
            rows.extend(run()?);
        }
        watcher.clear();
        Ok(rows)
    }
}

/// Checks a study and returns what runs it.
fn prepare<'a, T: Real, const D: usize>(
    scene: Scene<D>,
    options: &'a Options,
    schemes: &[String],
    mesh: Option<&(usize, Vec<u8>)>,
    watcher: &'a Watcher,
) -> Request<Box<dyn Fn() -> Request<Vec<Row>> + 'a>> {
    let scheme_options = SchemeOptions {
        sigma: options.sigma,
        eta: options.eta,
        facet_means: options.constraint == Placement::FacetMeans,
    };
    let mut study = Study::<T, D>::new(scene)
        .levels(if options.levels.is_empty() {
            default_levels(D, mesh.is_some())
        } else {
            options.levels.clone()
        })
        .repeat(options.repeat)
        .fields_to(&options.out)
        .observer(|progress| watcher.tell(&progress));
    for name in schemes {
        study = scheme_by_name(name, &scheme_options)
            .map(|scheme| study.boxed_scheme(scheme))
            .ok_or_else(|| format!("scheme {name} does not exist in dimension {D}"))?;
    }
    if let (Some((_, bytes)), Some(path)) = (mesh, &options.mesh) {
        study = study.on_mesh(read_mesh(bytes, path)?);
    }
    study.check().map_err(|e| e.to_string())?;
    Ok(Box::new(move || study.run().map(|report| report.rows).map_err(|e| e.to_string())))
}

fn read_mesh<T: Real, const D: usize>(bytes: &[u8], path: &std::path::Path) -> Request<Mesh<T, D>> {
    let read = gmsh::parse::<T, D>(bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    for warning in &read.warnings {
        eprintln!("warning: {}: {warning}", path.display());
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

/// Shows progress on a terminal, and warnings.
struct Watcher {
    bar: Option<indicatif::ProgressBar>,
    quiet: bool,
}

impl Watcher {
    fn new(options: &Options) -> Self {
        let show = !options.quiet && std::io::stderr().is_terminal();
        Self { bar: show.then(indicatif::ProgressBar::new_spinner), quiet: options.quiet }
    }
    fn tell(&self, progress: &Progress<'_>) {
        match (progress, &self.bar) {
            (Progress::Started(scene, scheme, level), Some(bar)) => {
                bar.set_message(format!("{scene}  {scheme}  level {level}"));
                bar.tick();
            }
            (Progress::Finished(row), bar) if !self.quiet => {
                for warning in &row.warnings {
                    let text = format!(
                        "warning: {} {} level {}: {warning}",
                        row.scene, row.scheme, row.level
                    );
                    match bar {
                        Some(bar) => bar.suspend(|| eprintln!("{text}")),
                        None => eprintln!("{text}"),
                    }
                }
            }
            _ => {}
        }
    }
    fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn write(options: &Options, report: &Report) -> Result<(), Error> {
    let to_stdout = options.json.as_deref().is_some_and(|p| p.as_os_str() == "-");
    let written = report.write(&options.out)?;
    if let Some(path) = &options.json {
        if to_stdout {
            print(&report.to_json(), false);
        } else {
            fs::write(path, report.to_json()).map_err(|e| Error::Write {
                path: path.display().to_string(),
                why: e.to_string(),
            })?;
        }
    }
    if !options.quiet {
        let mut text = report.to_string();
        text +=
            &format!("report in {} ({} files and fields)\n", options.out.display(), written.len());
        print(&text, to_stdout);
    }
    Ok(())
}
