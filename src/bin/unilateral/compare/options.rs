//! The options of the command line, checked as far as they can be without scenes and meshes.

use std::path::PathBuf;

use clap::Args;
use unilateral::constraint::CONSTRAINT_SETS;
use unilateral::inequality::SOLVERS;
use unilateral::linear::LinearMethod;
use unilateral::scenes;
use unilateral::scheme::{NamedScheme, SCHEMES, SchemeOptions, keys_of_scheme};

use crate::asked::{Asked, OUTPUT, PROBLEM, SCHEMES as OF_SCHEMES, SOLVER};
use crate::asked::{check_count, known, number, whole};
use crate::shared::{Request, schemes};

const EXAMPLES: &str = "\
Examples:
  unilateral compare --scene ball-2d --scheme p1,wopsip@factor=10 --levels 8,16,32
  unilateral compare plate.toml --reference 4 --details --out plate";

/// Compares finite element schemes on obstacle and Signorini problems
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    pub asked: Asked,
    /// Name every scene, scheme, constraint placement and solver, and end
    #[arg(help_heading = PROBLEM, long)]
    pub list: bool,
    /// Interior penalty X / h_F, for schemes without a penalty; not on the page of help, since `--scheme NAME@sigma=X` says
    /// it, as the two below
    #[arg(help_heading = OF_SCHEMES, long, value_name = "X", allow_negative_numbers = true, value_parser = number,
        hide = true)]
    pub sigma: Option<f64>,
    /// WOPSIP weight X / h_F^3 (P2: h_F^5), for schemes without a penalty
    #[arg(help_heading = OF_SCHEMES, long, value_name = "X", allow_negative_numbers = true, value_parser = number,
        hide = true)]
    pub eta: Option<f64>,
    /// Placement of schemes named without one
    #[arg(help_heading = OF_SCHEMES, long, value_name = "PLACEMENT", default_value = "vertices",
        value_parser = CONSTRAINT_SETS.map(|set| set.0), hide = true)]
    pub constraint: String,
    /// Solvers of the inequality, side by side; active-set by default
    #[arg(help_heading = SOLVER, long = "solver", value_delimiter = ',', value_name = "A[,B...]")]
    pub solvers: Vec<String>,
    /// Linear solver: direct, iterative, or by-size
    #[arg(help_heading = SOLVER, long, value_name = "A", default_value = "by-size")]
    pub linear: String,
    /// Scalar of the solve
    #[arg(help_heading = SOLVER, long, value_name = "NAME", value_parser = ["f64", "f32"], default_value = "f64")]
    pub precision: String,
    /// End solves with an algebraic error below X times the error bound
    #[arg(help_heading = SOLVER, long, value_name = "X", allow_negative_numbers = true, value_parser = number,
        conflicts_with_all = ["history", "dump"])]
    pub tolerance: Option<f64>,
    /// Every time is the least of K runs
    #[arg(help_heading = SOLVER, long, value_name = "K", allow_negative_numbers = true, value_parser = whole, default_value_t = 1)]
    pub repeat: usize,
    /// Time to reach an error: every case runs K times, alone
    #[arg(help_heading = SOLVER, long, value_name = "K", allow_negative_numbers = true, value_parser = whole,
        conflicts_with_all = ["repeat", "history", "details", "resume", "dump", "fields_of_all_levels"])]
    pub rounds: Option<usize>,
    /// With rounds: runs of over S seconds are neither repeated nor refined
    #[arg(help_heading = SOLVER, long, value_name = "S", default_value_t = 20.0, requires = "rounds", hide = true)]
    pub limit: f64,
    /// With rounds: the scheme of which verdicts speak, by its label; wopsip, or the fastest
    #[arg(help_heading = SOLVER, long, value_name = "NAME", requires = "rounds", hide = true)]
    pub subject: Option<String>,
    /// Certificates after every outer step, of one more run
    #[arg(help_heading = SOLVER, long)]
    pub history: bool,
    /// Over mpirun: petsc, the library of the preconditioners
    #[arg(help_heading = SOLVER, long, value_name = "NAME", value_parser = ["petsc"],
        hide_possible_values = true, hide = !cfg!(feature = "petsc"))]
    pub engine: Option<String>,
    /// Where the report goes
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", default_value = "target/compare")]
    pub out: PathBuf,
    /// After the summary also the tables of all levels
    #[arg(help_heading = OUTPUT, long)]
    pub details: bool,
    /// Also write the JSON report here; `-` for standard output
    #[arg(help_heading = OUTPUT, long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Keep the rows of this request that DIR has, and run the others
    #[arg(help_heading = OUTPUT, long, conflicts_with_all = ["dump", "adaptive"])]
    pub resume: bool,
    /// Every algebraic inequality, in a folder of DIR, for `judge`
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", conflicts_with = "adaptive")]
    pub dump: Option<PathBuf>,
    /// No .vtu files
    #[arg(help_heading = OUTPUT, long, conflicts_with = "fields_of_all_levels")]
    pub no_fields: bool,
    /// .vtu files of every level, and a .pvd file for each scheme
    #[arg(help_heading = OUTPUT, long)]
    pub fields_of_all_levels: bool,
}

/// Linear solvers inside those of the inequality, with one line each.
const LINEAR: [(&str, &str); 3] = [
    ("direct", "sparse Cholesky or LU"),
    ("iterative", "conjugate gradients with multigrid on conforming P1, for symmetric schemes"),
    ("by-size", "whichever of the two is faster for the number of unknowns, the default"),
];
/// The times of a thousand runs have no smaller least than those of more.
const MOST_REPEATS: usize = 1000;

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
    group("linear solvers", &mut LINEAR.into_iter());
    text
}

/// The summary of a scheme with the keys that it takes.
fn with_keys((name, summary): &(&str, &str)) -> String {
    match keys_of_scheme(name) {
        [] => (*summary).to_owned(),
        keys => format!("{summary} (takes {})", keys.join(", ")),
    }
}

/// The schemes asked for; refuses a penalty factor that none of them takes.
pub fn choose_schemes(options: &Options) -> Request<Vec<NamedScheme>> {
    let default = ["p1", "sipg", "wopsip", "wopsip:facet-means"];
    let chosen = schemes(&options.asked.schemes, &default)?;
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
    options.asked.check()?;
    if options.asked.adaptive.is_some() && options.asked.reference.is_some() {
        return Err("--adaptive cannot be used with --reference, which needs uniform refinements of all meshes".to_owned());
    }
    check_count("--repeat", Some(options.repeat), MOST_REPEATS)?;
    let names = LINEAR.map(|of| of.0);
    known("linear solver", &options.linear, &names)?;
    check_count("--rounds", options.rounds, MOST_REPEATS)?;
    match options.limit > 0.0 {
        true => Ok(()),
        false => Err(format!("--limit {}: must be positive", options.limit)),
    }
}

impl Options {
    /// The linear solver asked for.
    pub fn linear(&self) -> LinearMethod {
        let mut names = LinearMethod::NAMES.into_iter();
        names.find(|of| of.0 == self.linear).map(|of| of.1).expect("the name has been checked")
    }
}
