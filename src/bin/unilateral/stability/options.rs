//! What the command line asks for.

use std::path::PathBuf;

use clap::Args;
use unilateral::mesh::BoundaryCondition;
use unilateral::stability::{Effort, STABILITY_CASES};

use crate::mesh_file::boundary;

/// Runs the hard cases of variational inequalities and judges schemes by their criteria
#[derive(Args, Debug)]
pub struct Options {
    /// Cases by name; all by default
    #[arg(long = "case", value_delimiter = ',', value_name = "A[,B...]", value_parser = STABILITY_CASES)]
    pub cases: Vec<String>,
    /// Schemes as NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]; by default p1, cr, sipg, wopsip,
    /// wopsip:facet-means, p2 and nipg
    #[arg(long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    pub schemes: Vec<String>,
    /// Gmsh files of tetrahedra for the case of slivers
    #[arg(long = "mesh", value_delimiter = ',', value_name = "FILE[,FILE...]")]
    pub meshes: Vec<PathBuf>,
    /// The boundary conditions of other groups of these meshes than dirichlet, neumann and contact, as bore=neumann
    #[arg(long, value_delimiter = ',', value_name = "NAME=CONDITION[,...]", requires = "meshes", value_parser = boundary)]
    pub boundary: Vec<(String, BoundaryCondition)>,
    /// Coarse meshes and few places of each sweep: within a minute
    #[arg(long)]
    quick: bool,
    /// Number of threads; all cores by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Where the report goes
    #[arg(long, value_name = "DIR", default_value = "target/stability")]
    pub out: PathBuf,
    /// Also write the summary of the report in Markdown to this file
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// No progress, no summary
    #[arg(long)]
    pub quiet: bool,
    /// Exit with 1 if a criterion is missed
    #[arg(long)]
    pub strict: bool,
}

impl Options {
    pub fn effort(&self) -> Effort {
        if self.quick { Effort::Quick } else { Effort::Full }
    }
}
