//! A Gmsh file of the command line, and the conditions on its boundary.

use std::path::{Path, PathBuf};

use clap::Args;
use unilateral::in_its_dimension;
use unilateral::input::{excerpt, excerpts};
use unilateral::mesh::gmsh::{GmshError, GmshErrorKind, GmshFile};
use unilateral::mesh::{BoundaryCondition, Mesh};
use unilateral::scenes::AnyScene;

use crate::asked::MESHES;
use crate::shared::Request;

/// The options of a mesh in place of built-in ones.
#[derive(Args, Clone, Debug, Default)]
pub struct MeshFile {
    /// Gmsh mesh; groups dirichlet, neumann, contact are its boundary
    #[arg(help_heading = MESHES, long = "mesh", id = "mesh", value_name = "FILE")]
    pub path: Option<PathBuf>,
    /// Conditions of other groups of the mesh, as bore=neumann
    #[arg(help_heading = MESHES, long, value_delimiter = ',', value_name = "NAME=CONDITION", requires = "mesh", value_parser = boundary)]
    pub boundary: Vec<(String, BoundaryCondition)>,
}

impl MeshFile {
    /// The contents of the file, where there is one.
    pub fn read(&self) -> Request<Option<GmshFile>> {
        let read = |path: &PathBuf| GmshFile::read(path).map_err(|e| cannot_mesh(path, &e));
        self.path.as_ref().map(read).transpose()
    }

    /// A scene on the mesh of the contents of the file, where there is one; warnings go to `warn`.
    pub fn under(
        &self,
        scene: AnyScene,
        file: Option<&GmshFile>,
        warn: &dyn Fn(String),
    ) -> Request<AnyScene> {
        let Some(file) = file else { return Ok(scene) };
        Ok(in_its_dimension!(scene, |scene| scene.domain(self.mesh(file, warn)?).into()))
    }

    /// The mesh of the contents of the file; warnings go to `warn`.
    pub fn mesh<const D: usize>(&self, file: &GmshFile, warn: &dyn Fn(String)) -> Request<Mesh<D>> {
        let path = self.path.as_deref().expect("a file that has been read has a path");
        let read = file.mesh::<D>().map_err(|e| cannot_mesh(path, &e))?;
        for warning in &read.warnings {
            warn(format!("warning: {}: {warning}", path.display()));
        }
        with_conditions(read.mesh, path, &self.boundary)
    }
}

/// The message for a file that is no mesh, with its path once.
fn cannot_mesh(path: &Path, error: &GmshError) -> String {
    match error.kind {
        GmshErrorKind::Unreadable => error.to_string(),
        _ => format!("{}: {error}", path.display()),
    }
}

/// A mesh of a file whose boundary groups have these conditions besides those that they name.
fn with_conditions<const D: usize>(
    mesh: Mesh<D>,
    path: &Path,
    boundary: &[(String, BoundaryCondition)],
) -> Request<Mesh<D>> {
    let file = path.display();
    let groups: Vec<&str> =
        mesh.boundary_groups().iter().flat_map(|g| &g.names).map(String::as_str).collect();
    if let Some((group, _)) = boundary.iter().find(|(name, _)| !groups.contains(&&name[..])) {
        let is_inside = mesh.groups_inside().contains(group);
        let (group, groups) = (excerpt(group), excerpts(groups));
        let why = match is_inside {
            true => format!("{group} lies inside the domain, between two cells; the boundary"),
            false => format!("{file} has no group {group}; it"),
        };
        return Err(format!("--boundary: {why} has {groups}"));
    }
    let condition_of = |name: &str| {
        let given = boundary.iter().find(|(group, _)| group == name);
        given.map(|(_, condition)| *condition)
    };
    let mesh = mesh.with_boundary_conditions(&condition_of).map_err(|e| format!("{file}: {e}"))?;
    let undecided = mesh.boundary_groups().iter().find(|group| group.condition.is_none());
    if let Some(group) = undecided {
        let group = group.names.iter().map(excerpt).collect::<Vec<_>>().join(", ");
        return Err(format!(
            "{file}: nothing says what holds on boundary group {group}: \
             --boundary {group}=dirichlet, {group}=neumann or {group}=contact does"
        ));
    }
    Ok(mesh)
}

/// A boundary group and its condition.
pub fn boundary(text: &str) -> Request<(String, BoundaryCondition)> {
    let found = text.rsplit_once('=');
    let found = found.and_then(|(name, condition)| {
        Some((name.to_owned(), BoundaryCondition::from_name(condition)?))
    });
    found.ok_or_else(|| "expected NAME=dirichlet, NAME=neumann or NAME=contact".to_owned())
}
