//! The judgement of a vector that another program found: certificate, errors and row.
//!
//! `compare --dump DIR` writes the inequalities, `judge DIR/SCENE-LABEL-LEVEL VECTOR` reads what came back.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;
use unilateral::exchange::{read_constants, read_vector};
use unilateral::in_its_dimension;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Program, Report, Row, Study};

use crate::asked::{OUTPUT, PROBLEM};
use crate::compare::{self, with_solvers};
use crate::shared::{Request, each_once, print, read};
use crate::{Command, parse};

const EXAMPLES: &str = "\
Examples:
  unilateral judge dump/radial-2d-p1-8 solution.npy
  unilateral judge dump/radial-2d-p1-8 solution.txt --json";

/// Judges a vector that another program found for an inequality of `compare --dump`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// The folder of the inequality
    #[arg(help_heading = PROBLEM, value_name = "DIR")]
    directory: PathBuf,
    /// The vector: .npy, or numbers in text
    #[arg(help_heading = PROBLEM, value_name = "VECTOR")]
    vector: PathBuf,
    /// Print the report as JSON
    #[arg(help_heading = OUTPUT, long)]
    json: bool,
}

/// The file of a folder that says which inequality it has.
pub const REQUEST: &str = "request.json";

/// Whether the certificate is within its limits.
pub fn run(options: &Options) -> Request<bool> {
    let path = options.directory.join(REQUEST);
    let request: Value = serde_json::from_slice(&read(&path)?)
        .map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let wrong = |key: &str| format!("{}: {key} is {}", path.display(), request[key]);
    let text = |key: &str| request[key].as_str().ok_or_else(|| wrong(key));
    let level = |key: &str| request[key].as_u64().ok_or_else(|| wrong(key));
    let scheme = text("label")?.parse::<NamedScheme>();
    let scheme = scheme.map_err(|e| format!("{}: {e}", path.display()))?;
    let levels = [level("level")? as usize, level("coarsest")? as usize];
    let words = request["words"].as_array().ok_or_else(|| wrong("words"))?.iter();
    let words = words.filter_map(Value::as_str).map(Into::into).collect();
    let Command::Compare(mut run) = parse(words)? else { return Err(wrong("words")) };
    let values = read_vector(&options.vector).map_err(|e| e.to_string())?;
    let asked = &mut run.asked;
    let mut read_file = None;
    for (key, file) in [("mesh", &mut asked.mesh.path), ("problem", &mut asked.problem)] {
        if let Some(file) = file {
            *file = PathBuf::from(text(key)?);
            read_file = Some(file.clone());
        }
    }
    let name = text("scene")?;
    let found = asked.scenes(&[name], &|_| {})?;
    for (place, (_, fingerprint)) in found.fingerprints.into_iter().enumerate() {
        if request["contents"][place] != fingerprint {
            return Err(format!(
                "{} (or its mesh) is not what it was when {} was written: dump the inequality again",
                read_file.unwrap_or_default().display(),
                path.display()
            ));
        }
    }
    let mut scenes = found.scenes.into_iter();
    let scene = scenes.find(|scene| in_its_dimension!(scene, |scene| scene.name == name));
    let scene = scene.ok_or_else(|| wrong("scene"))?;
    let constants = read_constants(&options.directory).map_err(|e| e.to_string())?;
    let of = (&scheme, levels, (&values[..], &constants[..]));
    let row = in_its_dimension!(scene, |scene| row(scene, &run, of))?;
    let is_within = row.converged();
    let program = Program::new("judge", &run.precision, rayon::current_num_threads(), 1);
    let report = Report::new(program, vec![row]);
    if options.json {
        print(&report.to_json())?;
    } else {
        let certificate = report.rows[0].certificate;
        let text = format!(
            "{report}  certificate: feasibility {:.2e}, multiplier {:.2e}, complementarity {:.2e}, residual {:.2e}\n",
            certificate.feasibility,
            certificate.multiplier,
            certificate.complementarity,
            certificate.residual
        );
        print(&text)?;
    }
    Ok(is_within)
}

/// The row of values of a scheme on a level of the run that has dumped the inequality; beside it the coarsest level.
fn row<const D: usize>(
    scene: Scene<D>,
    run: &compare::Options,
    (scheme, [level, coarsest], (values, constants)): (&NamedScheme, [usize; 2], (&[f64], &[f64])),
) -> Request<Row> {
    let study = Study::new(scene).named_scheme(scheme);
    let mut study = with_solvers(study, &["active-set".to_owned()], run)?;
    study = match &run.asked.reference {
        Some((scheme, of_reference)) => {
            study.levels(each_once(&[level, coarsest])).named_reference(scheme, *of_reference)
        }
        None => study.levels([level]),
    };
    study.judge(values, Some(constants)).map_err(|e| e.to_string())
}
