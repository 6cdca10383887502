//! What the command line asks for, checked as far as it can be without scenes and meshes.

use std::path::PathBuf;

use clap::Args;
use unilateral::constraint::CONSTRAINT_SETS;
use unilateral::inequality::SOLVERS;
use unilateral::input::excerpt;
use unilateral::nested::Adaptivity;
use unilateral::scenes;
use unilateral::scheme::{NamedScheme, SCHEMES, SchemeOptions, keys_of_scheme};

use crate::adaptive::adaptivity;
use crate::mesh_file::MeshFile;
use crate::shared::{MOST_THREADS, Request, each_once, reference, schemes};

/// Compares finite element schemes on obstacle and Signorini problems
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// A problem of your own: a TOML file with mesh or box, data by name and boundary conditions
    #[arg(value_name = "PROBLEM.toml", conflicts_with_all = ["scenes", "mesh", "boundary"])]
    pub problem: Option<PathBuf>,
    /// Name every scene, scheme, constraint placement and solver, and end
    #[arg(long)]
    pub list: bool,
    /// Scenes by name, or `all`; with --mesh by default all that fit the mesh
    #[arg(long = "scene", value_delimiter = ',', value_name = "A[,B...]")]
    pub scenes: Vec<String>,
    /// Schemes as NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]], or `all`; --list names the keys of each
    #[arg(long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    pub schemes: Vec<String>,
    /// On a box, a scene's own or that of a problem: subdivisions of its shortest side, from 1; on a mesh of a file:
    /// uniform refinements, from 0
    #[arg(long, visible_alias = "level", value_delimiter = ',', value_name = "N[,N...]", allow_negative_numbers = true, value_parser = whole)]
    pub levels: Vec<usize>,
    /// Meshes that follow the error bound in place of levels, until the bound is GOAL; or keys:
    /// theta=0.5,steps=20,unknowns=1e6,goal=GOAL. --levels N then sets the first mesh
    #[arg(long, value_name = "GOAL|KEY=VALUE[,...]", allow_negative_numbers = true,
        value_parser = adaptivity, conflicts_with_all = ["reference", "resume", "dump"])]
    pub adaptive: Option<Adaptivity>,
    #[command(flatten)]
    pub mesh: MeshFile,
    /// Measure against one fine solution in place of the exact one, by p2 where no scheme is named
    #[arg(long, value_name = "[SCHEME@level=]N", value_parser = reference)]
    pub reference: Option<(NamedScheme, usize)>,
    /// Length scale of scenes that have one
    #[arg(long, value_name = "L", allow_negative_numbers = true, value_parser = number)]
    pub scale: Option<f64>,
    /// Ratio of coefficients of scenes that have one
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub contrast: Option<f64>,
    /// Load of scenes that have one
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub load: Option<f64>,
    /// Interior penalty X / h_F on every facet, for schemes named without a penalty
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub sigma: Option<f64>,
    /// WOPSIP weight X / h_F^3 on every facet (quadratics: h_F^5), for schemes named without a penalty
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub eta: Option<f64>,
    /// Where schemes named without a placement that have the choice impose the inequality
    #[arg(long, value_parser = CONSTRAINT_SETS.map(|set| set.0), default_value = "vertices")]
    pub constraint: String,
    /// Solvers of the inequality, side by side where several; active-set by default
    #[arg(long = "solver", value_delimiter = ',', value_name = "A[,B...]")]
    pub solvers: Vec<String>,
    /// Linear solver inside it: direct or iterative; by default whichever is faster
    #[arg(long, value_name = "NAME")]
    pub linear: Option<String>,
    /// Scalar of assembly and solve
    #[arg(long, value_parser = ["f64", "f32"], default_value = "f64")]
    pub precision: String,
    /// Number of threads; all cores by default
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub threads: Option<usize>,
    /// Every time is the smallest of K runs
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = whole, default_value_t = 1)]
    pub repeat: usize,
    /// Where the report goes; it has pictures of meshes of at most 5000 cells
    #[arg(long, value_name = "DIR", default_value = "target/compare")]
    pub out: PathBuf,
    /// Write every algebraic inequality to a folder of DIR, for other solvers; `judge` reads their results
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// Keep the rows of this request that the report in DIR has, and run the others
    #[arg(long, conflicts_with = "dump")]
    pub resume: bool,
    /// Also write the JSON report here; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Also write a table of observed against promised orders here, in Markdown
    #[arg(long, value_name = "FILE")]
    pub orders: Option<PathBuf>,
    /// Scalar of fields in .vtu files; coordinates have f64 always
    #[arg(long, value_parser = ["f32", "f64"], default_value = "f32")]
    pub fields: String,
    /// No .vtu files
    #[arg(long, conflicts_with = "fields_of_all_levels")]
    pub no_fields: bool,
    /// Write the fields of every level, and for each scheme a .pvd file that lists its .vtu files
    #[arg(long)]
    pub fields_of_all_levels: bool,
    /// Over the processes of mpirun: preconditioners by PETSc, or the whole inequality by its SNESVI, to
    /// check one by the other; petsc by default
    #[arg(long, value_name = "NAME", value_parser = ["petsc", "snesvi"])]
    pub engine: Option<String>,
    /// Over the processes of mpirun: compare all rows with those of the whole mesh, bit for bit
    #[arg(long)]
    pub verify: bool,
    /// After the summary also the tables of all levels
    #[arg(long)]
    pub details: bool,
    /// No progress, no tables
    #[arg(long)]
    pub quiet: bool,
}

