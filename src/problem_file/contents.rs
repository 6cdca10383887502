//! The contents of a problem file.

use std::path::PathBuf;

use crate::scenes::AnyScene;

/// The contents of a problem file and its mesh file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProblemFile {
    /// The problem on its box or on its mesh, with the boundary conditions that the file says. Its name is that of the
    /// file if the file gives none.
    pub scene: AnyScene,
    /// The [`fingerprint`](crate::input::fingerprint)s of the files: `problem`, and `mesh` if there is one.
    pub fingerprints: Vec<(&'static str, String)>,
    /// The paths of these files.
    pub paths: Vec<PathBuf>,
    /// Parts of the mesh file that are not used, after its path.
    pub warnings: Vec<String>,
}
