//! The options of the command line.

use std::path::PathBuf;

use clap::Args;
use unilateral::mesh::BoundaryCondition;
use unilateral::stability::STABILITY_CASES;

use crate::asked::{MESHES, OUTPUT, PROBLEM, SCHEMES, SOLVER};
use crate::mesh_file::boundary;

const EXAMPLES: &str = "\
Examples:
  unilateral stability --quick --case contrast,slivers
  unilateral stability --quick --scheme p1,wopsip@factor=10 --strict";

/// Runs the hard cases of variational inequalities and judges schemes by their criteria
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Cases by name; all by default: round-off, penalty-factor,
    /// stretched-cells, graded-meshes, contrast, coercivity,
    /// curved-obstacle, biactive, scaling, constant, contact-ends,
    /// orders, slivers
    #[arg(help_heading = PROBLEM, verbatim_doc_comment, hide_possible_values = true, long = "case", value_delimiter = ',', value_name = "A[,B...]", value_parser = STABILITY_CASES)]
    pub cases: Vec<String>,
    /// NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]; by default
    /// p1, cr, sipg, wopsip, wopsip:facet-means, p2 and nipg
    #[arg(help_heading = SCHEMES, verbatim_doc_comment, long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    pub schemes: Vec<String>,
    /// Gmsh files of tetrahedra for the case of slivers
    #[arg(help_heading = MESHES, long = "mesh", value_delimiter = ',', value_name = "FILE[,FILE...]")]
    pub meshes: Vec<PathBuf>,
    /// Conditions of other groups of the meshes, as bore=neumann
    #[arg(help_heading = MESHES, long, value_delimiter = ',', value_name = "NAME=CONDITION", requires = "meshes", value_parser = boundary)]
    pub boundary: Vec<(String, BoundaryCondition)>,
    /// Coarse meshes and few places of each sweep: within a minute
    #[arg(help_heading = SOLVER, long)]
    pub quick: bool,
    /// Number of threads; all cores by default
    #[arg(help_heading = SOLVER, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Where the report goes
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", default_value = "target/stability")]
    pub out: PathBuf,
    /// No progress, no summary
    #[arg(help_heading = OUTPUT, long)]
    pub quiet: bool,
    /// Exit with 1 if a criterion is missed
    #[arg(help_heading = OUTPUT, long)]
    pub strict: bool,
}