impl Options {
    /// Whether the user named scenes, not all or whichever are the default.
    pub fn scenes_are_named(&self) -> bool {
        let all = self.scenes.is_empty() || self.scenes.iter().any(|name| name == "all");
        self.problem.is_some() || !all
    }
}

/// Linear solvers inside those of the inequality, with one line each.
const LINEAR: &[(&str, &str)] = &[
    ("direct", "sparse Cholesky or LU"),
    ("iterative", "conjugate gradients with multigrid on conforming P1, for symmetric schemes"),
];
/// The times of a thousand runs have no smaller least than those of more.
const MOST_REPEATS: usize = 1000;

fn whole(text: &str) -> Request<usize> {
    text.parse().map_err(|_| "expected a whole number, such as 16".to_owned())
}

fn number(text: &str) -> Request<f64> {
    text.parse().map_err(|_| "expected a number, such as 2.5 or 1e-3".to_owned())
}

/// Every scene, scheme, constraint placement and solver, with one line each.
pub fn list() -> String {
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
    let schemes: Vec<(&str, String)> = SCHEMES.iter().map(|s| (s.0, with_keys(s))).collect();
    group("schemes", &mut schemes.iter().map(|(n, s)| (*n, &s[..])));
    group("constraint placements", &mut CONSTRAINT_SETS.iter().copied());
    group("solvers", &mut SOLVERS.iter().copied());
    group("linear solvers", &mut LINEAR.iter().copied());
    text
}

/// The summary of a scheme with the keys that it takes.
fn with_keys((name, summary): &(&str, &str)) -> String {
    match keys_of_scheme(name) {
        [] => (*summary).to_owned(),
        keys => format!("{summary} (takes {})", keys.join(", ")),
    }
}

/// A name of a list, or a message with the list.
fn known(kind: &str, name: &str, names: &[&str]) -> Request<()> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(format!("unknown {kind} \"{}\"; there are: {}", excerpt(name), names.join(", ")))
}

/// The names asked for, each once; all of them if one is `all`.
pub fn choose(
    kind: &str,
    asked: &[String],
    default: &[&str],
    names: &[&str],
) -> Request<Vec<String>> {
    let allowed = [names, &["all"]].concat();
    asked.iter().try_for_each(|name| known(kind, name, &allowed))?;
    Ok(if asked.is_empty() {
        default.iter().map(|&name| name.to_owned()).collect()
    } else if asked.iter().any(|name| name == "all") {
        names.iter().map(|&name| name.to_owned()).collect()
    } else {
        each_once(asked)
    })
}

/// The schemes asked for; refuses a penalty factor that none of them takes.
pub fn choose_schemes(options: &Options) -> Request<Vec<NamedScheme>> {
    let chosen = schemes(&options.schemes, &["p1", "sipg", "wopsip", "wopsip:facet-means"])?;
    for (key, given) in [("sigma", options.sigma), ("eta", options.eta)] {
        let takes = |name: &str| keys_of_scheme(name).contains(&key);
        if let Some(x) = given.filter(|_| !chosen.iter().any(|scheme| takes(scheme.name()))) {
            let takers = SCHEMES.iter().map(|s| s.0).filter(|name| takes(name));
            return Err(format!(
                "--{key} {x:?}: none of the schemes chosen takes it; there are: {}",
                takers.collect::<Vec<_>>().join(", ")
            ));
        }
    }
    let (sigma, eta) = (options.sigma, options.eta);
    let penalty = SchemeOptions { sigma, eta, ..SchemeOptions::default() };
    let complete = |s: NamedScheme| s.or_penalty(&penalty).or_placement(&options.constraint);
    Ok(chosen.into_iter().map(complete).collect())
}

pub fn check_numbers(options: &Options) -> Request<()> {
    for (name, value) in [("--sigma", options.sigma), ("--eta", options.eta)] {
        if let Some(x) = value
            && !(x > 0.0 && x.is_finite())
        {
            return Err(format!("{name} {x:?}: a penalty factor must be positive and finite"));
        }
    }
    for (name, value, most) in [
        ("--repeat", Some(options.repeat), MOST_REPEATS),
        ("--threads", options.threads, MOST_THREADS),
    ] {
        match value {
            Some(0) => return Err(format!("{name} 0: must be at least 1")),
            Some(n) if n > most => return Err(format!("{name} {n}: must be at most {most}")),
            _ => {}
        }
    }
    let names = |list: &[(&'static str, &str)]| list.iter().map(|s| s.0).collect::<Vec<_>>();
    if let Some(name) = &options.linear {
        known("linear solver", name, &names(LINEAR))?;
    }
    Ok(())
}
