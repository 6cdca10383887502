//! The judgement of a vector that another program found: certificate, errors and row.
//!
//! `compare --dump DIR` writes the inequalities, `judge DIR/SCENE-LABEL-LEVEL VECTOR` reads what came back.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;
use unilateral::exchange::{read_constants, read_vector};
use unilateral::in_its_dimension;
use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::mesh::BoundaryCondition;
use unilateral::real::Precision;
use unilateral::scenes::{self, Parameters, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Program, Report, Row, Study};

use crate::asked::{OUTPUT, PROBLEM};
use crate::constants::Constants;
use crate::mesh_file::MeshFile;
use crate::shared::{Request, each_once, print, read};

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
    judge(options, &path, &request)
}

fn judge(options: &Options, path: &Path, request: &Value) -> Request<bool> {
    let wrong = |key: &str| format!("{}: {key} is {}", path.display(), request[key]);
    let text = |key: &str| request[key].as_str().ok_or_else(|| wrong(key));
    let scheme = text("label")?.parse::<NamedScheme>();
    let scheme = scheme.map_err(|e| format!("{}: {e}", path.display()))?;
    let level = request["level"].as_u64().ok_or_else(|| wrong("level"))? as usize;
    let is_unchanged = |place: usize, file: &Path, fingerprint: String| {
        let file = file.display();
        match request["contents"][place] == fingerprint {
            true => Ok(()),
            false => Err(format!(
                "{file} (or its mesh) is not what it was when {} was written: dump the inequality again",
                path.display()
            )),
        }
    };
    let values = read_vector(&options.vector).map_err(|e| e.to_string())?;
    let reference = match &request["reference"] {
        Value::Null => None,
        reference => {
            let name = reference["scheme"].as_str().and_then(|name| name.parse().ok());
            let level = reference["level"].as_u64().map(|level| level as usize);
            Some(name.zip(level).ok_or_else(|| wrong("reference"))?)
        }
    };
    let coarsest = request["coarsest"].as_u64().map_or(level, |coarsest| coarsest as usize);
    let levels = [level, if reference.is_some() { coarsest } else { level }];
    let precision = match &request["precision"] {
        Value::Null => Precision::default(),
        name => name.as_str().and_then(Precision::by_name).ok_or_else(|| wrong("precision"))?,
    };
    let of = (&scheme, levels, reference.as_ref(), precision);
    let scene = match request["problem"].as_str() {
        Some(path) => {
            let path = found_beside(&options.directory, path);
            let given = request["constants"].as_object().into_iter().flatten();
            let of = |(name, value): (&String, &Value)| {
                let value = value.as_f64().ok_or_else(|| wrong("constants"))?;
                Ok((name.clone(), vec![value]))
            };
            let constants = Constants { set: given.map(of).collect::<Request<_>>()? };
            let read = constants.problems(&path, &|_| {})?.remove(0);
            for (place, (_, fingerprint)) in read.fingerprints.into_iter().enumerate() {
                is_unchanged(place, &path, fingerprint)?;
            }
            let name = text("scene")?;
            in_its_dimension!(read.scene, |scene| {
                let mut scene = scene;
                scene.name = name.to_owned();
                scene.into()
            })
        }
        None => {
            let entry = scenes::by_name(text("scene")?).ok_or_else(|| wrong("scene"))?;
            let number = |key: &str, is_taken: bool| request[key].as_f64().filter(|_| is_taken);
            let parameters = Parameters::new()
                .with_scale(number("scale", entry.accepts.scale))
                .with_contrast(number("contrast", entry.accepts.contrast))
                .with_load(number("load", entry.accepts.load));
            entry.make(&parameters).map_err(|e| e.to_string())?
        }
    };
    let scene = match request["mesh"].as_str() {
        None => scene,
        Some(file) => {
            let file = found_beside(&options.directory, file);
            let given = request["boundary"].as_object().into_iter().flatten();
            let condition = |(name, condition): (&String, &Value)| {
                let of_name = condition.as_str().and_then(BoundaryCondition::from_name);
                of_name.map(|found| (name.clone(), found)).ok_or_else(|| wrong("boundary"))
            };
            let boundary = given.map(condition).collect::<Result<_, _>>()?;
            let mesh = MeshFile { path: Some(file.clone()), boundary };
            let contents = mesh.read()?.expect("a file with a path has contents");
            is_unchanged(0, &file, contents.fingerprint())?;
            mesh.under(scene, Some(&contents), &|_| {})?
        }
    };
    let constants = read_constants(&options.directory).map_err(|e| e.to_string())?;
    let row = in_its_dimension!(scene, |scene| row(scene, of, (&values, &constants)))?;
    let is_within = row.converged();
    let program = Program::new("judge", precision.name(), rayon::current_num_threads(), 1);
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

/// The path of a file that a request names. Where no such file exists, a file of this name in the folder of the
/// inequality, or beside the folder, stands for it: a dump may be copied to another machine with its files.
fn found_beside(folder: &Path, file: &str) -> PathBuf {
    let file = PathBuf::from(file);
    let Some(name) = file.file_name().filter(|_| !file.exists()) else { return file };
    let places = [folder.join(name), folder.join("..").join(name)];
    places.into_iter().find(|place| place.exists()).unwrap_or(file)
}

/// The scheme, its level and the coarsest one, the reference, and the precision of the values that are judged.
type Judged<'a> = (&'a NamedScheme, [usize; 2], Option<&'a (NamedScheme, usize)>, Precision);

fn row<const D: usize>(
    scene: Scene<D>,
    (scheme, levels, reference, precision): Judged<'_>,
    (values, constants): (&[f64], &[f64]),
) -> Request<Row> {
    let solver = in_precision(precision, ActiveSet::default());
    let study = Study::new(scene).named_scheme(scheme);
    let mut study = study.boxed_solver(solver).levels(each_once(&levels));
    if let Some((scheme, level)) = reference {
        study = study.named_reference(scheme, *level);
    }
    study.judge_beside(values, constants).map_err(|e| e.to_string())
}
