//! How time, iterations and memory grow with the number of unknowns.
//!
//! `cargo bench --bench scaling` runs every case in a process of its own, because the peak of memory
//! is that of a process, one round after the other, and keeps the smallest times; `-- --rounds 5`
//! sets how many, `-- --linear direct` the linear solver, `-- --threads 2` the threads, and further
//! words pick the cases whose names contain one of them. `-- --mesh disc.msh` adds a mesh of a disc
//! around the origin from a file of Gmsh, refined to about a million unknowns; `-- --large` runs
//! cases of up to 17 million unknowns instead, which takes minutes and 9 GB.
//!
//! `cargo bench` adds the argument `--bench`. Without it, as in `cargo test --benches`, nothing runs.

use std::path::Path;
use std::process::{Command, ExitCode};

use unilateral::inequality::ActiveSet;
use unilateral::linear::LinearMethod;
use unilateral::mesh::gmsh;
use unilateral::prelude::*;
use unilateral::study::Row;

/// A case: its name, dimension, whether the bounds are left away, scheme and level.
type Case = (&'static str, usize, bool, &'static str, usize);

const CASES: &[Case] = &[
    ("2d-p1-256", 2, false, "p1", 256),
    ("2d-p1-512", 2, false, "p1", 512),
    ("2d-p1-1024", 2, false, "p1", 1024),
    ("2d-p1-linear-512", 2, true, "p1", 512),
    ("2d-p1-linear-1024", 2, true, "p1", 1024),
    ("2d-cr-256", 2, false, "cr", 256),
    ("2d-nipg-256", 2, false, "nipg", 256),
    ("2d-nipg-linear-256", 2, true, "nipg", 256),
    ("2d-sipg-128", 2, false, "sipg", 128),
    ("2d-sipg-256", 2, false, "sipg", 256),
    ("2d-sipg-linear-256", 2, true, "sipg", 256),
    ("2d-wopsip-means-128", 2, false, "wopsip-means", 128),
    ("2d-wopsip-means-256", 2, false, "wopsip-means", 256),
    ("2d-wopsip-means-linear-256", 2, true, "wopsip-means", 256),
    ("2d-wopsip-128", 2, false, "wopsip", 128),
    ("2d-wopsip-256", 2, false, "wopsip", 256),
    ("2d-wopsip-linear-256", 2, true, "wopsip", 256),
    ("3d-p1-32", 3, false, "p1", 32),
    ("3d-p1-64", 3, false, "p1", 64),
    ("3d-p1-linear-64", 3, true, "p1", 64),
    ("3d-sipg-16", 3, false, "sipg", 16),
    ("3d-sipg-32", 3, false, "sipg", 32),
    ("3d-sipg-linear-32", 3, true, "sipg", 32),
    ("3d-wopsip-16", 3, false, "wopsip", 16),
];

const LARGE: &[Case] = &[
    ("2d-p1-1024", 2, false, "p1", 1024),
    ("2d-p1-2048", 2, false, "p1", 2048),
    ("2d-p1-4096", 2, false, "p1", 4096),
    ("2d-sipg-256", 2, false, "sipg", 256),
    ("2d-sipg-512", 2, false, "sipg", 512),
    ("2d-sipg-1024", 2, false, "sipg", 1024),
    ("2d-wopsip-means-256", 2, false, "wopsip-means", 256),
    ("2d-wopsip-means-512", 2, false, "wopsip-means", 512),
    ("2d-wopsip-means-1024", 2, false, "wopsip-means", 1024),
    ("2d-wopsip-256", 2, false, "wopsip", 256),
    ("2d-wopsip-512", 2, false, "wopsip", 512),
    ("2d-wopsip-1024", 2, false, "wopsip", 1024),
    ("3d-p1-64", 3, false, "p1", 64),
    ("3d-p1-128", 3, false, "p1", 128),
    ("3d-sipg-20", 3, false, "sipg", 20),
    ("3d-sipg-40", 3, false, "sipg", 40),
    ("3d-wopsip-32", 3, false, "wopsip", 32),
];

/// The case on a mesh from a file.
const ON_MESH: Case = ("2d-p1-gmsh", 2, false, "p1", 0);

/// What one process tells another.
type Failure = Box<dyn std::error::Error>;

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    match name {
        "p1" => Box::new(ConformingP1),
        "cr" => Box::new(NonconformingP1),
        "sipg" => Box::new(Sipg::default()),
        "nipg" => Box::new(Nipg::default()),
        _ => Box::new(Wopsip::default()),
    }
}

fn run<const D: usize>(
    mut scene: scenes::Scene<D>,
    linear: LinearMethod,
    &(_, _, is_linear, name, level): &Case,
) -> Result<Row, Failure> {
    if is_linear {
        scene.problem.lower.everywhere = None;
        scene.problem.upper.everywhere = None;
    }
    if name == "wopsip-means" {
        scene.problem = scene.problem.on(FacetMeans);
    }
    let report = Study::<D>::new(scene)
        .boxed_scheme(scheme(name))
        .solver(ActiveSet::default().linear(linear))
        .levels([level])
        .run()?;
    report.rows.into_iter().next().ok_or_else(|| "no row".into())
}

