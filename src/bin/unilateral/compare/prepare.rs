//! What is compared: a study, checked before any runs.

use std::path::Path;

use super::options::Options;
use super::watcher::Watcher;
use crate::shared::{Request, each_once};

use unilateral::error::Error;
use unilateral::inequality::{SolverOptions, solver_by_name};
use unilateral::linear::LinearMethod;
use unilateral::mesh::{Mesh, MeshError, gmsh};
use unilateral::nested::Solved;
use unilateral::paraview::FieldScalar;
use unilateral::plot::Picture;
use unilateral::problem_file::{Geometry, OwnProblem};
use unilateral::real::Real;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Journal, Row, RowKey, Study, available_memory_bytes, file_name};

/// What is compared in one dimension: a scene of the catalogue, or a problem of a file.
pub enum Posed<const D: usize> {
    Scene(Scene<D>),
    Own(OwnProblem<D>),
}

impl<const D: usize> From<Scene<D>> for Posed<D> {
    fn from(scene: Scene<D>) -> Self {
        Self::Scene(scene)
    }
}

impl<const D: usize> From<OwnProblem<D>> for Posed<D> {
    fn from(own: OwnProblem<D>) -> Self {
        Self::Own(own)
    }
}

impl<const D: usize> Posed<D> {
    fn name(&self) -> &str {
        match self {
            Self::Scene(scene) => &scene.name,
            Self::Own(own) => &own.name,
        }
    }
    /// Whether it brings a mesh with it.
    pub fn has_mesh(&self) -> bool {
        matches!(self, Self::Own(OwnProblem { geometry: Geometry::File { .. }, .. }))
    }
    /// A study of it, without schemes; warnings of the mesh file are told.
    pub fn study<'a, T: Real>(self, warn: &dyn Fn(String)) -> Request<Study<'a, T, D>> {
        let own = match self {
            Self::Scene(scene) => return Ok(Study::new(scene)),
            Self::Own(own) => own,
        };
        let read = own.mesh::<T>().map_err(|e| e.to_string())?;
        match (own.geometry, read) {
            (Geometry::File { path, .. }, Some(read)) => {
                for warning in &read.warnings {
                    warn(format!("warning: {}: {warning}", path.display()));
                }
                Study::of_problem(&own.name, own.problem, read.mesh)
                    .map_err(|e| format!("{}: {e}", path.display()))
            }
            (Geometry::Box(domain), _) => Ok(Study::new(Scene::new(own.name, domain, own.problem))),
            _ => Err("a problem has a mesh or a box".to_owned()),
        }
    }
}

/// A study that has been checked.
pub struct Run<'a> {
    /// What tells its rows apart.
    pub keys: Vec<RowKey>,
    /// Runs it.
    pub run: Box<dyn FnOnce(&'a Journal) -> Request<Vec<Row>> + 'a>,
}

/// Most cells of a solution that is drawn: pictures of more are large and show no more.
const MOST_CELLS: usize = 5000;

