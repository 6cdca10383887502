//! What has been read from a problem file.

use crate::scenes::AnyScene;

/// What a problem file and its mesh file say.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProblemFile {
    /// The problem on its box or on its mesh, with the boundary conditions that the file says. Its name is that of the
    /// file if the file gives none.
    pub scene: AnyScene,
    /// The [`fingerprint`](crate::input::fingerprint)s of the files: `problem`, and `mesh` if there is one.
    pub fingerprints: Vec<(&'static str, String)>,
    /// What the mesh file has that is not used, after its path.
    pub warnings: Vec<String>,
}