/// Conforming linears on refinements of a mesh of a disc.
fn run_on_mesh(path: &str, linear: LinearMethod) -> Result<Row, Failure> {
    let mesh = gmsh::read::<2>(Path::new(path))?.mesh;
    let times = (1e6 / mesh.vertices().len() as f64).log2() / 2.0;
    let report = Study::<2>::new(scenes::radial::<2>(1.0).domain(mesh))
        .scheme(ConformingP1)
        .solver(ActiveSet::default().linear(linear))
        .levels([times.round().max(0.0) as usize])
        .run()?;
    report.rows.into_iter().next().ok_or_else(|| "no row".into())
}

/// Runs one case and prints its row.
fn child(name: &str, linear: LinearMethod, mesh: Option<&str>) -> Result<(), Failure> {
    let case =
        CASES.iter().chain(LARGE).chain([&ON_MESH]).find(|c| c.0 == name).ok_or("no such case")?;
    let row = match (case.1, mesh) {
        (_, Some(path)) => run_on_mesh(path, linear)?,
        (2, None) => run(scenes::radial::<2>(1.0), linear, case)?,
        (_, None) => run(scenes::radial::<3>(1.0), linear, case)?,
    };
    println!("{}", serde_json::to_string(&row)?);
    Ok(())
}

/// The row of a case, run in a process of its own.
fn measure(
    name: &str,
    linear: &str,
    threads: &str,
    mesh: Option<&str>,
) -> Result<serde_json::Value, Failure> {
    let mesh = mesh.filter(|_| name == ON_MESH.0);
    let output = Command::new(std::env::current_exe()?)
        .args(["--case", name, "--linear", linear])
        .args(mesh.into_iter().flat_map(|path| ["--mesh", path]))
        .env("RAYON_NUM_THREADS", threads)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn all() -> Result<(), Failure> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let is_bench = words.iter().any(|w| w == "--bench");
    words.retain(|w| w != "--bench");
    let option = |name: &str| {
        words.iter().position(|w| w == name).and_then(|k| words.get(k + 1)).map(String::as_str)
    };
    let linear_name = option("--linear").unwrap_or("by-size");
    let linear = LinearMethod::NAMES.iter().find(|l| l.0 == linear_name).ok_or("unknown solver")?.1;
    let mesh = option("--mesh");
    if let Some(name) = option("--case") {
        return child(name, linear, mesh);
    }
    if !is_bench {
        println!("nothing is measured without `--bench`, which `cargo bench` adds");
        return Ok(());
    }
    let rounds: usize = option("--rounds").unwrap_or("3").parse()?;
    let threads = option("--threads").unwrap_or("1");
    let is_value = |k: usize| k > 0 && words[k - 1].starts_with("--") && words[k - 1] != "--large";
    let filters: Vec<&String> = (0..words.len())
        .filter(|&k| !words[k].starts_with("--") && !is_value(k))
        .map(|k| &words[k])
        .collect();
    let is_large = words.iter().any(|w| w == "--large");
    let cases = if is_large { LARGE } else { CASES };
    let chosen: Vec<&Case> = cases
        .iter()
        .chain(mesh.map(|_| &ON_MESH))
        .filter(|c| filters.is_empty() || filters.iter().any(|f| c.0.contains(f.as_str())))
        .collect();
    let mut best: Vec<Option<serde_json::Value>> = vec![None; chosen.len()];
    for _ in 0..rounds {
        for (case, best) in chosen.iter().zip(&mut best) {
            let row = measure(case.0, linear_name, threads, mesh)?;
            if best.as_ref().is_none_or(|b| seconds(&row) < seconds(b)) {
                *best = Some(row);
            }
        }
    }
    println!(
        "{:<28}{:>10}{:>7}{:>8}{:>10}{:>10}{:>10}{:>8}{:>8}  {:<16}{:<12}",
        "case",
        "unknowns",
        "outer",
        "inner",
        "assemble",
        "solve",
        "seconds",
        "us/unk",
        "MB",
        "linear solver",
        "status"
    );
    for (case, row) in chosen.iter().zip(best.iter().flatten()) {
        let number = |path: &str| row.pointer(path).and_then(|v| v.as_f64()).unwrap_or(f64::NAN);
        let text =
            |path: &str| row.pointer(path).and_then(|v| v.as_str()).unwrap_or("?").to_owned();
        println!(
            "{:<28}{:>10}{:>7}{:>8}{:>10.3}{:>10.3}{:>10.3}{:>8.2}{:>8.0}  {:<16}{:<12} {:.1e} {:.1e}",
            case.0,
            number("/unknowns"),
            number("/iterations/outer"),
            number("/iterations/linear"),
            number("/seconds/assemble"),
            number("/seconds/solve"),
            seconds(row),
            1e6 * seconds(row) / number("/unknowns"),
            number("/peak_memory_bytes") / 1e6,
            text("/linear"),
            text("/status"),
            number("/certificate/algebraic_bound"),
            number("/error/l2"),
        );
    }
    Ok(())
}

/// Assembly and solve, on all levels.
fn seconds(row: &serde_json::Value) -> f64 {
    let part = |path: &str| row.pointer(path).and_then(|v| v.as_f64()).unwrap_or(f64::NAN);
    part("/seconds/assemble") + part("/seconds/solve")
}

fn main() -> ExitCode {
    match all() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