/// Checks a study. Nothing is left of one that does not fit the mesh and was not asked for by name.
pub fn prepare<'a, T: Real, const D: usize>(
    posed: Posed<D>,
    options: &'a Options,
    (schemes, solvers): (&[NamedScheme], &[String]),
    mesh: Option<&(usize, Vec<u8>)>,
    watcher: &'a Watcher,
) -> Request<Option<Run<'a>>> {
    let name = posed.name().to_owned();
    let levels = match &options.levels[..] {
        [] => default_levels(D, mesh.is_some() || posed.has_mesh()),
        some => each_once(some),
    };
    let linear = match options.linear.as_deref() {
        Some("direct") => LinearMethod::Direct,
        Some(_) => LinearMethod::Iterative,
        None => LinearMethod::BySize,
    };
    let mut study = posed
        .study::<T>(&|warning| watcher.warn_once(warning))?
        .levels(levels)
        .repeat(options.repeat)
        .observer(|progress| watcher.tell(&progress));
    let scene_name = name.clone();
    study = study.each_solution(move |label, level, solved| {
        if solved.mesh().n_cells() <= MOST_CELLS {
            let name = format!("{scene_name}-{label}");
            if let Err(why) = draw(&name, level, solved, &options.out) {
                watcher.warn_once(format!("warning: no picture of {name}: {why}"));
            }
        }
        Ok(())
    });
    if !options.no_fields {
        let is_double = options.fields == "f64";
        let scalar = if is_double { FieldScalar::Double } else { FieldScalar::Single };
        study = study.fields_to(&options.out).field_scalar(scalar);
    }
    if options.fields_of_all_levels {
        study = study.fields_of_all_levels();
    }
    study = schemes.iter().fold(study, Study::named_scheme);
    if let Some(directory) = &options.dump {
        study = study.inequalities_to(directory);
    }
    for name in solvers {
        study = solver_by_name(name, &SolverOptions::default().linear(linear))
            .map(|solver| study.boxed_solver(solver))
            .ok_or_else(|| format!("there is no solver {name}"))?;
    }
    if let Some((scheme, level)) = &options.reference {
        study = study.named_reference(scheme, *level);
    }
    let mut place = format!("scene {name}");
    if let (Some((_, bytes)), Some(path)) = (mesh, &options.mesh) {
        place = format!("{}, {place}", path.display());
        let part_of = |name: &str| {
            let given = options.boundary.iter().find(|(group, _)| group == name);
            given.map(|(_, part)| *part)
        };
        let mesh = read_mesh(bytes, path, watcher)?;
        let known = |name: &String| mesh.boundary_groups().iter().any(|g| g.names.contains(name));
        if let Some((group, _)) = options.boundary.iter().find(|(group, _)| !known(group)) {
            let groups: Vec<&str> =
                mesh.boundary_groups().iter().flat_map(|g| &g.names).map(String::as_str).collect();
            let groups = groups.join(", ");
            return Err(format!(
                "--boundary: {} has no group {group}; it has {groups}",
                path.display()
            ));
        }
        let mesh = mesh.with_boundary_parts(&part_of).map_err(|e| format!("{place}: {e}"))?;
        mesh.check_boundary_parts().map_err(|e| match e {
            MeshError::UndecidedGroup { group, .. } => format!(
                "{place}: nothing says what holds on boundary group {group}: \
                 --boundary {group}=dirichlet, {group}=neumann or {group}=contact does"
            ),
            other => format!("{place}: {other}"),
        })?;
        study = study.on_mesh(mesh);
    }
    match study.check() {
        Err(Error::UnfitMesh { .. }) if !options.scenes_are_named() => return Ok(None),
        other => other.map_err(|e| format!("{place}: {e}"))?,
    }
    if let (Some(need), Some(free)) = (study.memory_estimate(), available_memory_bytes())
        && need.bytes > free as f64
    {
        return Err(format!(
            "scene {name}, scheme {}, level {}: would need about {:.1} GB of memory, {:.1} GB are available; choose a lower level",
            need.scheme,
            need.level,
            need.bytes / 1e9,
            free as f64 / 1e9
        ));
    }
    let keys = study.keys();
    watcher.expect(D, keys.iter().map(|key| key.level));
    let run = move |journal| match study.journal(journal).run() {
        Ok(report) => Ok(report.rows),
        Err(e) => Err(format!("{place}: {e}")),
    };
    Ok(Some(Run { keys, run: Box::new(run) }))
}

/// Draws a solution with few cells as `NAME.svg`; one on a finer mesh takes the place of a coarser one.
fn draw<T: Real, const D: usize>(
    name: &str,
    level: usize,
    solved: &Solved<'_, T, D>,
    directory: &Path,
) -> Result<(), Error> {
    let Some(fields) = solved.fields() else { return Ok(()) };
    let title = format!("{name}, level {level}");
    let problem = solved.discretisation().problem();
    let picture = Picture::of(&title, problem, solved.mesh(), &fields, None)?;
    picture.write_svg(&directory.join(file_name(name) + ".svg"))
}

fn read_mesh<T: Real, const D: usize>(
    bytes: &[u8],
    path: &Path,
    watcher: &Watcher,
) -> Request<Mesh<T, D>> {
    let read = gmsh::parse::<T, D>(bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    for warning in &read.warnings {
        watcher.warn_once(format!("warning: {}: {warning}", path.display()));
    }
    Ok(read.mesh)
}

fn default_levels(dimension: usize, on_mesh: bool) -> Vec<usize> {
    match dimension {
        _ if on_mesh => vec![0, 1],
        3 => vec![2, 4, 8],
        _ => vec![16, 32, 64, 128, 256],
    }
}
