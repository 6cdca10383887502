//! What the command line asks for.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use unilateral::constraint::{ConstraintSet, Nodes, constraint_set_by_name};
use unilateral::input::excerpt;
use unilateral::linear::LinearMethod;
use unilateral::scenes;
use unilateral::scheme::{SCHEMES, SchemeOptions, scheme_by_name};
use unilateral::work_precision::Precision;

use crate::shared::{Request, constraint_set, split};

const SCENES: [&str; 5] = ["radial-2d", "ball-2d", "signorini-2d", "hertz-2d", "radial-3d"];
const CHOSEN: [&str; 6] = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2"];

/// Measures what schemes take to reach a given error
#[derive(Args, Debug)]
pub struct Options {
    /// Scenes by name; by default radial-2d, ball-2d, signorini-2d, hertz-2d, radial-3d
    #[arg(long = "scene", value_delimiter = ',', value_name = "A[,B...]")]
    scenes: Vec<String>,
    /// Schemes by name, with a placement of the bounds after a colon, as in wopsip:facet-means
    #[arg(long = "scheme", value_delimiter = ',', value_name = "A[:PLACE][,B...]")]
    schemes: Vec<String>,
    /// Linear solvers: direct, iterative, by-size
    #[arg(long, value_delimiter = ',', value_parser = LinearMethod::NAMES.map(|l| l.0), default_value = "by-size")]
    linear: Vec<String>,
    /// Scalars
    #[arg(long, value_delimiter = ',', value_parser = Precision::NAMES.map(|p| p.0), default_value = "f64")]
    precision: Vec<String>,
    /// Subdivisions of the scene's shortest side
    #[arg(long, value_delimiter = ',', value_name = "N[,N...]")]
    levels: Vec<usize>,
    /// How often each case runs; 5, with --quick 2
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..))]
    rounds: Option<u16>,
    /// Runs longer than this many seconds are not repeated, and no finer level is tried
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    pub limit: f64,
    /// The scheme of which the verdicts speak
    #[arg(long, value_name = "NAME", default_value = "wopsip")]
    pub subject: String,
    /// Coarse levels and two rounds: within a minute
    #[arg(long)]
    quick: bool,
    /// Number of threads; all cores by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Where the report goes
    #[arg(long, value_name = "DIR", default_value = "target/work_precision")]
    pub out: PathBuf,
    /// Also write the report here, as a baseline for --against
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Print what changed in counts and errors since this report
    #[arg(long, value_name = "FILE")]
    pub against: Option<PathBuf>,
    /// No progress, no tables
    #[arg(long)]
    pub quiet: bool,
    /// Run one case and print the memory it took
    #[arg(long, hide = true)]
    pub peak: bool,
}

impl Options {
    /// Checks names before anything runs.
    pub fn check(&self) -> Request<()> {
        let known = scenes::catalogue();
        for name in self.scenes() {
            if !known.iter().any(|entry| entry.name == name) {
                let names: Vec<&str> = known.iter().map(|e| &e.name[..]).collect();
                let name = excerpt(name);
                return Err(format!("unknown scene {name}; there are: {}", names.join(", ")));
            }
        }
        for choice in self.asked() {
            let (name, place) = split(&choice);
            if !SCHEMES.iter().any(|s| s.0 == name) {
                let names: Vec<&str> = SCHEMES.iter().map(|s| s.0).collect();
                let name = excerpt(name);
                return Err(format!("unknown scheme {name}; there are: {}", names.join(", ")));
            }
            if let Some(place) = place {
                let set = constraint_set(place).map_err(|e| format!("{name}: {e}"))?;
                let scheme = scheme_by_name::<f64, 2>(name, &SchemeOptions::default());
                if scheme.is_some_and(|scheme| scheme.constraint_on(&set).is_none()) {
                    return Err(format!("{choice}: the element of the scheme has no such values"));
                }
            }
        }
        match self.limit > 0.0 {
            true => Ok(()),
            false => Err(format!("--limit {}: must be positive", self.limit)),
        }
    }

    pub fn scenes(&self) -> Vec<String> {
        match self.scenes.is_empty() {
            true => SCENES.map(str::to_owned).into(),
            false => self.scenes.clone(),
        }
    }

    fn asked(&self) -> Vec<String> {
        match self.schemes.is_empty() {
            true => CHOSEN.map(str::to_owned).into(),
            false => self.schemes.clone(),
        }
    }

    /// Names of schemes, and where each imposes its bounds.
    pub fn schemes(&self) -> Vec<(String, Arc<dyn ConstraintSet>)> {
        let of = |choice: String| {
            let (name, place) = split(&choice);
            let set = place.and_then(constraint_set_by_name).unwrap_or_else(|| Arc::new(Nodes));
            (name.to_owned(), set)
        };
        self.asked().into_iter().map(of).collect()
    }

    pub fn linear(&self) -> Vec<LinearMethod> {
        let of = |name: &String| LinearMethod::NAMES.iter().find(|l| l.0 == name).map(|l| l.1);
        self.linear.iter().filter_map(of).collect()
    }

    pub fn precisions(&self) -> Vec<Precision> {
        let of = |name: &String| Precision::NAMES.iter().find(|p| p.0 == name).map(|p| p.1);
        self.precision.iter().filter_map(of).collect()
    }

    pub fn rounds(&self) -> usize {
        self.rounds.map_or(if self.quick { 2 } else { 5 }, usize::from)
    }

    pub fn threads(&self) -> Option<usize> {
        self.threads.map(usize::from)
    }

    pub fn levels(&self, dimension: usize) -> Vec<usize> {
        match (dimension, self.quick) {
            _ if !self.levels.is_empty() => self.levels.clone(),
            (3, true) => vec![2, 4, 8],
            (3, false) => vec![2, 4, 8, 16],
            (_, true) => vec![8, 16, 32],
            (_, false) => vec![8, 16, 32, 64, 128],
        }
    }
}
