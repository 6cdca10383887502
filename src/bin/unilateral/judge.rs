//! The judgement of a vector that another program found: certificate, errors and row.
//!
//! `compare --dump DIR` writes the inequalities, `judge DIR/SCENE-LABEL-LEVEL VECTOR` reads what came back.
//! Exit codes: 0 if the certificate is within its limits, 1 if not, 2 if the request was wrong.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use unilateral::exchange::read_vector;
use unilateral::mesh::gmsh;
use unilateral::real::Real;
use unilateral::scenes::{self, AnyScene, Parameters, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Program, Report, Row, RowKey, Study, file_name};

use crate::compare;
use crate::shared::{Request, cannot_write, print, read, write};

/// Judges a vector that another program found for an inequality of `compare --dump`
#[derive(Args, Debug)]
pub struct Options {
    /// The folder of the inequality
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// The vector: .npy, or numbers in text
    #[arg(value_name = "VECTOR")]
    vector: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// The file of a folder that says which inequality it has.
const REQUEST: &str = "request.json";

/// Writes what `judge` must know of each inequality.
pub fn write_requests(options: &compare::Options, keys: &[RowKey]) -> Request<()> {
    let Some(directory) = &options.dump else { return Ok(()) };
    let mesh = options.mesh.as_ref().map(std::path::absolute).transpose();
    let mesh = mesh.map_err(|e| format!("cannot find the mesh: {e}"))?;
    for RowKey { scene, label, level, .. } in keys {
        let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
        let request = json!({
            "scene": scene, "label": label, "level": level, "precision": options.precision,
            "scale": options.scale, "contrast": options.contrast, "load": options.load,
            "mesh": mesh,
        });
        std::fs::create_dir_all(&folder).map_err(|e| cannot_write(&folder, e))?;
        write(&folder.join(REQUEST), format!("{request:#}\n"))?;
    }
    Ok(())
}

/// Whether the certificate is within its limits.
pub fn run(options: &Options) -> Request<bool> {
    let path = options.directory.join(REQUEST);
    let request: Value = serde_json::from_slice(&read(&path)?)
        .map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    match request["precision"].as_str() {
        Some("f32") => judge::<f32>(options, &path, &request),
        _ => judge::<f64>(options, &path, &request),
    }
}

fn judge<T: Real>(options: &Options, path: &Path, request: &Value) -> Request<bool> {
    let wrong = |key: &str| format!("{}: {key} is {}", path.display(), request[key]);
    let text = |key: &str| request[key].as_str().ok_or_else(|| wrong(key));
    let entry = scenes::by_name(text("scene")?).ok_or_else(|| wrong("scene"))?;
    let number = |key: &str, is_taken: bool| request[key].as_f64().filter(|_| is_taken);
    let parameters = Parameters::new()
        .with_scale(number("scale", entry.accepts.scale))
        .with_contrast(number("contrast", entry.accepts.contrast))
        .with_load(number("load", entry.accepts.load));
    let scene = entry.make(&parameters).map_err(|e| e.to_string())?;
    let scheme: NamedScheme =
        text("label")?.parse().map_err(|e| format!("{}: {e}", path.display()))?;
    let level = request["level"].as_u64().ok_or_else(|| wrong("level"))? as usize;
    let mesh = request["mesh"].as_str().map(PathBuf::from);
    let values = read_vector(&options.vector).map_err(|e| e.to_string())?;
    let row = match scene {
        AnyScene::One(scene) => row::<T, 1>(scene, &scheme, level, mesh, &values),
        AnyScene::Two(scene) => row::<T, 2>(scene, &scheme, level, mesh, &values),
        AnyScene::Three(scene) => row::<T, 3>(scene, &scheme, level, mesh, &values),
    }?;
    let is_within = row.converged();
    let program = Program::new("judge", T::NAME, rayon::current_num_threads(), 1);
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

fn row<T: Real, const D: usize>(
    scene: Scene<D>,
    scheme: &NamedScheme,
    level: usize,
    mesh: Option<PathBuf>,
    values: &[f64],
) -> Request<Row> {
    let mut study = Study::<T, D>::new(scene).named_scheme(scheme).levels([level]);
    if let Some(path) = mesh {
        let file = gmsh::parse::<T, D>(&read(&path)?);
        study = study.on_mesh(file.map_err(|e| format!("{}: {e}", path.display()))?.mesh);
    }
    study.judge(values).map_err(|e| e.to_string())
}
