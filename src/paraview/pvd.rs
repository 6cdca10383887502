//! A series of VTK files in one collection file of ParaView.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::files::replace_text;
use crate::input::escaped;

/// Writes a `.pvd` file that lists files of fields, each with its level where the format has a
/// time, so that a slider goes from coarse to fine. Files in its own directory are named relative
/// to it, so that the directory can be moved.
///
/// # Errors
/// [`Error::Write`].
pub fn write_pvd(path: &Path, series: &[(f64, PathBuf)]) -> Result<(), Error> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    let directory = path.parent().unwrap_or(Path::new(""));
    for (level, file) in series {
        let name = relative_to(directory, file);
        text += &format!("<DataSet timestep=\"{level}\" group=\"\" part=\"0\" file=\"{name}\"/>\n");
    }
    text += "</Collection>\n</VTKFile>\n";
    replace_text(path, &text).map(drop)
}

/// The name of a file as the value of an attribute, relative to a directory that it is in.
pub(super) fn relative_to(directory: &Path, file: &Path) -> String {
    escaped(&file.strip_prefix(directory).unwrap_or(file).display().to_string())
}
