//! Files that are replaced as a whole.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, write_error};

/// Writes a file under a temporary name in its directory, then renames it, so that readers never
/// see a part of it.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<PathBuf, Error> {
    let directory = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(directory).map_err(|e| write_error(directory, e))?;
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    // the number of the process separates the drafts of two processes
    let draft = directory.join(format!(".{}-{name}", std::process::id()));
    write(&draft).map_err(|why| write_error(path, why))?;
    fs::rename(&draft, path).map_err(|e| write_error(path, e))?;
    Ok(path.to_owned())
}

/// Writes a text in this way.
pub(crate) fn replace_text(path: &Path, text: &str) -> Result<PathBuf, Error> {
    replace(path, |path| fs::write(path, text).map_err(|e| e.to_string()))
}
