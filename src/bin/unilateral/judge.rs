//! The judgement of a vector that another program found: certificate, errors and row.
//!
//! `compare --dump DIR` writes the inequalities, `judge DIR/SCENE-LABEL-LEVEL VECTOR` reads what came back.
//! Exit codes: 0 if the certificate is within its limits, 1 if not, 2 if the request was wrong.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use unilateral::exchange::read_vector;
use unilateral::mesh::{BoundaryPart, gmsh};
use unilateral::problem_file::{self, AnyOwnProblem};
use unilateral::real::Real;
use unilateral::scenes::{self, AnyScene, Parameters};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Program, Report, Row, RowKey, file_name};

use crate::compare::{self, Posed};
use crate::shared::{Request, cannot_write, fingerprint, print, read, write};

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
    let absolute = |path: &Option<PathBuf>| path.as_ref().map(std::path::absolute).transpose();
    let files = [absolute(&options.mesh), absolute(&options.problem)];
    let [mesh, problem] = files.map(|file| file.map_err(|e| format!("cannot find a file: {e}")));
    let (mesh, problem) = (mesh?, problem?);
    let contents = fingerprints(mesh.as_deref(), problem.as_deref())?;
    let part = |(name, part): &(String, BoundaryPart)| (name.clone(), part.name());
    let boundary: BTreeMap<String, &str> = options.boundary.iter().map(part).collect();
    for RowKey { scene, label, level, .. } in keys {
        let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
        let request = json!({
            "scene": scene, "label": label, "level": level, "precision": options.precision,
            "scale": options.scale, "contrast": options.contrast, "load": options.load,
            "mesh": mesh, "problem": problem, "contents": contents, "boundary": boundary,
        });
        std::fs::create_dir_all(&folder).map_err(|e| cannot_write(&folder, e))?;
        write(&folder.join(REQUEST), format!("{request:#}\n"))?;
    }
    Ok(())
}

/// The fingerprints of a mesh file, of a problem file, and of the mesh file that this names.
fn fingerprints(mesh: Option<&Path>, problem: Option<&Path>) -> Request<Vec<String>> {
    let mut found = Vec::new();
    for path in mesh.into_iter().chain(problem) {
        found.push(fingerprint(&read(path)?));
    }
    if let Some(path) = problem {
        let own = problem_file::read(path).map_err(|e| e.to_string())?;
        found.extend(own.mesh_bytes().map(fingerprint));
    }
    Ok(found)
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
    let scheme = text("label")?.parse::<NamedScheme>();
    let scheme = scheme.map_err(|e| format!("{}: {e}", path.display()))?;
    let level = request["level"].as_u64().ok_or_else(|| wrong("level"))? as usize;
    let mesh = request["mesh"].as_str().map(PathBuf::from);
    let problem = request["problem"].as_str().map(Path::new);
    if json!(fingerprints(mesh.as_deref(), problem)?) != request["contents"] {
        let files = [mesh.as_deref(), problem];
        let files: Vec<String> = files.iter().flatten().map(|p| p.display().to_string()).collect();
        return Err(format!(
            "{} (or its mesh) is not what it was when {} was written: dump the inequality again",
            files.join(", "),
            path.display()
        ));
    }
    let values = read_vector(&options.vector).map_err(|e| e.to_string())?;
    let mesh = mesh.map(|mesh| (mesh, &request["boundary"]));
    let of = (&scheme, level, mesh, &values[..]);
    let row = match problem {
        Some(path) => match problem_file::read(path).map_err(|e| e.to_string())? {
            AnyOwnProblem::One(own) => row::<T, 1>(own.into(), of),
            AnyOwnProblem::Two(own) => row::<T, 2>(own.into(), of),
            AnyOwnProblem::Three(own) => row::<T, 3>(own.into(), of),
        },
        None => {
            let entry = scenes::by_name(text("scene")?).ok_or_else(|| wrong("scene"))?;
            let number = |key: &str, is_taken: bool| request[key].as_f64().filter(|_| is_taken);
            let parameters = Parameters::new()
                .with_scale(number("scale", entry.accepts.scale))
                .with_contrast(number("contrast", entry.accepts.contrast))
                .with_load(number("load", entry.accepts.load));
            match entry.make(&parameters).map_err(|e| e.to_string())? {
                AnyScene::One(scene) => row::<T, 1>(scene.into(), of),
                AnyScene::Two(scene) => row::<T, 2>(scene.into(), of),
                AnyScene::Three(scene) => row::<T, 3>(scene.into(), of),
            }
        }
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
    posed: Posed<D>,
    (scheme, level, mesh, values): (&NamedScheme, usize, Option<(PathBuf, &Value)>, &[f64]),
) -> Request<Row> {
    let study = posed.study::<T>(&|_| {})?;
    let mut study = study.named_scheme(scheme).levels([level]);
    if let Some((path, parts)) = mesh {
        let place = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let mesh = gmsh::parse::<T, D>(&read(&path)?).map_err(|e| place(&e))?.mesh;
        let part_of = |name: &str| parts[name].as_str().and_then(BoundaryPart::from_name);
        study = study.on_mesh(mesh.with_boundary_parts(&part_of).map_err(|e| place(&e))?);
    }
    study.judge(values).map_err(|e| e.to_string())
}
