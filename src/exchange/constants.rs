//! What was taken off the data of an inequality, as a file beside it.

use std::path::Path;

use super::npy::{array, read_vector};
use crate::error::{Error, write_error};
use crate::files::replace;

/// One number for each unknown.
const FILE: &str = "constant.npy";

/// Writes to the directory of an inequality what is added to its solution to have that of the problem, one number for
/// each unknown, as `constant.npy`. Without numbers there is no file, nor one of an earlier inequality.
///
/// # Errors
/// [`Error::Write`].
pub fn write_constants(directory: impl AsRef<Path>, constants: &[f64]) -> Result<(), Error> {
    let path = directory.as_ref().join(FILE);
    if !constants.is_empty() {
        let bytes = constants.iter().flat_map(|constant| constant.to_le_bytes());
        let bytes = array("<f8", &[constants.len()], bytes);
        replace(&path, |draft| std::fs::write(draft, bytes)).map(|_| ())
    } else if path.exists() {
        std::fs::remove_file(&path).map_err(|why| write_error(&path, why))
    } else {
        Ok(())
    }
}

/// Reads what [`write_constants`] wrote to a directory; empty if there is no file.
///
/// # Errors
/// [`Error::Read`].
pub fn read_constants(directory: impl AsRef<Path>) -> Result<Vec<f64>, Error> {
    let path = directory.as_ref().join(FILE);
    if path.exists() { read_vector(path) } else { Ok(Vec::new()) }
}
