//! The request beside each dumped inequality, which `judge` reads.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::json;
use unilateral::mesh::BoundaryCondition;
use unilateral::study::{RowKey, file_name};

use super::Options;
use crate::judge::REQUEST;
use crate::shared::{Request, cannot_write, write};

/// Writes what `judge` must know of each inequality, with the fingerprints of all files that were read.
pub fn write_requests(
    options: &Options,
    contents: &[String],
    (keys, constants): (&[RowKey], &BTreeMap<String, f64>),
) -> Request<()> {
    let Some(directory) = &options.dump else { return Ok(()) };
    let absolute = |path: &Option<PathBuf>| path.as_ref().map(std::path::absolute).transpose();
    let files = [absolute(&options.asked.mesh.path), absolute(&options.asked.problem)];
    let [mesh, problem] = files.map(|file| file.map_err(|e| format!("cannot find a file: {e}")));
    let (mesh, problem) = (mesh?, problem?);
    let given = options.asked.mesh.boundary.iter();
    let by_name =
        |(name, condition): &(String, BoundaryCondition)| (name.clone(), condition.name());
    let boundary: BTreeMap<String, &str> = given.map(by_name).collect();
    // the meshes of a reference are refined from that of the coarsest level
    let coarsest = keys.iter().map(|key| key.level).min();
    for RowKey { scene, label, level, .. } in keys {
        let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
        let request = json!({
            "scene": scene, "label": label, "level": level, "coarsest": coarsest,
            "precision": options.precision,
            "scale": options.asked.scale, "contrast": options.asked.contrast, "load": options.asked.load,
            "reference": options.asked.reference.as_ref().map(|(scheme, level)| {
                json!({ "scheme": scheme.to_string(), "level": level })
            }),
            "mesh": mesh, "problem": problem, "contents": contents, "boundary": boundary,
            "constants": constants,
        });
        std::fs::create_dir_all(&folder).map_err(|e| cannot_write(&folder, e))?;
        let path = folder.join(REQUEST);
        // a link of this name would lead to another file
        let _ = std::fs::remove_file(&path);
        write(&path, format!("{request:#}\n"))?;
    }
    Ok(())
}
