//! The request beside each dumped inequality, which `judge` reads.

use std::path::PathBuf;

use serde_json::json;
use unilateral::study::{RowKey, file_name};

use super::Options;
use crate::judge::REQUEST;
use crate::shared::{Request, cannot_write, write};

/// Writes what `judge` must know of each inequality: the command line, and the paths and fingerprints of all files that
/// were read.
pub fn write_requests(options: &Options, contents: &[String], keys: &[RowKey]) -> Request<()> {
    let Some(directory) = &options.dump else { return Ok(()) };
    let absolute = |path: &Option<PathBuf>| path.as_ref().map(std::path::absolute).transpose();
    let files = [absolute(&options.asked.mesh.path), absolute(&options.asked.problem)];
    let [mesh, problem] = files.map(|file| file.map_err(|e| format!("cannot find a file: {e}")));
    let (mesh, problem) = (mesh?, problem?);
    let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let words: Vec<String> = words.collect();
    // the meshes of a reference are refined from that of the coarsest level
    let coarsest = keys.iter().map(|key| key.level).min();
    for RowKey { scene, label, level, .. } in keys {
        let folder = directory.join(file_name(&format!("{scene}-{label}-{level}")));
        let request = json!({
            "scene": scene, "label": label, "level": level, "coarsest": coarsest,
            "words": words, "mesh": mesh, "problem": problem, "contents": contents,
        });
        std::fs::create_dir_all(&folder).map_err(|e| cannot_write(&folder, e))?;
        let path = folder.join(REQUEST);
        // a link of this name would lead to another file
        let _ = std::fs::remove_file(&path);
        write(&path, format!("{request:#}\n"))?;
    }
    Ok(())
}
