//! What the command line asks for.

use std::path::PathBuf;

use clap::Args;
use unilateral::input::excerpt;
use unilateral::linear::LinearMethod;
use unilateral::nested::Adaptivity;
use unilateral::scenes;
use unilateral::scheme::NamedScheme;
use unilateral::work_precision::Precision;

use crate::adaptive::adaptivity;
use crate::mesh_file::MeshFile;
use crate::shared::{Request, reference, schemes};

const SCENES: [&str; 5] = ["radial-2d", "ball-2d", "signorini-2d", "hertz-2d", "radial-3d"];
const CHOSEN: [&str; 6] = ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2"];

/// Measures what schemes take to reach a given error
#[derive(Args, Debug)]
pub struct Options {
    /// A problem of your own, as for compare; with --reference for errors besides the bound
    #[arg(value_name = "PROBLEM.toml", conflicts_with_all = ["scenes", "mesh", "boundary"])]
    pub problem: Option<PathBuf>,
    /// Scenes by name; by default radial-2d, ball-2d, signorini-2d, hertz-2d, radial-3d
    #[arg(long = "scene", value_delimiter = ',', value_name = "A[,B...]")]
    scenes: Vec<String>,
    /// Schemes as NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]
    #[arg(long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    schemes: Vec<String>,
    /// Linear solvers: direct, iterative, by-size
    #[arg(long, value_delimiter = ',', value_parser = LinearMethod::NAMES.map(|l| l.0), default_value = "by-size")]
    linear: Vec<String>,
    /// Scalar of the solve
    #[arg(long, value_parser = Precision::NAMES.map(|p| p.0), default_value = "f64")]
    precision: String,
    #[command(flatten)]
    pub mesh: MeshFile,
    /// Take errors against one fine solution in place of the exact one, by p2 where no scheme is named
    #[arg(long, value_name = "[SCHEME@level=]N", value_parser = reference)]
    pub reference: Option<(NamedScheme, usize)>,
    /// Ratio of coefficients, for scenes that take one
    #[arg(long, value_name = "X", requires = "scenes")]
    pub contrast: Option<f64>,
    /// On a box: subdivisions of its shortest side, from 1; on a mesh of a file: uniform refinements, from 0
    #[arg(long, visible_alias = "level", value_delimiter = ',', value_name = "N[,N...]")]
    levels: Vec<usize>,
    /// Also run on meshes that follow the error bound, from the coarsest level on: the bound to reach, or keys such
    /// as theta=0.5,steps=12,unknowns=1e6
    #[arg(long, value_name = "GOAL", value_parser = adaptivity)]
    pub adaptive: Option<Adaptivity>,
    /// How often each case runs; 5, with --quick 2
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..))]
    rounds: Option<u16>,
    /// Runs longer than this many seconds are not repeated, and no finer level is tried
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    pub limit: f64,
    /// The scheme of which the verdicts speak, by its label; wopsip, or the fastest where that does not run
    #[arg(long, value_name = "NAME")]
    pub subject: Option<String>,
    /// Coarse levels and two rounds: within a minute
    #[arg(long)]
    quick: bool,
    /// Number of threads; all cores by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Where the report goes
    #[arg(long, value_name = "DIR", default_value = "target/work_precision")]
    pub out: PathBuf,
    /// No progress, no tables
    #[arg(long)]
    pub quiet: bool,
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
        if self.mesh.path.is_some() && self.scenes.is_empty() {
            return Err("--mesh: name the scenes that run on the mesh by --scene".to_owned());
        }
        self.schemes()?;
        let takes = |name: &String| known.iter().any(|e| e.name == *name && e.accepts.contrast);
        if let Some(x) = self.contrast
            && !self.scenes().iter().any(takes)
        {
            return Err(format!("--contrast {x:?}: none of the scenes chosen takes it"));
        }
        match self.limit > 0.0 {
            true => Ok(()),
            false => Err(format!("--limit {}: must be positive", self.limit)),
        }
    }

    /// The names of scenes; none for a problem of a file.
    pub fn scenes(&self) -> Vec<String> {
        match self.scenes.is_empty() {
            _ if self.problem.is_some() => Vec::new(),
            true => SCENES.map(str::to_owned).into(),
            false => self.scenes.clone(),
        }
    }

    pub fn schemes(&self) -> Request<Vec<NamedScheme>> {
        schemes(&self.schemes, &CHOSEN)
    }

    pub fn linear(&self) -> Vec<LinearMethod> {
        let of = |name: &String| LinearMethod::NAMES.iter().find(|l| l.0 == name).map(|l| l.1);
        self.linear.iter().filter_map(of).collect()
    }

    pub fn precision(&self) -> Precision {
        let known = Precision::by_name(&self.precision);
        known.expect("the command line takes the names of precisions alone")
    }

    pub fn rounds(&self) -> usize {
        self.rounds.map_or(if self.quick { 2 } else { 5 }, usize::from)
    }

    pub fn threads(&self) -> Option<usize> {
        self.threads.map(usize::from)
    }

    pub fn levels(&self, dimension: usize, has_mesh: bool) -> Vec<usize> {
        match (dimension, self.quick) {
            _ if !self.levels.is_empty() => self.levels.clone(),
            (_, true) if has_mesh => vec![0, 1],
            (_, false) if has_mesh => vec![0, 1, 2],
            (3, true) => vec![2, 4, 8],
            (3, false) => vec![2, 4, 8, 16],
            (_, true) => vec![8, 16, 32],
            (_, false) => vec![8, 16, 32, 64, 128],
        }
    }
}
