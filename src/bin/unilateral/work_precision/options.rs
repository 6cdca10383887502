//! The options of the command line.

use std::path::PathBuf;

use clap::Args;
use unilateral::linear::LinearMethod;
use unilateral::real::Precision;
use unilateral::scheme::NamedScheme;

use crate::asked::{Asked, OUTPUT, SOLVER};
use crate::shared::{Request, each_once, schemes};

const CHOSEN: [&str; 6] = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2"];

const EXAMPLES: &str = "\
Examples:
  unilateral work-precision --scene hertz-2d --scheme p1,sipg,wopsip --levels 8,16,32
  unilateral work-precision plate.toml --reference 4 --adaptive 1e-2 --rounds 3";

/// Measures what schemes take to reach a given error
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    pub asked: Asked,
    /// Linear solvers: direct, iterative, by-size
    #[arg(help_heading = SOLVER, long, value_delimiter = ',', value_name = "A[,B...]", default_value = "by-size", hide_possible_values = true,
        value_parser = LinearMethod::NAMES.map(|l| l.0))]
    linear: Vec<String>,
    /// Scalar of the solve
    #[arg(help_heading = SOLVER, long, value_name = "NAME", value_parser = Precision::NAMES.map(|p| p.0), default_value = "f64")]
    precision: String,
    /// How often each case runs; 5, with --quick 2
    #[arg(help_heading = SOLVER, long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..))]
    rounds: Option<u16>,
    /// Runs of over S seconds are neither repeated nor refined
    #[arg(help_heading = SOLVER, long, value_name = "S", default_value_t = 20.0)]
    pub limit: f64,
    /// Coarse levels and two rounds: within a minute
    #[arg(help_heading = SOLVER, long)]
    quick: bool,
    /// The scheme of which the verdicts speak, by its label; wopsip, or the fastest
    #[arg(help_heading = OUTPUT, long, value_name = "NAME")]
    pub subject: Option<String>,
    /// Where the report goes
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", default_value = "target/work_precision")]
    pub out: PathBuf,
}

impl Options {
    /// Checks what needs no scene.
    pub fn check(&self) -> Request<()> {
        self.asked.check()?;
        if self.asked.mesh.path.is_some() && self.asked.scenes.is_empty() {
            return Err("--mesh: name the scenes that run on the mesh by --scene".to_owned());
        }
        match self.limit > 0.0 {
            true => Ok(()),
            false => Err(format!("--limit {}: must be positive", self.limit)),
        }
    }

    pub fn schemes(&self) -> Request<Vec<NamedScheme>> {
        schemes(&self.asked.schemes, &CHOSEN)
    }

    pub fn linear(&self) -> Vec<(&'static str, LinearMethod)> {
        let of = |name: &String| LinearMethod::NAMES.into_iter().find(|l| l.0 == name);
        each_once(&self.linear).iter().filter_map(of).collect()
    }

    pub fn precision(&self) -> Precision {
        let known = Precision::by_name(&self.precision);
        known.expect("the command line takes the names of precisions alone")
    }

    pub fn rounds(&self) -> usize {
        self.rounds.map_or(if self.quick { 2 } else { 5 }, usize::from)
    }

    /// Each level once, from coarse to fine.
    pub fn levels(&self, dimension: usize, has_mesh: bool) -> Vec<usize> {
        let mut levels = match (dimension, self.quick) {
            _ if !self.asked.levels.is_empty() => each_once(&self.asked.levels),
            (_, true) if has_mesh => vec![0, 1],
            (_, false) if has_mesh => vec![0, 1, 2],
            (3, true) => vec![2, 4, 8],
            (3, false) => vec![2, 4, 8, 16],
            (_, true) => vec![8, 16, 32],
            (_, false) => vec![8, 16, 32, 64, 128],
        };
        levels.sort_unstable();
        levels
    }
}
