//! Files that are replaced as a whole.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, write_error};

/// Writes a file under a temporary name in its directory, then renames it, so that readers never
/// see a part of it. A draft that could not be written is removed.
pub(crate) fn replace<E: Into<Reason>>(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<PathBuf, Error> {
    let mut write = Some(write);
    let mut once =
        |draft: &Path| write.take().map_or(Ok(()), |write| write(draft)).map_err(E::into);
    replace_by(path, &mut once)
}

/// Why a file could not be written.
type Reason = Box<dyn std::error::Error + Send + Sync>;

/// As [`replace`], compiled once for all functions that write.
fn replace_by(
    path: &Path,
    write: &mut dyn FnMut(&Path) -> Result<(), Reason>,
) -> Result<PathBuf, Error> {
    let directory = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(directory).map_err(|e| write_error(directory, e))?;
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let draft = directory.join(mark() + &name);
    let cause = |why: Reason| match why.downcast::<Error>().map(|error| *error) {
        // the cause itself: nobody knows the draft
        Ok(Error::Write { why, .. }) => why,
        Ok(other) => other.into(),
        Err(why) => why,
    };
    let written = write(&draft).map_err(|why| write_error(path, cause(why)));
    let written = written.and_then(|()| fs::rename(&draft, path).map_err(|e| write_error(path, e)));
    if written.is_err() {
        let _ = fs::remove_file(&draft);
    }
    written.map(|()| path.to_owned())
}

/// Writes a text in this way.
#[cfg(feature = "report")]
pub(crate) fn replace_text(path: &Path, text: &str) -> Result<PathBuf, Error> {
    replace(path, |path| fs::write(path, text))
}

/// The beginning of the names of drafts; the number of the process separates those of two processes.
fn mark() -> String {
    format!(".{}-", std::process::id())
}

/// Removes the drafts of this process in a directory.
pub(crate) fn remove_drafts(directory: &Path) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&mark()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}
